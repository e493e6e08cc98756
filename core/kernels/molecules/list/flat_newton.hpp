// Newton's method for the positions of one large molecule: the matrix of new bonds D times reference bonds b as it
// stands, factored along a list (flat_list.hpp). Bonds and moves are found four at a time, the triangular solves one by
// one. What can be done while a tile is in a cache is done together: on the way up bonds, what is left of them and
// factors, on the way down corrections and displacements. Where there are threads, they share the tiles in all that
// needs no order; the triangular solves are left to one. The digits are the same.
#pragma once

#include "core/kernels/molecules/list/flat_rows.hpp"
#include "core/kernels/molecules/scratch.hpp"
#include "core/kernels/molecules/share_out.hpp"

namespace holonomic::HOL_ISA::graph {

// The largest error of bonds.
struct FlatErrors {
    Row worst, sum;  // max() may lose a NaN, the sum keeps it
    void add(const FlatErrors &other) {
        worst = larger(other.worst, worst);
        sum = sum + other.sum;
    }
    double largest() const { return largest_of(worst) + 0 * ((sum[0] + sum[1]) + (sum[2] + sum[3])); }
};

// What is found of a tile: also the largest coordinate, and the shortest and the longest bond.
struct FlatFound {
    FlatErrors errors;
    Row coordinate, least, most;
};

// As Newton (newton.hpp) for iterate().
struct FlatNewton {
    const FlatList &s;
    const LongTeam *const team;  // or nullptr
    FlatFound *found;            // [n_tiles]
    double *mass;                // -w_0, w_0, -w_1, .. , 0 of each tile
    Rows moves, D, b;            // of all tiles
    Rows new_D, r;               // of one tile
    double *tau, *t, *r_pivot;   // t: what is left of a length, then its correction; 1 / pivot
    double *lower, *upper, *a2, *per_a2;
    double *stretch;  // |D| / a of the bonds that the factors were made of
    double opening;   // the error of the bonds as they came
    bool displaced;   // `moves` are those of tau
    bool moved;       // the bonds are not D any more
    bool eliminated;  // t has been taken up through the factors

    static int64_t values(const FlatList &s) {
        return mass_values(s) + 8 * static_cast<int64_t>(s.n_sites) + 12 * static_cast<int64_t>(s.n_rows) +
               20 * static_cast<int64_t>(s.n_tiles) + 4 * in_fours(s.n_bonds) + 2 * in_fours(s.n_columns) +
               2 * in_fours(s.n_entries);
    }
    FlatNewton(const FlatList &list, const LongTeam *threads, Memory<double> &memory)
        : s(list), team(list.n_tiles > 1 ? threads : nullptr), opening(), displaced(false), moved(false),
          eliminated(false) {
        const int64_t bonds = in_fours(s.n_bonds), columns = in_fours(s.n_columns), entries = in_fours(s.n_entries);
        moves = {memory.values(4 * static_cast<int64_t>(s.n_sites))};
        D = {memory.values(4 * static_cast<int64_t>(s.n_rows))};
        b = {memory.values(4 * static_cast<int64_t>(s.n_rows))};
        new_D = {memory.values(4 * static_cast<int64_t>(s.n_rows))};
        r = {memory.values(4 * static_cast<int64_t>(s.n_sites))};
        found = reinterpret_cast<FlatFound *>(memory.values(20 * static_cast<int64_t>(s.n_tiles)));
        static_assert(sizeof(FlatFound) == 20 * sizeof(double), "");
        lower = memory.values(entries);
        upper = memory.values(entries);
        t = memory.values(columns);
        r_pivot = memory.values(columns);
        tau = memory.values(bonds);
        a2 = memory.values(bonds);
        per_a2 = memory.values(bonds);
        stretch = memory.values(bonds);
        mass = memory.values(mass_values(s));
    }

    HOL_FORCED Row &four(double *values, int64_t k) const { return *reinterpret_cast<Row *>(values + k); }

    HOL_FORCED Rows coordinates_of(const Tile &tile) const { return team ? rows_from(r, tile.first_site) : r; }
    HOL_FORCED Rows new_bonds_of(const Tile &tile) const { return team ? rows_from(new_D, tile.first_row) : new_D; }
    double largest_error() const {
        FlatErrors all = {};
        for (int32_t i = 0; i < s.n_tiles; ++i) all.add(found[i].errors);
        return all.largest();
    }

    // D.D - a^2 of bonds k .. k + 3.
    HOL_FORCED Row excess_of(int64_t k, const Row *d) const {
        const Lanes3 at = turned(d[0], d[1], d[2], d[3]);
        return multiply_add(at.z, at.z, multiply_add(at.y, at.y, multiply_add(at.x, at.x, -four(a2, k))));
    }
    // What is left of their lengths. Not of their squares: a change of |D|, which is D/|D| . dD, is nearly what it was
    // when the factors were made, as bonds are stretched more than they turn; that of D.D grows with |D|. So with the
    // factors of D_0, of which row k is D_0 . dD, |D_0| (|D| - a). `fresh`: the factors will be those of this D.
    template <bool fresh>
    HOL_FORCED void measure(int64_t k, const Row *d, FlatErrors &errors) const {
        const Row sigma = excess_of(k, d), excess = sigma * four(per_a2, k);
        errors.worst = larger(absolute(excess), errors.worst);
        errors.sum = errors.sum + sigma;
        if (fresh) {
            const Row root = root_of(in_row(1) + excess);
            four(stretch, k) = root;
            four(t, k) = sigma * (root / (in_row(1) + root));
        } else {  // 2 (sqrt(1 + e) - 1) / e
            const Row e = smaller(larger(excess, in_row(-0.5)), in_row(0.5));
            four(t, k) = (in_row(0.5) * four(stretch, k)) *
                         (sigma * multiply_add(e, multiply_add(in_row(0.125), e, in_row(-0.25)), in_row(1)));
        }
    }
    // What is left of a tile's bonds d.
    template <bool fresh>
    FlatErrors measure_tile(const Tile &tile, const Rows &d) const {
        FlatErrors errors = {};
        for (int64_t k = tile.first; k < tile.end; k += 4) measure<fresh>(k, &d[k - tile.first], errors);
        return errors;
    }

    double open() const { return opening; }
    void forget(Flag which) {
        if (!which.set) return;
        for (int64_t k = 0; k < in_fours(s.n_bonds); ++k) tau[k] = 0;
        displaced = false;
    }

    // Bond `row` of a tile as moved.
    HOL_FORCED Row moved_bond(const Tile &tile, int64_t row) const {
        const Rows of = rows_from(moves, tile.first_site);
        return D[row] + (of.at_four_times(s.to[row]) - of.at_four_times(s.from[row]));
    }
    // |D.D - a^2| / a^2 of the bonds as they are.
    double error_of(int64_t k) const {
        const Tile &tile = s.tile[s.tile_of(static_cast<int32_t>(k))];
        const int64_t first = k / 4 * 4, row = tile.first_row + first - tile.first;
        Row d[4];
        for (int i = 0; i < 4; ++i) d[i] = moved ? moved_bond(tile, row + i) : D[row + i];
        return absolute(excess_of(first, d))[k - first] * per_a2[k];
    }

    // Displacements by the bonds of a tile, and of its atoms by all: times w only in the end.
    HOL_FORCED void pull(const Tile &tile) const {
        const Rows of = rows_from(moves, tile.first_site), bond = rows_from(b, tile.first_row - tile.first);
        const int32_t *const from = s.from + (tile.first_row - tile.first), *const to = s.to + (from - s.from);
        for (int64_t i = 0; i < tile.end_site - tile.first_site; ++i) of[i] = Row{};
        for (int64_t k = tile.first; k < tile.end; ++k) {
            const Row one = in_row(tau[k]) * bond[k];
            Row &head = of.at_four_times(from[k]), &tail = of.at_four_times(to[k]);
            head = head + one;
            tail = tail - one;
        }
    }
    HOL_FORCED void weigh(const Tile &tile) const {
        const Rows of = rows_from(moves, tile.first_site);
        const double *const w = mass + tile.first_mass;
        add_visits(s, tile, moves);
        for (int64_t i = 0; i < tile.own_end - tile.first_site; ++i) of[i] = in_row(w[2 * i + 1]) * of[i];
    }
    __attribute__((noinline)) void displace() {
        if (displaced) return;
        displaced = true;
        share_out(team, s.n_tiles, [&](int32_t i) { pull(s.tile[i]); });
        share_out(team, s.n_tiles, [&](int32_t i) { weigh(s.tile[i]); });
    }
    // Bonds as moved, and what is left of them.
    __attribute__((noinline)) double move() {
        displace();
        share_out(team, s.n_tiles, [&](int32_t i) { found[i].errors = move(s.tile[i]); });
        eliminated = false;
        moved = true;
        return largest_error();
    }
    HOL_FORCED FlatErrors move(const Tile &tile) const {
        FlatErrors errors = {};
        copy_guests(s, tile, moves);
        const int64_t shift = tile.first_row - tile.first;
        for (int64_t k = tile.first; k < tile.end; k += 4) {
            const Row d[4] = {moved_bond(tile, k + shift), moved_bond(tile, k + shift + 1),
                              moved_bond(tile, k + shift + 2), moved_bond(tile, k + shift + 3)};
            measure<false>(k, d, errors);
        }
        return errors;
    }

    // Factors for the bonds as they are; the first solve with them follows.
    void first_factors() {
        if (!eliminated) factorize({true});
    }
    void factorize(Flag) {
        make_factors([&](const Tile &tile) HOL_FORCED {
            const Rows d = moved ? new_bonds_of(tile) : rows_from(D, tile.first_row);
            for (int64_t row = tile.first_row; moved && row < tile.end_row; ++row)
                d[row - tile.first_row] = moved_bond(tile, row);
            measure_tile<true>(tile, d);
            assemble(tile, d);
        });
    }
    // start(tile) finds what the factors start from.
    template <class Start>
    __attribute__((noinline)) void make_factors(const Start &start) {
        clear_sides(s, t);
        clear_sides(s, r_pivot);
        clear_entries(s, lower);
        clear_entries(s, upper);
        if (team) share_out(team, s.n_tiles, [&](int32_t i) { start(s.tile[i]); });
        for (int32_t i = 0; i < s.n_tiles; ++i) {
            const Tile &tile = s.tile[i];
            if (!team) start(tile);
            add_sides(s, tile, t);
            add_sides(s, tile, r_pivot);
            add_entries(s, tile, lower);
            add_entries(s, tile, upper);
            eliminate(tile);
        }
        eliminated = true;
    }
    __attribute__((noinline)) void assemble(const Tile &tile, const Rows &d) const {
        const Rows ref = rows_from(b, tile.first_row);
        const double *const w = mass + tile.first_mass;
        const int32_t *const from = s.from + tile.first_row, *const to = s.to + tile.first_row;
        for (int64_t k = 0; k < tile.end - tile.first; k += 4) {
            double sum[4];
            for (int i = 0; i < 4; ++i) sum[i] = w[from[k + i] / 2 + 1] + w[to[k + i] / 2 + 1];
            const Row q = sums_of(d[k] * ref[k], d[k + 1] * ref[k + 1], d[k + 2] * ref[k + 2], d[k + 3] * ref[k + 3]);
            four(r_pivot, tile.first + k) = Row{sum[0], sum[1], sum[2], sum[3]} * q;
        }
        for (int64_t e = tile.first_entry; e < tile.end_entry; e += 4) {
            const int32_t *const row = s.row_4 + e, *const column = s.column_4 + e, *const m = s.mass + e;
            const Row shared = {w[m[0]], w[m[1]], w[m[2]], w[m[3]]};
            Row p[4], q[4];
            HOL_UNROLL_FEW
            for (int i = 0; i < 4; ++i) {
                p[i] = d.at_four_times(row[i]) * ref.at_four_times(column[i]);
                q[i] = d.at_four_times(column[i]) * ref.at_four_times(row[i]);
            }
            four(lower, e) = shared * sums_of(p[0], p[1], p[2], p[3]);
            four(upper, e) = shared * sums_of(q[0], q[1], q[2], q[3]);
        }
    }

    __attribute__((noinline)) void eliminate(const Tile &tile) const {
        const int32_t *update = s.update + tile.first_update;
        double *const pivot = r_pivot;
        for_columns_up(s, tile, [&](int32_t k, int32_t first, int32_t n) HOL_FORCED {
            const int32_t *const row = s.row + first;
            double *const l = lower + first, *const u = upper + first;
            const double inverse = pivot[k] = 1 / pivot[k], y = t[k];
            HOL_UNROLL_FEW
            for (int32_t a = 0; a < n; ++a) {
                const double la = l[a], ua = u[a], ur = ua * inverse;
                HOL_UNROLL_FEW
                for (int32_t c = 0; c < a; ++c, ++update) {  // l and u of c are multiplied already
                    lower[*update] = mul_add(-la, u[c], lower[*update]);
                    upper[*update] = mul_add(-ua, l[c], upper[*update]);
                }
                pivot[row[a]] = mul_add(-la, ur, pivot[row[a]]);
                l[a] = la * inverse;
                u[a] = ur;
                t[row[a]] = mul_add(-l[a], y, t[row[a]]);
            }
        });
    }

    // Corrections for what is left, in t, added to tau, and what they displace.
    void take_up() const {
        clear_sides(s, t);
        for (int32_t i = 0; i < s.n_tiles; ++i) solve_up(s, s.tile[i], lower, t);
    }
    __attribute__((noinline)) void solve(Flag) {
        if (!eliminated) take_up();
        eliminated = false;
        for (int32_t i = s.n_tiles; i-- > 0;) {
            const Tile &tile = s.tile[i];
            solve_down(s, tile, upper, r_pivot, t, [&](int32_t k, double x) HOL_FORCED { tau[k] = tau[k] + x; });
            if (team) continue;
            pull(tile);
            weigh(tile);
        }
        displaced = !team;
        displace();
    }
};

}  // namespace holonomic::HOL_ISA::graph
