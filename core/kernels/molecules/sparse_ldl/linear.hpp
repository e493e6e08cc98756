// Linear equations of molecules with cycles, and of large ones, by sparse LDL^T (core/plan/sparse_ldl.hpp): A t = b as
// it stands, and what it is made of. Of one molecule (V = double), or of W of one shape in lanes. factor.hpp solves
// them; whether that will do without refinement, error_bound.hpp says.
#pragma once

#include "core/kernels/molecules/load.hpp"
#include "core/kernels/molecules/sparse_ldl/tiles.hpp"

namespace holonomic::HOL_ISA::graph {

template <class V>
struct LdlLinear {
    typedef RowOf<V> Row;
    static constexpr int step = at_once<V>;
    const LdlPlan &s;
    const MoleculeLane *const lane;  // of all lanes; those without a molecule repeat the first one
    const int used;
    const Atoms<V> at;
    const Box &box;
    const AtomArray &coordinates;
    const Inputs &in;
    const int terms;             // of right-hand sides
    const bool masses_known;     // in lanes: those of the molecules before, in the same memory
    const LongTeam *const team;  // or nullptr
    double *const own;           // memory of this thread, for one tile
    V *w;                        // inverse masses of all sites
    V *masses;                   // of one tile: -w_0, w_0, -w_1, .. , 0
    Rows<V> pull, d;             // G, and the sum of |t| |d| of an atom's bonds; bonds
    Rows<V> a;     // w f, then w (f + G); where right-hand sides are rates v + w G, and what pulls ghosts in their rows
    Rows<V> r, v;  // of one tile: coordinates, then G; velocities, then |a| as it was, then pulls of rates
    V *t, *per_pivot;   // right-hand sides, then multipliers; pivots, then 1 over them
    V *lower, *size;    // |d|
    V *diagonal;        // of A, of one tile; then R of outer columns (error_bound.hpp)
    V *back, *rate;     // one memory: R, changes (error_bound.hpp), solutions (refinement.hpp), rates as they are left
    V *rhs;             // right-hand sides as they came: refinement.hpp
    int32_t *bonds_at;  // of one tile: residual.hpp
    Rows<V> d_low, a_low;   // what refinement adds to the bonds of one tile, and to all accelerations; doubts
    V *found;               // [n_tiles] error_bound.hpp, refinement.hpp
    unsigned *left, *firm;  // [n_subtrees + 1] lanes: error_bound.hpp; in which pivots may do with refinement
    const bool with_rates;  // they are wanted

    static int64_t values(const LdlPlan &s) {
        return tile_values(s) + in_fours(s.n_sites) + 4 * (3 * static_cast<int64_t>(s.n_sites) + s.n_rows) +
               2 * in_fours(s.n_bonds) + 3 * in_fours(s.n_columns) + in_fours(s.n_entries) + in_fours(s.n_tiles) +
               2 * left_values(s);
    }
    static int64_t tile_values(const LdlPlan &s) {
        return 4 * (2 * static_cast<int64_t>(s.most_sites) + most_columns(s)) + bonds_at_values(s) + most_masses(s) +
               most_columns(s);
    }
    static int64_t left_values(const LdlPlan &s) { return in_fours(s.n_subtrees / 2 + 1); }
    static int64_t most_columns(const LdlPlan &s) { return in_fours(s.most_columns); }
    static int64_t bonds_at_values(const LdlPlan &s) {
        constexpr int64_t in_one = sizeof(V) / sizeof(int32_t);
        return in_fours((2 * in_fours(s.most_sites + 2) + 3 * most_columns(s) + in_one - 1) / in_one);
    }
    LdlLinear(const LdlPlan &list, const MoleculeLane *l, int in_use, bool packed, bool known, const LongTeam *threads,
              const Box &b, const AtomArray &positions, const Inputs &inputs, int rhs_terms, Memory<V> &memory)
        : s(list), lane(l), used(in_use), at(l, in_use, packed), box(b), coordinates(positions), in(inputs),
          terms(rhs_terms), masses_known(known), team(s.n_subtrees > 0 ? threads : nullptr), own(memory.next),
          with_rates(in.rates && !in.v->is_float) {
        memory.values(tile_values(s));
        const int64_t bonds = in_fours(s.n_bonds), columns = in_fours(s.n_columns);
        pull = {memory.values(4 * static_cast<int64_t>(s.n_sites))};
        d = {memory.values(4 * static_cast<int64_t>(s.n_rows))};
        lower = memory.values(in_fours(s.n_entries));
        t = memory.values(columns);
        per_pivot = memory.values(columns);
        back = rate = memory.values(columns);
        size = memory.values(bonds);
        rhs = memory.values(bonds);
        a = {memory.values(4 * static_cast<int64_t>(s.n_sites))};
        w = memory.values(in_fours(s.n_sites));
        a_low = {memory.values(4 * static_cast<int64_t>(s.n_sites))};
        found = memory.values(in_fours(s.n_tiles));
        left = reinterpret_cast<unsigned *>(memory.values(left_values(s)));
        firm = reinterpret_cast<unsigned *>(memory.values(left_values(s)));
        take(own);
    }
    // The same in another thread.
    LdlLinear(const LdlLinear &other, double *of_thread) : LdlLinear(other) { take(of_thread); }
    LdlLinear(const LdlLinear &) = default;
    void take(double *of_thread) {
        Memory<V> memory = {of_thread};
        r = {memory.values(4 * static_cast<int64_t>(s.most_sites))};
        v = {memory.values(4 * static_cast<int64_t>(s.most_sites))};
        bonds_at = reinterpret_cast<int32_t *>(memory.values(bonds_at_values(s)));
        d_low = {memory.values(4 * most_columns(s))};
        masses = memory.values(most_masses(s));
        diagonal = memory.values(most_columns(s));
    }
    // Calls body(this in a thread, subtree) for all subtrees and the separator. Molecules in lanes have no subtrees.
    template <class Body>
    HOL_FORCED void up(const Body &body) const {
        if constexpr (Width<V>::lanes > 1)
            body(*this, s.subtree[0]);
        else
            subtrees_up(s, team, own, in_thread(body));
    }
    template <class Body>
    HOL_FORCED void down(const Body &body) const {
        if constexpr (Width<V>::lanes > 1)
            body(*this, s.subtree[0]);
        else
            subtrees_down(s, team, own, in_thread(body));
    }
    template <class Body>
    HOL_FORCED auto in_thread(const Body &body) const {
        return [this, &body](const Subtree &subtree, double *of_thread) HOL_FORCED {
            const auto once = [&](const LdlLinear &x) __attribute__((noinline)) { body(x, subtree); };
            if (of_thread == own) return once(*this);
            once(LdlLinear(*this, of_thread));
        };
    }
    MaskOf<V> in_use() const { return Width<V>::first(used); }
    // The lanes that are in `left`, or in `firm`, of all subtrees.
    unsigned in_all_subtrees(const unsigned *lanes) const {
        unsigned all = lanes[0];
        for (int32_t b = 1; b <= s.n_subtrees; ++b) all &= lanes[b];
        return all;
    }
    HOL_FORCED Columns<V> &some(V *values, int64_t k) const { return *reinterpret_cast<Columns<V> *>(values + k); }
    HOL_FORCED Rows<V> a_of(const Tile &tile) const { return a.from(tile.first_site); }
    HOL_FORCED Rows<V> d_of(const Tile &tile) const { return d.from(tile.first_row); }

    // w f, or v where right-hand sides are rates.
    HOL_FORCED void load_inputs(const Tile &tile) const {
        const Rows<V> to = a_of(tile);
        const int32_t n = tile.end_site - tile.first_site;
        const V *const of_site = w + tile.first_site;
        if (terms & (rates | pulls)) read_atoms(terms & rates ? *in.v : *in.f, at, s, tile, to);
        if (terms & rates)
            for (int32_t i = 0; i < n; ++i) set_more(to[i], V{});
        else if (terms & pulls)
            for (int32_t i = 0; i < n; ++i) to[i] = in_row(of_site[i]) * to[i];
        else
            for (int32_t i = 0; i < n; ++i) to[i] = Row{};
    }

    // Coordinates, masses and what right-hand sides are made of.
    HOL_FORCED void load_atoms(const Tile &tile) const {
        if constexpr (step == 4) {
            const Rows<V> of = a_of(tile);
            V *const of_site = w + tile.first_site;
            const bool rated = terms & rates;
            choose(
                [&](auto packed, auto with_v, auto with_f) HOL_FORCED {
                    for_sites<packed, with_v, with_f>(at, s, tile, *lane, of_site, coordinates,
                                                      in.v ? *in.v : coordinates, in.f ? *in.f : coordinates,
                                                      [&](int32_t i, const Row &x, const Row &u, const Row &f)
                                                          HOL_FORCED {
                                                              r[i] = x;
                                                              if (with_v && !rated) v[i] = u;
                                                              of[i] = rated ? u : in_row(of_site[i]) * f;
                                                          });
                },
                at.layout != elements, (terms & (squares | rates)) != 0, (terms & pulls) != 0);
        } else {
            if (!masses_known) read_masses(lane, s, w);
            read_atoms(coordinates, at, s, tile, r);
            if (terms & squares) read_atoms(*in.v, at, s, tile, v);
            load_inputs(tile);
        }
    }

    __attribute__((noinline)) void load(const Tile &tile) const {
        load_atoms(tile);
        int64_t row = tile.first_row;
        for (int64_t k = tile.first; k < tile.end; k += step, row += step) {
            Row q[step];
            HOL_UNROLL_FEW
            for (int i = 0; i < step; ++i) {
                const Row bond = bond_at(s, row + i, box, r);
                d[row + i] = bond;
                q[i] = bond * bond;
            }
            const Columns<V> square = sums_of(q), of_ends = masses_at<V>(w + tile.first_site, s.from + row, s.to + row);
            some(t, k) = right_hand_sides_of(tile, k, terms);
            some(per_pivot, k) = some(diagonal, k - tile.first) = of_ends * square;
            some(size, k) = root_of(square);
        }
        for (; row < tile.end_row; ++row) d[row] = bond_at(s, row, box, r);
        if (terms & (given | rates)) add_given(tile, t);
    }
    // What velocities and inputs give to the right-hand sides of columns k ..
    HOL_FORCED Columns<V> right_hand_sides_of(const Tile &tile, int64_t k, int wanted) const {
        const int64_t row = tile.first_row + (k - tile.first);
        const int32_t *const from = s.from + row, *const to = s.to + row;
        const Rows<V> of = a_of(tile);
        Row e[step] = {};
        HOL_UNROLL_FEW
        for (int i = 0; i < step; ++i) {
            if (wanted & squares) {
                const Row dv = v.at_four_times(to[i]) - v.at_four_times(from[i]);
                e[i] = dv * dv;
            }
            if (wanted & (pulls | rates))
                e[i] = multiply_add(d[row + i], of.at_four_times(to[i]) - of.at_four_times(from[i]), e[i]);
        }
        return sums_of(e);
    }
    // What the caller gives to them.
    HOL_FORCED void add_given(const Tile &tile, V *to) const {
        for (int32_t k = tile.first; k < tile.end && (in.rhs || in.strain); ++k) to[k] = to[k] + given_to(tile, k);
    }
    V given_to(const Tile &tile, int32_t k) const {
        if (!in.rhs) return stretching(in.strain, vector_of(d_of(tile)[k - tile.first]));
        V b = {};
        for (int l = 0; l < Width<V>::lanes; ++l) Width<V>::set(b, l, 0.5 * in.rhs[lane[l].first_bond + s.bond_of[k]]);
        return b;
    }

    // The entries of A off its diagonal.
    __attribute__((noinline)) void assemble(const Tile &tile) const {
        const Rows<V> bond = d_of(tile);
        sign_masses(tile, w, masses);
        for (int64_t e = tile.first_entry; e < tile.end_entry; e += step) {
            Row p[step];
            HOL_UNROLL_FEW
            for (int i = 0; i < step; ++i)
                p[i] = bond.at_four_times(s.row_4[e + i]) * bond.at_four_times(s.column_4[e + i]);
            some(lower, e) = gathered(masses, s.mass + e) * sums_of(p);
        }
    }

    // G of a tile's atoms, and beside it the sum of |t| |d|. For velocities it is needed no longer than the tile's
    // memory has it, but for what pulls ghosts, which is kept in their rows of `a`.
    HOL_FORCED Rows<V> pull_of(const Tile &tile) const { return terms & rates ? r : pull.from(tile.first_site); }
    __attribute__((noinline)) void find_pulls(const Tile &tile) const {
        const Rows<V> of = pull_of(tile), bond = d.from(tile.first_row - tile.first);
        const int32_t *const from = s.from + (tile.first_row - tile.first), *const to = s.to + (from - s.from);
        for (int64_t i = 0; i < tile.end_site - tile.first_site; ++i) of[i] = Row{};
        for (int64_t k = tile.first; k < tile.end; ++k) {
            Row p = in_row(t[k]) * bond[k];
            set_more(p, abs(t[k]) * size[k]);
            Row &head = of.at_four_times(from[k]), &tail = of.at_four_times(to[k]);
            head = head + p;
            tail = tail + opposite(p);
        }
        if (terms & rates)
            keep_for_owners(tile, of);
        else
            add_visits(s, tile, pull, pull);
    }
    // Keeps what pulls ghosts, and adds to what pulls a tile's own atoms that of their ghosts in later tiles.
    HOL_FORCED void keep_for_owners(const Tile &tile, const Rows<V> &of) const {
        const Rows<V> kept = a_of(tile);
        for (int32_t i = tile.own_end - tile.first_site; i < tile.end_site - tile.first_site; ++i) kept[i] = of[i];
        add_visits(s, tile, a, of.from(-tile.first_site));
    }
    // The sum of w |t| |d| of all bonds of the atom of a site, once G is known.
    HOL_FORCED V tensions_at(int32_t site) const {
        return terms & rates ? more_of(a[s.home[site]]) : w[site] * more_of(pull[s.home[site]]);
    }
    // What they do to a, of which v keeps what it was made of.
    HOL_FORCED void add_pulls(const Tile &tile) const {
        const Rows<V> of = a_of(tile), g = pull_of(tile);
        const V *const of_site = w + tile.first_site;
        for (int64_t i = 0; i < tile.own_end - tile.first_site; ++i) {
            v[i] = absolute(of[i]);
            of[i] = multiply_add(in_row(of_site[i]), g[i], of[i]);
        }
    }
};

}  // namespace holonomic::HOL_ISA::graph
