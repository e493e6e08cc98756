// L D L^T of the equations of molecules by sparse LDL^T, tile by tile: up with right-hand sides, and back.
#pragma once

#include "core/kernels/molecules/sparse_ldl/linear.hpp"

namespace holonomic::HOL_ISA::graph {

template <class V>
__attribute__((noinline)) void eliminate(const LdlLinear<V> &x, const Tile &tile) {
    add_contributions(x.s, tile, x.t);
    add_contributions(x.s, tile, x.per_pivot);
    add_entries(x.s, tile, x.lower);
    const int32_t *update = x.s.update + tile.first_update;
    V *const pivot = x.per_pivot, *const t = x.t, *const lower = x.lower;
    for_columns_up(x.s, tile, [&](int32_t k, int32_t first, int32_t n) HOL_FORCED {
        const int32_t *const row = x.s.row + first;
        V *const l = lower + first;
        const V inverse = pivot[k] = Width<V>::all(1) / pivot[k], y = t[k];
        HOL_UNROLL_FEW
        for (int32_t i = 0; i < n; ++i) {
            const V li = l[i], lr = li * inverse;
            HOL_UNROLL_FEW
            for (int32_t j = 0; j < i; ++j, ++update)  // l of j is multiplied already
                lower[*update] = mul_add(-li, l[j], lower[*update]);
            pivot[row[i]] = mul_add(-(li * li), inverse, pivot[row[i]]);
            t[row[i]] = mul_add(-lr, y, t[row[i]]);
            l[i] = lr;
        }
    });
}

// The lanes in which all pivots of a tile keep this part of the diagonal elements, and all of these are ordinary.
template <class V>
HOL_INLINE unsigned pivots_above(const LdlLinear<V> &x, const Tile &tile, double part) {
    const Columns<V> most = all_columns<V>(1 / part);
    unsigned all = bits(x.in_use());
    for (int64_t k = tile.first; k < tile.end; k += x.step) {
        const Columns<V> ratio = x.some(x.diagonal, k - tile.first) * x.some(x.per_pivot, k),
                         spare = (most - ratio) * ratio,  // is not positive where one of both is not
            room = all_columns<V>(most_ordinary_pivot) - (x.some(x.diagonal, k - tile.first) + x.some(x.per_pivot, k));
        if (__builtin_expect(all_positive<V>(spare) && all_positive<V>(room), 1)) continue;
        for (int i = 0; i < x.step && k + i < tile.end; ++i) all &= positive<V>(spare, i) & positive<V>(room, i);
    }
    return all;
}

// Back, with the part of R that elimination and substitutions have: error_bound.hpp.
template <class V>
__attribute__((noinline)) void substitute_back(const LdlLinear<V> &x, const Tile &tile) {
    V *const t = x.t, *const back = x.back;
    for_columns_down(x.s, tile, [&](int32_t k, int32_t first, int32_t n) HOL_FORCED {
        const int32_t *const row = x.s.row + first;
        const V *const l = x.lower + first;
        const V inverse = x.per_pivot[k];
        V multiplier = t[k] * inverse, sum = {};
        HOL_UNROLL_FEW
        for (int32_t e = n - 1; e >= 0; --e) {  // the first row is known last
            const V part = l[e] * t[row[e]];
            multiplier = multiplier - part;
            sum = sum + abs(part);
        }
        const V all = (abs(multiplier) + sum) / inverse;
        back[k] = all;
        HOL_UNROLL_FEW
        for (int32_t e = 0; e < n; ++e) back[row[e]] = mul_add(abs(l[e]), all, back[row[e]]);
        t[k] = multiplier;
    });
    give_contributions(x.s, tile, t);
}

}  // namespace holonomic::HOL_ISA::graph
