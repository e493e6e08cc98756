// What is done by sparse LDL^T, tile by tile (core/plan/sparse_ldl.hpp): columns one after the other, what tiles give
// to each other, triangular solves, and what is read of a tile's atoms.
#pragma once

#include "core/kernels/atom.hpp"
#include "core/kernels/molecules/molecules.hpp"
#include "core/kernels/molecules/share_out.hpp"
#include "core/kernels/molecules/sparse_ldl/rows.hpp"
#include "core/plan/sparse_ldl.hpp"

namespace holonomic::HOL_ISA::graph {

// Most columns have few entries: up to three are known to the compiler.
constexpr int32_t known_entries = 3;

typedef LdlPlan::Tile Tile;
typedef LdlPlan::Subtree Subtree;

// Calls body(subtree, memory of the thread) for all subtrees and the separator, on the threads that there are; those
// above last, or first. `own`: memory of this thread.
template <class Body>
HOL_INLINE void subtrees_up(const LdlPlan &s, const LongTeam *team, double *own, const Body &body) {
    share_out(team, own, s.n_subtrees, [&](int32_t b, double *of_thread) HOL_FORCED { body(s.subtree[b], of_thread); });
    body(s.subtree[s.n_subtrees], own);
}
template <class Body>
HOL_INLINE void subtrees_down(const LdlPlan &s, const LongTeam *team, double *own, const Body &body) {
    body(s.subtree[s.n_subtrees], own);
    share_out(team, own, s.n_subtrees, [&](int32_t b, double *of_thread) HOL_FORCED { body(s.subtree[b], of_thread); });
}
// Calls body(tile) for those of a subtree; body(first, end) for atoms, on the threads that there are.
template <class Body>
HOL_INLINE void for_tiles_up(const LdlPlan &s, const Subtree &subtree, const Body &body) {
    for (int32_t i = subtree.first; i < subtree.end; ++i) body(s.tile[i]);
}
template <class Body>
HOL_INLINE void for_tiles_down(const LdlPlan &s, const Subtree &subtree, const Body &body) {
    for (int32_t i = subtree.end; i-- > subtree.first;) body(s.tile[i]);
}
template <class Body>
HOL_INLINE void for_atoms(const LdlPlan &s, const LongTeam *team, const Body &body) {
    constexpr int32_t part = 1024;
    share_out(team, (s.n_atoms + part - 1) / part,
              [&](int32_t i) { body(i * part, i * part + part < s.n_atoms ? i * part + part : s.n_atoms); });
}
// What is read of a molecule may be in no cache.
HOL_INLINE bool is_from_memory(const LdlPlan &s) { return s.n_bonds > 2 * LdlPlan::columns_of_tile; }

// Calls body(k, first, n) for all columns of a tile, up or down; first is that of their entries, n is a constant where
// it is small.
template <class Body>
HOL_INLINE void for_columns_up(const LdlPlan &s, const Tile &tile, const Body &body) {
    int32_t k = tile.first, first = tile.first_entry;
    for (int32_t r = tile.first_run; r < tile.end_run; ++r) {
        const int32_t end = k + s.run[r].columns, entries = s.run[r].entries;
        choose_few<known_entries>(entries, [&](auto known) HOL_FORCED {
            const int32_t n = known > 0 ? known : entries;
            for (; k < end; ++k, first += n) body(k, first, n);
        });
    }
}
template <class Body>
HOL_INLINE void for_columns_down(const LdlPlan &s, const Tile &tile, const Body &body) {
    int32_t k = tile.end, first = tile.end_entry;
    for (int32_t r = tile.end_run; r-- > tile.first_run;) {
        const int32_t start = k - s.run[r].columns, entries = s.run[r].entries;
        choose_few<known_entries>(entries, [&](auto known) HOL_FORCED {
            const int32_t n = known > 0 ? known : entries;
            while (k > start) body(--k, first -= n, n);
        });
    }
}

// What tiles have given to columns of later ones: none so far; added to the columns of a tile; as the columns of a tile
// are now, for the tiles before.
template <class V>
HOL_INLINE void clear_contributions(const LdlPlan &s, V *t) {
    for (int64_t k = in_fours(s.n_bonds); k < s.n_columns; ++k) t[k] = V{};
}
template <class V>
HOL_INLINE void add_contributions(const LdlPlan &s, const Tile &tile, V *t) {
    for (int32_t i = tile.first_late; i < tile.end_late; ++i)
        t[s.late[i].number] = t[s.late[i].number] + t[s.late[i].contribution];
}
template <class V>
HOL_INLINE void give_contributions(const LdlPlan &s, const Tile &tile, V *t) {
    for (int32_t i = tile.first_late; i < tile.end_late; ++i) t[s.late[i].contribution] = t[s.late[i].number];
}
// The same of entries.
template <class V>
HOL_INLINE void clear_entries(const LdlPlan &s, V *lower) {
    const Tile &last = s.tile[s.n_tiles - 1];
    for (int64_t e = in_fours(last.end_entry); e < s.n_entries; ++e) lower[e] = V{};
}
template <class V>
HOL_INLINE void add_entries(const LdlPlan &s, const Tile &tile, V *lower) {
    for (int32_t i = tile.first_late_entry; i < tile.end_late_entry; ++i)
        lower[s.late_entry[i].number] = lower[s.late_entry[i].number] + lower[s.late_entry[i].contribution];
}

// Another right-hand side, in t: up along the columns of a factor with a diagonal of ones, and down with the pivots and
// the factor above the diagonal, which is the same one where the matrix is symmetric.
template <class V>
HOL_INLINE void solve_up(const LdlPlan &s, const Tile &tile, const V *lower, V *t) {
    add_contributions(s, tile, t);
    for_columns_up(s, tile, [&](int32_t k, int32_t first, int32_t n) HOL_FORCED {
        const int32_t *const row = s.row + first;
        const V *const l = lower + first, y = t[k];
        HOL_UNROLL_FEW
        for (int32_t e = 0; e < n; ++e) t[row[e]] = mul_add(-l[e], y, t[row[e]]);
    });
}
template <class V, class Each>
HOL_INLINE void solve_down(const LdlPlan &s, const Tile &tile, const V *upper, const V *r, V *t, const Each &each) {
    for_columns_down(s, tile, [&](int32_t k, int32_t first, int32_t n) HOL_FORCED {
        const int32_t *const row = s.row + first;
        const V *const u = upper + first;
        V x = t[k] * r[k];
        HOL_UNROLL_FEW
        for (int32_t e = n - 1; e >= 0; --e) x = mul_add(-u[e], t[row[e]], x);
        t[k] = x;
        each(k, x);
    });
    give_contributions(s, tile, t);
}

// What the bonds of a tile, times these multipliers, pull its sites by. Bonds and sites count from its first.
template <class V>
HOL_INLINE void sum_pulls(const LdlPlan &s, const Tile &tile, const V *multiplier, const Rows<V> &bonds,
                          const Rows<V> &of) {
    const Rows<V> bond = bonds.from(-tile.first);
    const int32_t *const from = s.from + (tile.first_row - tile.first), *const to = s.to + (from - s.from);
    for (int64_t i = 0; i < tile.end_site - tile.first_site; ++i) set_vector(of[i], RowOf<V>{});
    for (int64_t k = tile.first; k < tile.end; ++k) {
        const RowOf<V> p = in_row(multiplier[k]) * bond[k];
        RowOf<V> &head = of.at_four_times(from[k]), &tail = of.at_four_times(to[k]);
        set_vector(head, head + p);
        set_vector(tail, tail - p);
    }
}
// Adds what pulls ghosts of later tiles to what pulls the atoms of a tile, by their sites.
template <class V>
HOL_INLINE void add_visits(const LdlPlan &s, const Tile &tile, const Rows<V> &ghosts, const Rows<V> &pull) {
    for (int32_t i = tile.first_visit; i < tile.end_visit; ++i)
        pull[s.visit[i].own] = pull[s.visit[i].own] + ghosts[s.visit[i].ghost];
}
// Ghosts are as their atoms are.
template <class V>
HOL_INLINE void copy_ghosts(const LdlPlan &s, const Tile &tile, const Rows<V> &x) {
    for (int32_t site = tile.own_end; site < tile.end_site; ++site) x[site] = x[s.home[site]];
}

// An atom's row, by its number.
template <bool packed>
HOL_INLINE Row row_at(const AtomArray &array, int64_t number) {
#if defined(__AVX2__)
    if (packed)
        return _mm256_maskload_pd(reinterpret_cast<const double *>(array.x) + 3 * number,
                                  _mm256_set_epi64x(0, -1, -1, -1));
#endif
    double x[3];
    read_atom(array, number, x);
    return Row{x[0], x[1], x[2], 0};
}
// Calls body(site of the tile, rows of these arrays) for the sites of a tile of one molecule; rows that are not read
// are 0. w: gets the inverse masses, or nullptr.
template <bool packed, bool with_second, bool with_third, class Body>
HOL_INLINE void for_sites(const Atoms<double> &at, const LdlPlan &s, const Tile &tile, const MoleculeLane &lane,
                          double *w, const AtomArray &one, const AtomArray &second, const AtomArray &third,
                          const Body &body) {
    const int64_t *const list = at.list[0], first = at.first[0];
    const auto number = [&](int32_t i) HOL_FORCED { return list ? list[s.atom_of[i]] : first + s.atom_of[i]; };
    const int32_t fetched_end = packed && is_from_memory(s) ? tile.end_site - rows_ahead : 0;  // else in a cache
    for (int32_t i = tile.first_site; i < tile.end_site; ++i) {
        if (i < fetched_end) {
            const int64_t element = 3 * number(i + rows_ahead);
            fetch_row(one, element);
            if (with_second) fetch_row(second, element);
            if (with_third) fetch_row(third, element);
            if (w) __builtin_prefetch(lane.w + s.atom_of[i + rows_ahead], 0, 2);
        }
        const int32_t site = i - tile.first_site;
        const int64_t n = number(i);
        if (w) w[site] = lane.w[s.atom_of[i]];
        body(site, row_at<packed>(one, n), with_second ? row_at<packed>(second, n) : Row{},
             with_third ? row_at<packed>(third, n) : Row{});
    }
}
// The rows of a tile's atoms. What is in lanes has one tile.
HOL_INLINE void read_atoms(const AtomArray &array, const Atoms<double> &at, const LdlPlan &s, const Tile &tile,
                           const Rows<double> &to) {
    choose(
        [&](auto packed) HOL_FORCED {
            for_sites<packed, false, false>(at, s, tile, {}, nullptr, array, array, array,
                                            [&](int32_t i, const Row &a, const Row &, const Row &)
                                                HOL_FORCED { to[i] = a; });
        },
        at.layout != elements);
}
template <class V>
HOL_INLINE void read_atoms(const AtomArray &array, const Atoms<V> &at, const LdlPlan &s, const Tile &,
                           const Rows<V> &to) {
    read_vectors(array, at, s.site_of, s.n_atoms, to.by_index());
}
// Writes row(site of the tile) of all own atoms of a tile: not where atoms belong to other molecules, too.
template <class Value>
HOL_INLINE void write_tile(const AtomArray &array, const Atoms<double> &at, const LdlPlan &s, const Tile &tile,
                           const Value &row) {
    const int32_t *const atom_of = s.atom_of + tile.first_site;
    const int32_t n = tile.own_end - tile.first_site;
    const auto number = [&](int32_t i) HOL_FORCED { return at.number(0, atom_of[i]); };
    if (at.layout == elements) {
        for (int32_t i = 0; i < n; ++i) write_one(array, number(i), vector_of(row(i)));
        return;
    }
    const int32_t fetched_end = is_from_memory(s) ? n - rows_ahead : 0;  // else in a cache
    for (int32_t i = 0; i < n; ++i) {
        if (i < fetched_end) fetch_row<1>(array, 3 * number(i + rows_ahead));
        double *const p = reinterpret_cast<double *>(array.x) + 3 * number(i);
        write_rows(&p, vector_of(row(i)));
    }
}
// One of the values of a tile's sites, by four times the site's number.
template <class V>
HOL_INLINE const V &at_four_times(const V *values, int32_t k) {
    constexpr int64_t quarter = sizeof(V) / 4;  // bytes
    return *reinterpret_cast<const V *>(reinterpret_cast<const char *>(values) + quarter * k);
}
// The inverse masses of the columns' ends, and the sums of those of both ends.
template <class V>
HOL_INLINE Columns<V> masses_at(const V *w, const int32_t *end) {
    const auto of = [&](int i) HOL_FORCED { return at_four_times(w, end[i]); };
    if constexpr (at_once<V> == 4)
        return Row{of(0), of(1), of(2), of(3)};
    else
        return of(0);
}
template <class V>
HOL_INLINE Columns<V> masses_at(const V *w, const int32_t *from, const int32_t *to) {
    return masses_at<V>(w, from) + masses_at<V>(w, to);
}
// Inverse masses of molecules in lanes.
template <class V>
HOL_INLINE void read_masses(const MoleculeLane *lane, const LdlPlan &s, V *w) {
    for (int32_t i = 0; i < s.n_sites; ++i)
        for (int l = 0; l < Width<V>::lanes; ++l) Width<V>::set(w[i], l, lane[l].w[s.atom_of[i]]);
}
// Those of a tile as entries share them: -w_0, w_0, -w_1, .. , 0.
template <class V>
HOL_INLINE void sign_masses(const Tile &tile, const V *w, V *masses) {
    const V *const of = w + tile.first_site;
    const int32_t n = tile.end_site - tile.first_site;
    for (int32_t i = 0; i < n; ++i) {
        masses[2 * i] = -of[i];
        masses[2 * i + 1] = of[i];
    }
    masses[2 * n] = V{};
}
HOL_INLINE int64_t most_masses(const LdlPlan &s) { return in_fours(2 * static_cast<int64_t>(s.most_sites) + 1); }

// The nearest image of a bond.
HOL_INLINE void take_image(const Box &box, Row &d) {
    if (box.lattice == Box::orthorhombic) {
        const Row per_side = {box.per_side[0], box.per_side[1], box.per_side[2], 0},
                  minus_side = {box.minus_side[0], box.minus_side[1], box.minus_side[2], 0};
        d = multiply_add(round_row(d * per_side), minus_side, d);
        return;
    }
    Vector3<double> bond = vector_of(d), unused = {};
    take_image<false>(box, bond, unused);
    d = row_of(bond);
}
template <class V>
HOL_INLINE void take_image(const Box &box, RowInLanes<V> &d) {
    Vector3<V> bond = vector_of(d), unused = {};
    take_image<false>(box, bond, unused);
    d = row_of(bond);
}
// The bond of a row.
template <class V>
HOL_INLINE RowOf<V> bond_at(const LdlPlan &s, int64_t row, const Box &box, const Rows<V> &r) {
    RowOf<V> bond = r.at_four_times(s.to[row]) - r.at_four_times(s.from[row]);
    if (box.lattice != Box::none) take_image(box, bond);
    return bond;
}
// A tile's bonds as they come, from the coordinates of their ends: as many as are worked on at a time, the inert ones
// too.
template <class V>
HOL_INLINE void find_bonds(const LdlPlan &s, const Tile &tile, const Box &box, const Rows<V> &r, const Rows<V> &d) {
    for (int64_t k = tile.first_row; k < tile.end_row; ++k) d[k] = bond_at(s, k, box, r);
}

}  // namespace holonomic::HOL_ISA::graph
