// The proof that what flat_linear.hpp finds needs no refinement. With |.| by elements, it solves equations that are off
// by a few roundings of
//
//     R = |L| D |L^T| |t| + sum over both ends i of w_i |d| sum over the bonds of i of |t| |d|
//
// (elimination and substitutions; the products d.d' and w). Where R is no more than the terms that an equation is made
// of, all errors are of the size of its scale |A^-1| S. Elsewhere, or where a pivot is small,
// flat_refine.hpp corrects, or linear.hpp.
#pragma once

#include "core/kernels/molecules/cycles/proof.hpp"
#include "core/kernels/molecules/list/flat_residual.hpp"

namespace holonomic::HOL_ISA::graph {

// What is left of an equation is most often less than a third of the roundings of R.
constexpr double often_less = 3;

struct FlatProof {
    const FlatLinear &x;
    const FlatList &s;
    const Inputs &in;
    FlatResidual residual;
    // Columns of a tile whose bound fails by little.
    static constexpr int32_t most_missed = 1024;
    int32_t missed[most_missed], n_missed = 0;
    explicit FlatProof(const FlatLinear &linear) : x(linear), s(linear.s), in(linear.in), residual(linear) {}

    // R of a column's bond beside what it may be, by all terms of the equation, in absolute values.
    struct Bound {
        double R, most;
        bool holds() const { return R <= most; }
    };
    __attribute__((noinline)) Bound bound_of(const Tile &tile, int32_t k) const {
        const int32_t row = tile.first_row + (k - tile.first);
        const int32_t end[2] = {s.from[row] / 4, s.to[row] / 4};
        double sum = 0, velocity[2][3] = {}, tensions = 0;
        for (int e = 0; e < 2; ++e) {
            const int32_t site = tile.first_site + end[e];
            const int64_t number = x.at.number(0, s.atom_of[site]);
            const double w = x.mass[tile.first_mass + 2 * end[e] + 1];
            const Row &g = x.pull[s.home[site]];
            double f[3] = {}, product = 0;
            if (in.v && in.v->x) read_row(*in.v, number, velocity[e]);
            if (in.f && in.f->x) read_row(*in.f, number, f);
            for (int c = 0; c < 3; ++c) {
                sum += w * abs(x.d[row][c] * f[c]);
                if (in.rates) sum += abs(x.d[row][c] * velocity[e][c]);
                product += x.d[row][c] * (w * (f[c] + g[c]) + (in.rates ? velocity[e][c] : 0));
            }
            sum += abs(product);
            tensions += w * g[3];
        }
        if (in.rhs) sum += abs(0.5 * in.rhs[x.lane.first_bond + s.bond_of[k]]);
        for (int a = 0, e = 0; a < 3 && in.strain; ++a)
            for (int b = a; b < 3; ++b, ++e) sum += abs(in.strain[e] * x.d[row][a] * x.d[row][b]);
        for (int c = 0; c < 3 && !in.rates; ++c)
            sum += (velocity[1][c] - velocity[0][c]) * (velocity[1][c] - velocity[0][c]);
        return {x.back[k] + x.size[k] * tensions, most_backward(s.n_bonds) * sum};
    }
    // Notes a column where it fails by little; false where it does not do.
    bool note_missed(const Tile &tile, int32_t k) {
        const Bound bound = bound_of(tile, k);
        if (bound.holds()) return true;
        if (!(bound.R <= often_less * bound.most) || n_missed == most_missed) return false;
        missed[n_missed++] = k;
        return true;
    }
    // Whether what is left of their equations is little enough.
    bool has_small_residuals(const Tile &tile) {
        for (; n_missed > 0; --n_missed) {
            const int32_t k = missed[n_missed - 1];
            if (!(abs(residual.of(tile, k)) <= epsilon * bound_of(tile, k).most)) return false;
        }
        return true;
    }
    // Of a tile, but for the bonds of which not all is known yet. A part of the terms does for most.
    __attribute__((noinline)) bool is_proven(const Tile &tile) {
        const double most = most_backward(s.n_bonds);
        const Rows of = x.a_of(tile);
        int32_t next = tile.first_outer;
        for (int32_t k = tile.first; k < tile.end; k += 4) {
            const int32_t first_row = tile.first_row + (k - tile.first);
            Row p[4], q[4], input[4], T = {};
            HOL_UNROLL
            for (int i = 0; i < 4; ++i) {
                const int32_t from = s.from[first_row + i], to = s.to[first_row + i];
                const Row &bond = x.d[first_row + i], &head = of.at_four_times(from), &tail = of.at_four_times(to);
                p[i] = bond * head;
                q[i] = bond * tail;
                input[i] = absolute(bond) * (x.v.at_four_times(from) + x.v.at_four_times(to));
                T[i] = head[3] + tail[3];
            }
            const Row part = absolute(sums_of(p[0], p[1], p[2], p[3])) + absolute(sums_of(q[0], q[1], q[2], q[3])) +
                             sums_of(input[0], input[1], input[2], input[3]);
            const Row left = multiply_add(in_row(most), part, -multiply_add(x.four(x.size, k), T, x.four(x.back, k))),
                      pivot = multiply_add(in_row(-least_proven_pivot), x.four(x.diagonal, k), x.four(x.E, k));
            for (int i = 0; i < 4 && k + i < tile.end; ++i) {
                if (!(pivot[i] > 0)) return false;
                if (__builtin_expect(left[i] >= 0, 1)) continue;
                while (next < tile.end_outer && s.outer[next] < k + i) ++next;
                if (next < tile.end_outer && s.outer[next] == k + i) continue;
                if (!note_missed(tile, k + i)) return false;
            }
        }
        return has_small_residuals(tile);
    }
    // The others, in the end.
    __attribute__((noinline)) bool is_proven() {
        for (int32_t i = 0; i < s.n_tiles; ++i) add_sides(s, s.tile[i], x.back);
        for (int32_t i = 0; i < s.n_tiles; ++i) {
            for (int32_t k = s.tile[i].first_outer; k < s.tile[i].end_outer; ++k)
                if (!note_missed(s.tile[i], s.outer[k])) return false;
            if (!has_small_residuals(s.tile[i])) return false;
        }
        return true;
    }

    // Reads the molecule and solves; false where that is in doubt. The multipliers are found all the same.
    bool solve() {
        clear_sides(s, x.t);
        clear_sides(s, x.E);
        clear_sides(s, x.back);
        clear_entries(s, x.lower);
        for (int32_t i = 0; i < s.n_tiles; ++i) {
            x.load(s.tile[i]);
            x.assemble(s.tile[i]);
            x.eliminate(s.tile[i]);
        }
        bool good = true;
        for (int32_t i = s.n_tiles; i-- > 0;) {
            x.substitute_back(s.tile[i]);
            if (!good) continue;
            x.find_pulls(s.tile[i]);
            x.load_inputs_again(s.tile[i]);
            x.add_pulls(s.tile[i]);
            good = is_proven(s.tile[i]);
        }
        return good && is_proven();
    }
};

}  // namespace holonomic::HOL_ISA::graph
