// The proof that what linear.hpp finds needs no refinement. With |.| by elements, it solves equations that are off
// by a few roundings of
//
//     R = |L| D |L^T| |t| + sum over both ends i of w_i |d| sum over the bonds of i of |t| |d|
//
// (elimination and substitutions; the products d.d' and w). Where R is no more than the terms that an equation is made
// of, all errors are of the size of its scale |A^-1| S. Where it is more at a few bonds, their equations are looked at
// in twice the precision, and what is left of these alone is solved for. Elsewhere, or where a pivot is small,
// refinement.hpp corrects, or the extended-precision solver.
#pragma once

#include "core/kernels/arithmetic/thresholds.hpp"
#include "core/kernels/atom.hpp"
#include "core/kernels/molecules/sparse_ldl/factor.hpp"
#include "core/kernels/molecules/sparse_ldl/rates.hpp"
#include "core/kernels/molecules/sparse_ldl/residual.hpp"

namespace holonomic::HOL_ISA::graph {

template <class V>
struct LdlErrorBound {
    typedef RowOf<V> Row;
    static constexpr int step = at_once<V>, lanes = Width<V>::lanes;
    const LdlLinear<V> &x;
    const LdlPlan &s;
    const Inputs &in;
    LdlResidual<V> residual;
    unsigned left;  // lanes in which nothing contradicts
    // Columns of a tile whose bound fails by little, times lanes; and how many each lane has looked at. Where a
    // molecule needs a closer look at more, refinement is cheaper. Right-hand sides that are given are as often small
    // as large.
    static constexpr int32_t most_looks(int32_t columns, bool given) {
        return given ? columns / 16 + 4 : columns / 32 + 2;
    }
    int32_t missed[lanes == 1 ? most_looks(LdlPlan::columns_of_tile, true)
                              : lanes * most_looks(largest_graph_in_lanes, true)];
    int32_t n_missed = 0, looks[lanes];
    // Equations that are left with more than they may: of each tile a list in the memory of refinement, which ends
    // where there is no column. Beside it, in `found`, the largest R over what it may be.
    struct Flagged {
        double left;
        int32_t column, lane;
    };
    Flagged *flag = nullptr;  // the end of the list
    int64_t most_flags = 0;
    LdlErrorBound(const LdlLinear<V> &linear, unsigned not_contradicted)
        : x(linear), s(linear.s), in(linear.in), residual(linear), left(not_contradicted) {}

    // R of a column's bond beside what it may be, by all terms of the equation, in absolute values; of one lane.
    struct Bound {
        double R, most;
        bool holds() const { return R <= most; }
    };
    __attribute__((noinline)) Bound bound_of(const Tile &tile, int32_t k, int lane) const {
        const int32_t row = tile.first_row + (k - tile.first);
        const int32_t end[2] = {s.from[row] / 4, s.to[row] / 4};
        const Row &bond = x.d[row];
        double sum = 0, velocity[2][3] = {}, tensions = 0;
        for (int e = 0; e < 2; ++e) {
            const int32_t site = tile.first_site + end[e];
            const int64_t number = x.at.number(lane, s.atom_of[site]);
            const double w = Width<V>::get(x.w[site], lane);
            const Row &g = in.rates ? x.a[s.home[site]] : x.pull[s.home[site]];  // v + w G; G
            double f[3] = {}, product = 0;
            if (in.v && in.v->x) read_atom(*in.v, number, velocity[e]);
            if (in.f && in.f->x) read_atom(*in.f, number, f);
            for (int c = 0; c < 3; ++c) {
                const double d = component(bond, c, lane);
                sum += w * abs(d * f[c]);
                if (in.rates) sum += abs(d * velocity[e][c]);
                product += d * (in.rates ? component(g, c, lane) : w * (f[c] + component(g, c, lane)));
            }
            sum += abs(product);
            tensions += Width<V>::get(x.tensions_at(site), lane);
        }
        if (in.rhs) sum += abs(0.5 * in.rhs[x.lane[lane].first_bond + s.bond_of[k]]);
        for (int a = 0, e = 0; a < 3 && in.strain; ++a)
            for (int b = a; b < 3; ++b, ++e)
                sum += abs(in.strain[e] * component(bond, a, lane) * component(bond, b, lane));
        for (int c = 0; c < 3 && !in.rates; ++c)
            sum += (velocity[1][c] - velocity[0][c]) * (velocity[1][c] - velocity[0][c]);
        return {Width<V>::get(x.back[k], lane) + Width<V>::get(x.size[k], lane) * tensions,
                most_backward(s.n_bonds) * sum};
    }
    static Flagged *flags_of(const LdlLinear<V> &x, const Tile &tile) {
        return reinterpret_cast<Flagged *>(x.a_low.from(tile.first_site).start);
    }
    V &furthest_of(const Tile &tile) const { return x.found[&tile - s.tile]; }
    void start_looking(const Tile &tile) {
        for (int l = 0; l < lanes; ++l) looks[l] = 0;
        flag = flags_of(x, tile);
        most_flags = static_cast<int64_t>(4 * sizeof(V) / sizeof(Flagged)) * (tile.end_site - tile.first_site) - 1;
    }
    // Notes a column where it fails by little in lanes of `which`; where it does not do, the lane is given up.
    void note_missed(const Tile &tile, int32_t k, unsigned which) {
        for (; which; which &= which - 1) {
            const int lane = __builtin_ctz(which);
            if (looks[lane]++ < most_looks(tile.end - tile.first, in.rhs)) {
                const Bound bound = bound_of(tile, k, lane);
                if (bound.holds()) continue;
                if (bound.R <= most_beyond * bound.most) {
                    V &furthest = furthest_of(tile);
                    Width<V>::set(furthest, lane, max(bound.R / bound.most, Width<V>::get(furthest, lane)));
                    missed[n_missed++] = k * lanes + lane;
                    continue;
                }
            }
            left &= ~(1u << lane);
        }
    }
    // Keeps those of which more is left than may be.
    void look_at_missed(const Tile &tile) {
        if (n_missed > 0) residual.prepare(tile, n_missed, [&](int32_t i) { return missed[i] / lanes; });
        for (; n_missed > 0; --n_missed) {
            const int32_t k = missed[n_missed - 1] / lanes;
            const int lane = missed[n_missed - 1] % lanes;
            if (!(left >> lane & 1)) continue;
            const double of_bond = residual.of(tile, k, lane);
            if (abs(of_bond) <= epsilon * bound_of(tile, k, lane).most) continue;
            if (abs(of_bond) < 1e300 && most_flags-- > 0) {
                *flag++ = {of_bond, k, lane};
                flag->column = -1;
            } else {
                left &= ~(1u << lane);
            }
        }
    }
    // Solves for what is left of equations flagged alone. The bound is the same with the changes in place of
    // multipliers, so it is no more than the part of R that each change is of its multiplier: theory (55b).
    // Returns the lanes of `left` in which it is small enough. Changes stand where rates do, which are found once more.
    static unsigned correct(const LdlLinear<V> &all, unsigned left) {
        V furthest = Width<V>::all(1);
        bool any_flags = false;
        for (int32_t i = 0; i < all.s.n_tiles; ++i) {
            any_flags = any_flags || flags_of(all, all.s.tile[i])->column >= 0;
            furthest = max(all.found[i], furthest);
        }
        if (!any_flags) return left;
        V *const change = all.back;
        clear_contributions(all.s, change);
        all.up([&](const LdlLinear<V> &own, const Subtree &subtree) HOL_FORCED {
            for_tiles_up(own.s, subtree, [&](const Tile &tile) HOL_FORCED {
                for (int32_t k = tile.first; k < tile.end; ++k) change[k] = V{};
                for (const Flagged *of = flags_of(own, tile); of->column >= 0; ++of)
                    if (left >> of->lane & 1) Width<V>::set(change[of->column], of->lane, of->left);
                solve_up(own.s, tile, own.lower, change);
            });
        });
        all.down([&](const LdlLinear<V> &own, const Subtree &subtree) HOL_FORCED {
            MaskOf<V> small = Width<V>::of_bits(left);
            for_tiles_down(own.s, subtree, [&](const Tile &tile) HOL_FORCED {
                solve_down(own.s, tile, own.lower, own.per_pivot, change, [&](int32_t k, const V &of_bond) HOL_FORCED {
                    small = small & less_equal(8 * furthest * abs(of_bond), abs(own.t[k]));
                });
            });
            all.left[&subtree - own.s.subtree] = bits(small);
        });
        const unsigned good = all.in_all_subtrees(all.left);
        for (int32_t k = 0; k < all.s.n_bonds; ++k) all.t[k] = all.t[k] + keep(Width<V>::of_bits(good), change[k]);
        find_pulls_again(all);
        return good;
    }
    // Of a tile, but for the bonds of which not all is known yet. A part of the terms does for most.
    void look_at(const Tile &tile) {
        if (x.with_rates) {
            const int32_t *const outer = s.outer + tile.first_outer;
            const int32_t n = tile.end_outer - tile.first_outer;
            for (int32_t i = 0; i < n; ++i) x.diagonal[i] = x.back[outer[i]];  // R, not complete yet
            look_at<true>(tile);
            for (int32_t i = 0; i < n; ++i) x.back[outer[i]] = x.diagonal[i];
        } else {
            look_at<false>(tile);
        }
        look_at_missed(tile);
    }
    // with_rates: finds what is left of the bonds' rates, in the place of R.
    template <bool with_rates>
    __attribute__((noinline)) void look_at(const Tile &tile) {
        const Columns<V> most = all_columns<V>(most_backward(s.n_bonds));
        const Rows<V> of = x.a_of(tile);
        int32_t next = tile.first_outer;
        start_looking(tile);
        flag->column = -1;
        furthest_of(tile) = Width<V>::all(1);
        for (int32_t k = tile.first; k < tile.end && left; k += step) {
            const int32_t first_row = tile.first_row + (k - tile.first);
            Row p[step], q[step], e[step], input[step];
            Columns<V> T = {};
            HOL_UNROLL
            for (int i = 0; i < step; ++i) {
                const int32_t from = s.from[first_row + i], to = s.to[first_row + i];
                const Row &bond = x.d[first_row + i], &head = of.at_four_times(from), &tail = of.at_four_times(to);
                p[i] = bond * head;
                q[i] = bond * tail;
                if (with_rates) e[i] = bond * (tail - head);
                input[i] = absolute(bond) * (x.v.at_four_times(from) + x.v.at_four_times(to));
                put<V>(T, i, more_of(head) + more_of(tail));
            }
            const Columns<V> part = absolute(sums_of(p)) + absolute(sums_of(q)) + sums_of(input),
                             spare = multiply_add(most, part, -multiply_add(x.some(x.size, k), T, x.some(x.back, k)));
            // What is 0 is looked at once more.
            const bool all = all_positive<V>(spare);
            for (int i = 0; __builtin_expect(!all, 0) && i < step && k + i < tile.end; ++i) {
                const unsigned flagged = left & ~not_negative<V>(spare, i);
                if (!flagged) continue;
                while (next < tile.end_outer && s.outer[next] < k + i) ++next;
                if (next < tile.end_outer && s.outer[next] == k + i) continue;
                note_missed(tile, k + i, flagged);
            }
            if (with_rates) x.some(x.rate, k) = sums_of(e);
        }
    }
    // At the others, in the end.
    __attribute__((noinline)) void look_at_outer(const Tile &tile) {
        add_contributions(s, tile, x.back);
        start_looking(tile);
        for (; flag->column >= 0; ++flag) --most_flags;
        for (int32_t k = tile.first_outer; k < tile.end_outer && left; ++k)
            if (!bound_of(tile, s.outer[k], 0).holds()) note_missed(tile, s.outer[k], left);
        look_at_missed(tile);
    }

    // Reads the molecules and eliminates: factors, and right-hand sides on their way up.
    static void factorize(const LdlLinear<V> &all) {
        clear_contributions(all.s, all.t);
        clear_contributions(all.s, all.per_pivot);
        clear_entries(all.s, all.lower);
        all.up([](const LdlLinear<V> &own, const Subtree &subtree) HOL_FORCED {
            unsigned proven = bits(own.in_use()), firm = proven;
            for_tiles_up(own.s, subtree, [&](const Tile &tile) HOL_FORCED {
                own.load(tile);
                own.assemble(tile);
                eliminate(own, tile);
                const unsigned of_tile = pivots_above(own, tile, least_proven_pivot);
                proven &= of_tile;
                if (of_tile != bits(own.in_use())) firm &= pivots_above(own, tile, least_pivot);
            });
            own.left[&subtree - own.s.subtree] = proven;
            own.firm[&subtree - own.s.subtree] = firm;
        });
    }
    // The way down. Returns the lanes in which the proof holds; multipliers are found in all.
    static unsigned solve(const LdlLinear<V> &all) {
        clear_contributions(all.s, all.back);
        for (int64_t k = all.s.n_bonds; k < in_fours(all.s.n_bonds); ++k) all.back[k] = V{};  // inert
        // Where it fails in the separator subtrees need not look; what they do is the same in any case.
        unsigned *const separator = all.left + all.s.n_subtrees;
        *separator = all.in_all_subtrees(all.left);
        all.down([&](const LdlLinear<V> &own, const Subtree &subtree) HOL_FORCED {
            LdlErrorBound proof(own, *separator);
            for_tiles_down(own.s, subtree, [&](const Tile &tile) HOL_FORCED {
                substitute_back(own, tile);
                if (!proof.left) return;
                own.find_pulls(tile);
                own.add_pulls(tile);
                proof.look_at(tile);
            });
            all.left[&subtree - own.s.subtree] = proof.left;
        });
        unsigned left = all.in_all_subtrees(all.left);
        if (!left) return 0;
        all.up([&](const LdlLinear<V> &own, const Subtree &subtree) HOL_FORCED {
            LdlErrorBound proof(own, left);
            for_tiles_up(own.s, subtree, [&](const Tile &tile) HOL_FORCED { proof.look_at_outer(tile); });
            all.left[&subtree - own.s.subtree] = proof.left;
        });
        left &= all.in_all_subtrees(all.left);
        return left ? correct(all, left) : 0;
    }
};

}  // namespace holonomic::HOL_ISA::graph
