// Linear equations of one large molecule with cycles: A t = b as it stands, L D L^T along a list (flat_list.hpp).
// Whether that will do without refinement, flat_proof.hpp says.
#pragma once

#include "core/kernels/molecules/list/flat_rows.hpp"
#include "core/kernels/molecules/load.hpp"
#include "core/kernels/molecules/virial.hpp"

namespace holonomic::HOL_ISA::graph {

struct FlatLinear {
    const FlatList &s;
    const MoleculeLane &lane;
    const Atoms<double> at;
    const Box &box;
    const AtomArray &coordinates;
    const Inputs &in;
    const int terms;  // of right-hand sides
    double *mass;     // -w_0, w_0, -w_1, .. , 0 of each tile
    Rows pull, d;     // of all tiles: G, and the sum of |t| |d| of an atom's bonds; bonds
    Rows a;           // w f, then w (f + G), of one tile; or where right-hand sides are rates v + w G, of all tiles
    Rows r, v;        // of one tile: coordinates, velocities; |a| as it was
    double *t, *E, *per_pivot;  // right-hand sides, then multipliers; pivots
    double *lower, *size;       // |d|
    double *diagonal, *back;    // of A; R
    int32_t *bonds_at;          // of one tile: flat_residual.hpp
    Rows d_low, a_low;          // what refinement adds to the bonds of one tile, and to the accelerations of all

    static int64_t values(const FlatList &s) {
        return mass_values(s) + 4 * (2 * static_cast<int64_t>(s.n_sites) + static_cast<int64_t>(s.n_rows)) +
               8 * static_cast<int64_t>(s.most_sites) + 2 * in_fours(s.n_bonds) + 4 * in_fours(s.n_columns) +
               in_fours(s.n_entries) + bonds_at_values(s) + refinement_values(s);
    }
    static int64_t most_columns(const FlatList &s) {
        return in_fours(s.n_tiles > 1 ? FlatList::columns_of_tile : s.n_bonds);
    }
    static int64_t bonds_at_values(const FlatList &s) { return in_fours((s.most_sites + 3 + 2 * most_columns(s)) / 2); }
    static int64_t refinement_values(const FlatList &s) { return 4 * (most_columns(s) + s.n_sites); }
    FlatLinear(const FlatList &list, const MoleculeLane &l, bool packed, const Box &b, const AtomArray &positions,
               const Inputs &inputs, int sides, Memory<double> memory)
        : s(list), lane(l), at(&l, 1, packed), box(b), coordinates(positions), in(inputs), terms(sides) {
        const int64_t bonds = in_fours(s.n_bonds), columns = in_fours(s.n_columns);
        pull = {memory.values(4 * static_cast<int64_t>(s.n_sites))};
        d = {memory.values(4 * static_cast<int64_t>(s.n_rows))};
        r = {memory.values(4 * static_cast<int64_t>(s.most_sites))};
        v = {memory.values(4 * static_cast<int64_t>(s.most_sites))};
        lower = memory.values(in_fours(s.n_entries));
        t = memory.values(columns);
        E = memory.values(columns);
        per_pivot = memory.values(columns);
        back = memory.values(columns);
        size = memory.values(bonds);
        diagonal = memory.values(bonds);
        a = {memory.values(4 * static_cast<int64_t>(s.n_sites))};
        mass = memory.values(mass_values(s));
        bonds_at = reinterpret_cast<int32_t *>(memory.values(bonds_at_values(s)));
        d_low = {memory.values(4 * most_columns(s))};
        a_low = {memory.values(4 * static_cast<int64_t>(s.n_sites))};
    }
    HOL_FORCED Row &four(double *values, int64_t k) const { return *reinterpret_cast<Row *>(values + k); }
    HOL_FORCED Rows a_of(const Tile &tile) const { return in.rates ? rows_from(a, tile.first_site) : a; }
    HOL_FORCED Rows d_of(const Tile &tile) const { return rows_from(d, tile.first_row); }

    // w f, or v where right-hand sides are rates.
    HOL_FORCED void load_inputs(const Tile &tile, const Rows &to) const {
        if (terms & rates) read_atoms(*in.v, at, s, tile, to);
        for (int32_t i = tile.first_site; i < tile.end_site && !(terms & rates); ++i) {
            Row &one = to[i - tile.first_site];
            if (terms & pulls)
                one = in_row(mass[tile.first_mass + 2 * (i - tile.first_site) + 1]) *
                      read_row_of(*in.f, at, s.atom_of[i]);
            else
                one = Row{};
        }
    }

    // Where the memory of one tile has had others since.
    HOL_FORCED void load_inputs_again(const Tile &tile) const {
        if (!(terms & rates) && s.n_tiles > 1) load_inputs(tile, a);
    }

    __attribute__((noinline)) void load(const Tile &tile) const {
        read_masses(lane.w, s, tile, mass);
        read_atoms(coordinates, at, s, tile, r);
        find_bonds(s, tile, box, r, d);
        if (terms & squares) read_atoms(*in.v, at, s, tile, v);
        const Rows bonds = d_of(tile);
        if ((terms & (pulls | rates)) || s.n_tiles == 1) load_inputs(tile, a_of(tile));
        const double *const w = mass + tile.first_mass;
        for (int64_t k = tile.first; k < tile.end; k += 4) {
            const int32_t *const from = s.from + tile.first_row + (k - tile.first), *const to = s.to + (from - s.from);
            Row q[4];
            HOL_UNROLL_FEW
            for (int i = 0; i < 4; ++i) q[i] = bonds[k - tile.first + i] * bonds[k - tile.first + i];
            const Row square = sums_of(q[0], q[1], q[2], q[3]);
            four(t, k) = sides_of(tile, k, terms);
            HOL_UNROLL_FEW
            for (int i = 0; i < 4; ++i) {
                E[k + i] = diagonal[k + i] = (w[from[i] / 2 + 1] + w[to[i] / 2 + 1]) * square[i];
                size[k + i] = __builtin_sqrt(square[i]);
            }
        }
        if (terms & (given | rates)) add_given(tile, t);
    }
    // What velocities and inputs give to the right-hand sides of columns k .. k + 3.
    HOL_FORCED Row sides_of(const Tile &tile, int64_t k, int wanted) const {
        const int64_t row = tile.first_row + (k - tile.first);
        const int32_t *const from = s.from + row, *const to = s.to + row;
        const Rows of = a_of(tile);
        Row e[4] = {};
        HOL_UNROLL_FEW
        for (int i = 0; i < 4; ++i) {
            if (wanted & squares) {
                const Row dv = v.at_four_times(to[i]) - v.at_four_times(from[i]);
                e[i] = dv * dv;
            }
            if (wanted & (pulls | rates))
                e[i] = multiply_add(d[row + i], of.at_four_times(to[i]) - of.at_four_times(from[i]), e[i]);
        }
        return sums_of(e[0], e[1], e[2], e[3]);
    }
    // What the caller gives to them.
    HOL_FORCED void add_given(const Tile &tile, double *side) const {
        for (int32_t k = tile.first; k < tile.end && (in.rhs || in.strain); ++k) side[k] = side[k] + given_to(tile, k);
    }
    double given_to(const Tile &tile, int32_t k) const {
        return in.rhs ? 0.5 * in.rhs[lane.first_bond + s.bond_of[k]]
                      : stretching(in.strain, vector_of(d_of(tile)[k - tile.first]));
    }

    // The entries of A off its diagonal.
    __attribute__((noinline)) void assemble(const Tile &tile) const {
        const Rows bond = d_of(tile);
        const double *const w = mass + tile.first_mass;
        for (int64_t e = tile.first_entry; e < tile.end_entry; e += 4) {
            const int32_t *const row = s.row_4 + e, *const column = s.column_4 + e, *const m = s.mass + e;
            Row p[4];
            HOL_UNROLL_FEW
            for (int i = 0; i < 4; ++i) p[i] = bond.at_four_times(row[i]) * bond.at_four_times(column[i]);
            four(lower, e) = Row{w[m[0]], w[m[1]], w[m[2]], w[m[3]]} * sums_of(p[0], p[1], p[2], p[3]);
        }
    }

    // Right-hand sides with it.
    __attribute__((noinline)) void eliminate(const Tile &tile) const {
        add_sides(s, tile, t);
        add_sides(s, tile, E);
        add_entries(s, tile, lower);
        const int32_t *update = s.update + tile.first_update;
        for_columns_up(s, tile, [&](int32_t k, int32_t first, int32_t n) HOL_FORCED {
            const int32_t *const row = s.row + first;
            double *const l = lower + first;
            const double inverse = per_pivot[k] = 1 / E[k], y = t[k];
            HOL_UNROLL_FEW
            for (int32_t i = 0; i < n; ++i) {
                const double li = l[i], lr = li * inverse;
                HOL_UNROLL_FEW
                for (int32_t j = 0; j < i; ++j, ++update)  // l of j is multiplied already
                    lower[*update] = mul_add(-li, l[j], lower[*update]);
                E[row[i]] = mul_add(-li, lr, E[row[i]]);
                t[row[i]] = mul_add(-lr, y, t[row[i]]);
                l[i] = lr;
            }
        });
    }

    // Back, with the part of R that elimination and substitutions have.
    __attribute__((noinline)) void substitute_back(const Tile &tile) const {
        for_columns_down(s, tile, [&](int32_t k, int32_t first, int32_t n) HOL_FORCED {
            const int32_t *const row = s.row + first;
            const double *const l = lower + first;
            double x = t[k] * per_pivot[k], sum = 0;
            HOL_UNROLL_FEW
            for (int32_t e = 0; e < n; ++e) {
                const double part = l[e] * t[row[e]];
                x = x - part;
                sum = sum + abs(part);
            }
            const double all = E[k] * (abs(x) + sum);
            back[k] = all;
            HOL_UNROLL_FEW
            for (int32_t e = 0; e < n; ++e) back[row[e]] = mul_add(abs(l[e]), all, back[row[e]]);
            t[k] = x;
        });
        give_sides(s, tile, t);
    }

    // G of a tile's atoms, and beside it the sum of |t| |d|.
    __attribute__((noinline)) void find_pulls(const Tile &tile) const {
        const RowBits opposite = {INT64_MIN, INT64_MIN, INT64_MIN, 0};
        const Rows of = rows_from(pull, tile.first_site), bond = rows_from(d, tile.first_row - tile.first);
        const int32_t *const from = s.from + (tile.first_row - tile.first), *const to = s.to + (from - s.from);
        for (int64_t i = 0; i < tile.end_site - tile.first_site; ++i) of[i] = Row{};
        for (int64_t k = tile.first; k < tile.end; ++k) {
            Row p = in_row(t[k]) * bond[k];
            p[3] = abs(t[k]) * size[k];
            Row &head = of.at_four_times(from[k]), &tail = of.at_four_times(to[k]);
            head = head + p;
            tail = tail + reinterpret_cast<Row>(reinterpret_cast<RowBits>(p) ^ opposite);
        }
        add_visits(s, tile, pull);
    }
    // What they do to a, of which v keeps what it was made of.
    HOL_FORCED void add_pulls(const Tile &tile) const {
        const Rows of = a_of(tile), g = rows_from(pull, tile.first_site);
        const double *const w = mass + tile.first_mass;
        for (int64_t i = 0; i < tile.own_end - tile.first_site; ++i) {
            v[i] = absolute(of[i]);
            of[i] = multiply_add(in_row(w[2 * i + 1]), g[i], of[i]);
        }
    }

    // Once more for velocities, for the rates of the bonds as they are, d.(v_j - v_i).
    void solve_again() const {
        clear_sides(s, t);
        for (int32_t i = 0; i < s.n_tiles; ++i) {
            copy_guests(s, s.tile[i], a);
            find_rates(s.tile[i]);
            add_given(s.tile[i], t);
            solve_up(s, s.tile[i], lower, t);
        }
        for (int32_t i = s.n_tiles; i-- > 0;) {
            solve_down(s, s.tile[i], lower, per_pivot, t, [](int32_t, double) HOL_FORCED {});
            find_pulls(s.tile[i]);
            add_pulls(s.tile[i]);
        }
    }
    HOL_FORCED void find_rates(const Tile &tile) const {
        for (int64_t k = tile.first; k < tile.end; k += 4) four(t, k) = sides_of(tile, k, rates);
    }

    void write_bonds(double factor, double *out) const {
        for (int32_t k = 0; k < s.n_bonds; ++k) out[lane.first_bond + s.bond_of[k]] = mul_add(factor, t[k], 0.0);
    }
    void write_tensions(double *out) const {
        for (int32_t k = 0; k < s.n_bonds; ++k) out[lane.first_bond + s.bond_of[k]] = mul_add(t[k], size[k], 0.0);
    }
    void add_virial(Tally &tally) const {
        MoleculesVirial<double> virial;
        for (int32_t i = 0; i < s.n_tiles; ++i)
            for (int32_t k = s.tile[i].first; k < s.tile[i].end; ++k) {
                const Vector3<double> bond = vector_of(d_of(s.tile[i])[k - s.tile[i].first]);
                virial.add(bond, t[k] * bond);
            }
        virial.count(1, 1, tally);
    }
    bool writable(int32_t atom) const { return !lane.shared || !lane.shared[atom]; }
};

}  // namespace holonomic::HOL_ISA::graph
