// Newton's method for the positions of molecules by sparse LDL^T (core/plan/sparse_ldl.hpp): the matrix of new bonds D
// times reference bonds b as it stands, L D U. What can be done while a tile is in a cache is done together: on the way
// up bonds, what is left of them and factors, on the way down corrections and displacements.
#pragma once

#include "core/kernels/molecules/sparse_ldl/displacements.hpp"

namespace holonomic::HOL_ISA::graph {

// As Newton (newton.hpp) for iterate().
template <class V>
struct LdlNewton : LdlDisplacements<V> {
    typedef LdlDisplacements<V> Moves;
    using Moves::s, Moves::t, Moves::tau, Moves::D, Moves::b, Moves::w, Moves::moved, Moves::some, Moves::step;
    using typename Moves::Row;
    V *r_pivot;  // 1 / pivot
    V *lower, *upper;
    V *kept;          // what other lanes have, while factors are made for some
    bool eliminated;  // t has been taken up through the factors

    static int64_t kept_values(const LdlPlan &s) {
        return Width<V>::lanes == 1 ? 0 : 3 * in_fours(s.n_bonds) + 2 * in_fours(s.n_entries);
    }
    static int64_t values(const LdlPlan &s) {
        return Moves::values(s) + kept_values(s) + in_fours(s.n_columns) + 2 * in_fours(s.n_entries);
    }
    LdlNewton(const LdlPlan &list, const LongTeam *threads, Memory<V> &memory)
        : Moves(list, threads, memory), eliminated(false) {
        lower = memory.values(in_fours(s.n_entries));
        upper = memory.values(in_fours(s.n_entries));
        r_pivot = memory.values(in_fours(s.n_columns));
        kept = memory.values(kept_values(s));
    }

    V move() {
        eliminated = false;
        return Moves::move();
    }

    // Factors for the bonds as they are; the first solve with them follows.
    void first_factors() {
        if (!eliminated) factorize(~Width<V>::none());
    }
    // In the lanes of `which`. The others keep theirs: what is left of all is taken up when they are all in place.
    void factorize(MaskOf<V> which) {
        const bool for_some = bits(which) != all_of<V>;
        V *const left = kept, *const factors = kept + s.n_bonds;
        for (int32_t k = 0; for_some && k < s.n_bonds; ++k) left[k] = t[k];
        if (for_some) for_factors([&](V &value, int64_t i) HOL_FORCED { factors[i] = value; });
        make_factors([&](const Tile &tile, const Rows<V> &rows) HOL_FORCED {
            const Rows<V> d = bonds_of(tile, rows);
            this->template measure_tile<true>(tile, d);
            for (int32_t k = tile.first; for_some && k < tile.end; ++k) left[k] = select(which, t[k], left[k]);
            assemble(tile, d, rows);
        });
        if (!for_some) return;
        for_factors([&](V &value, int64_t i) HOL_FORCED { value = select(which, value, factors[i]); });
        for (int32_t k = 0; k < s.n_bonds; ++k) t[k] = left[k];
        eliminated = false;
    }
    // A tile's bonds as they are, in the rows of this thread where they have been moved.
    Rows<V> bonds_of(const Tile &tile, const Rows<V> &rows) const {
        if (!moved) return D.from(tile.first_row);
        for (int64_t row = tile.first_row; row < tile.end_row; ++row)
            rows[row - tile.first_row] = this->moved_bond(tile, row);
        return rows;
    }
    // The lanes in which the symmetric part of the matrix is positive definite for the bonds as they are: no other root
    // has that (core/long_step/roots.hpp). The factors are lost.
    __attribute__((noinline)) MaskOf<V> is_certified() {
        make_factors([&](const Tile &tile, const Rows<V> &rows) HOL_FORCED {
            assemble(tile, bonds_of(tile, rows), rows);
            for (int64_t e = tile.first_entry; e < tile.end_entry; e += step)
                some(lower, e) = some(upper, e) = all_columns<V>(0.5) * (some(lower, e) + some(upper, e));
        });
        this->up([&](const Tile &tile, const Rows<V> &rows) {
            const Rows<V> d = bonds_of(tile, rows), ref = b.from(tile.first_row);
            const V *const of_site = w + tile.first_site;
            const int32_t *const from = s.from + tile.first_row, *const to = s.to + tile.first_row;
            V most = {};  // of a diagonal element over its pivot
            for (int32_t k = 0; k < tile.end - tile.first; ++k) {
                const V sum = at_four_times(of_site, from[k]) + at_four_times(of_site, to[k]),
                        ratio = sum * dot(vector_of(d[k]), vector_of(ref[k])) * r_pivot[tile.first + k];
                most = max(select(less(V{}, ratio), ratio, Width<V>::all(__builtin_inf())), most);
            }
            this->found[&tile - s.tile].pull = most;
        });
        V most = {};
        for (int32_t i = 0; i < s.n_tiles; ++i) most = max(this->found[i].pull, most);
        return less(most, Width<V>::all(1 / least_pivot));
    }
    // Calls body(value, its number) for all values that factors are made of.
    template <class Body>
    HOL_FORCED void for_factors(const Body &body) const {
        const int64_t bonds = s.n_bonds, entries = s.n_entries;
        for (int64_t k = 0; k < bonds; ++k) {
            body(this->stretch[k], k);
            body(r_pivot[k], bonds + k);
        }
        for (int64_t e = 0; e < entries; ++e) {
            body(lower[e], 2 * bonds + e);
            body(upper[e], 2 * bonds + entries + e);
        }
    }
    // start(tile, rows of the thread) finds what the factors start from.
    template <class Start>
    __attribute__((noinline)) void make_factors(const Start &start) {
        clear_contributions(s, t);
        clear_contributions(s, r_pivot);
        clear_entries(s, lower);
        clear_entries(s, upper);
        this->up([&](const Tile &tile, const Rows<V> &rows) HOL_FORCED {
            start(tile, rows);
            add_contributions(s, tile, t);
            add_contributions(s, tile, r_pivot);
            add_entries(s, tile, lower);
            add_entries(s, tile, upper);
            eliminate(tile);
        });
        eliminated = true;
    }
    __attribute__((noinline)) void assemble(const Tile &tile, const Rows<V> &d, const Rows<V> &rows) const {
        const Rows<V> ref = b.from(tile.first_row);
        V *const masses = this->masses_beside(rows);
        sign_masses(tile, w, masses);
        const int32_t *const from = s.from + tile.first_row, *const to = s.to + tile.first_row;
        for (int64_t k = 0; k < tile.end - tile.first; k += step) {
            Row q[step];
            HOL_UNROLL_FEW
            for (int i = 0; i < step; ++i) q[i] = d[k + i] * ref[k + i];
            some(r_pivot, tile.first + k) = masses_at<V>(w + tile.first_site, from + k, to + k) * sums_of(q);
        }
        for (int64_t e = tile.first_entry; e < tile.end_entry; e += step) {
            const int32_t *const row = s.row_4 + e, *const column = s.column_4 + e;
            const Columns<V> shared = gathered(masses, s.mass + e);
            Row p[step], q[step];
            HOL_UNROLL_FEW
            for (int i = 0; i < step; ++i) {
                p[i] = d.at_four_times(row[i]) * ref.at_four_times(column[i]);
                q[i] = d.at_four_times(column[i]) * ref.at_four_times(row[i]);
            }
            some(lower, e) = shared * sums_of(p);
            some(upper, e) = shared * sums_of(q);
        }
    }

    __attribute__((noinline)) void eliminate(const Tile &tile) const {
        const int32_t *update = s.update + tile.first_update;
        V *const pivot = r_pivot;
        for_columns_up(s, tile, [&](int32_t k, int32_t first, int32_t n) HOL_FORCED {
            const int32_t *const row = s.row + first;
            V *const l = lower + first, *const u = upper + first;
            const V inverse = pivot[k] = Width<V>::all(1) / pivot[k], y = t[k];
            HOL_UNROLL_FEW
            for (int32_t a = 0; a < n; ++a) {
                const V la = l[a], ua = u[a], ur = ua * inverse;
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
        clear_contributions(s, t);
        this->up([&](const Tile &tile, const Rows<V> &) HOL_FORCED { solve_up(s, tile, lower, t); });
    }
    void solve(MaskOf<V> active) {
        solve_down_and(active, [](const Tile &) HOL_FORCED {});
    }
    // And the bonds of a tile as they are moved, while it is in a cache.
    V solve_and_move(MaskOf<V> active) {
        solve_down_and(active, [&](const Tile &tile) HOL_FORCED { this->measure_inner(tile); });
        return this->finish_move();
    }
    template <class Then>
    HOL_FORCED void solve_down_and(MaskOf<V> active, const Then &then) {
        if (!eliminated) take_up();
        eliminated = false;
        this->down([&](const Tile &tile) HOL_FORCED {
            solve_down(s, tile, upper, r_pivot, t,
                       [&](int32_t k, const V &x) HOL_FORCED { tau[k] = tau[k] + keep(active, x); });
            this->pull(tile);
            this->weigh(tile);
            then(tile);
        });
        this->displaced = true;
    }
};
template <class V, class Mask>
HOL_INLINE V solve_and_move(LdlNewton<V> &newton, Mask active) {
    return newton.solve_and_move(active);
}

}  // namespace holonomic::HOL_ISA::graph
