// Solves with a kept L D L^T in twice the precision, which need no proof. F: of the factor; V: of the right-hand sides,
// which are those of the molecules in the lanes of F, or several of one molecule.
#pragma once

#include "core/kernels/kept/ldl_factor.hpp"

namespace holonomic::HOL_ISA::graph {

template <class V, class F>
struct Broadcast {
    HOL_STATIC V of(const F &a) { return Width<V>::all(a); }
};
template <class V>
struct Broadcast<V, V> {
    HOL_STATIC V of(const V &a) { return a; }
};
template <class V, class F>
HOL_INLINE V spread(const F &a) {
    return Broadcast<V, F>::of(a);
}
template <class V, class F>
HOL_INLINE Pair<V> spread(const Pair<F> &a) {
    return {spread<V>(a.hi), spread<V>(a.lo)};
}

template <class F, class V>
struct LdlKeptSolve {
    const LdlPlan &s;
    const Pairs<F> lower, pivot;
    const F *const size, *const w;  // of bonds, of sites
    const Pairs<V> t;               // right-hand sides, then multipliers

    // What tiles leave for others is nothing so far.
    void start() const {
        clear_contributions(s, t.hi);
        clear_contributions(s, t.lo);
    }
    __attribute__((noinline)) void up(const Tile &tile) const {
        const LdlKeptSolve y = *this;
        for (int32_t i = tile.first_late; i < tile.end_late; ++i)
            y.t.add(y.s.late[i].number, y.t[y.s.late[i].contribution]);
        for_columns_up(y.s, tile, [&](int32_t k, int32_t first, int32_t n) HOL_FORCED {
            const int32_t *const row = y.s.row + first;
            const Pair<V> of_column = tidied(y.t[k]);
            y.t.put(k, of_column);
            HOL_UNROLL_FEW
            for (int32_t e = 0; e < n; ++e) y.t.take(row[e], multiply_pairs(spread<V>(y.lower[first + e]), of_column));
        });
    }
    __attribute__((noinline)) void down(const Tile &tile) const {
        const LdlKeptSolve y = *this;
        for_columns_down(y.s, tile, [&](int32_t k, int32_t first, int32_t n) HOL_FORCED {
            const int32_t *const row = y.s.row + first;
            Pair<V> of_column = multiply_pairs(spread<V>(y.pivot[k]), y.t[k]);
            HOL_UNROLL_FEW
            for (int32_t e = n - 1; e >= 0; --e)  // the first row is known last
                of_column = subtract_pairs(of_column, multiply_pairs(spread<V>(y.lower[first + e]), y.t[row[e]]));
            y.t.put(k, tidied(of_column));
        });
        give_contributions(y.s, tile, y.t.hi);
        give_contributions(y.s, tile, y.t.lo);
    }

    // The lanes in which all multipliers are numbers, and none is so small beside what pulls the atoms of its bond that
    // it may be rounding. least_part: the least part of a diagonal element that a pivot is. T: memory for a number of
    // each site.
    unsigned good_lanes(unsigned of, double least_part, double *T) const {
        V most = {}, least = Width<V>::all(__builtin_inf()), sum = {};
        for (int32_t k = 0; k < s.n_bonds; ++k) {
            const V tension = abs(t.hi[k]) * spread<V>(size[k]);
            most = max(tension, most);
            least = min(tension, least);
            sum = sum + tension;
        }
        // As in cancelling(), whatever the masses are and how many bonds an atom has.
        const double part = cancelling_part / least_part * s.n_bonds;
        const unsigned number = of & bits(finite(sum));
        unsigned flagged = number & ~bits(less_equal(part * most, least)), good = number & ~flagged;
        for (; flagged; flagged &= flagged - 1)
            if (!cancelling(__builtin_ctz(flagged), T)) good |= flagged & -flagged;
        return good;
    }

private:
    // Whether |t| P < 2^-54 |d| sum over both ends of w sum |t| |d| at one of a lane's bonds.
    __attribute__((noinline)) bool cancelling(int lane, double *T) const {
        const auto of = [](const F &a, int l) { return Width<F>::get(a, Width<F>::lanes > 1 ? l : 0); };
        for (int32_t i = 0; i < s.n_sites; ++i) T[i] = 0;
        const auto for_bonds = [&](const auto &body) {
            for (int32_t i = 0; i < s.n_tiles; ++i) {
                const Tile &tile = s.tile[i];
                for (int32_t k = tile.first; k < tile.end; ++k) {
                    const int32_t row = tile.first_row + (k - tile.first);
                    body(k, s.home[tile.first_site + s.from[row] / 4], s.home[tile.first_site + s.to[row] / 4]);
                }
            }
        };
        for_bonds([&](int32_t k, int32_t from, int32_t to) {
            const double tension = abs(Width<V>::get(t.hi[k], lane)) * of(size[k], lane);
            T[from] += tension;
            T[to] += tension;
        });
        bool any = false;
        for_bonds([&](int32_t k, int32_t from, int32_t to) {
            const double all = of(size[k], lane) * (of(w[from], lane) * T[from] + of(w[to], lane) * T[to]);
            any |= abs(Width<V>::get(t.hi[k], lane)) < cancelling_part * all * of(pivot.hi[k], lane);
        });
        return any;
    }
};

}  // namespace holonomic::HOL_ISA::graph
