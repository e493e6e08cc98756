// The two halves of a substitution through the columns of a core. If a column's rows are the next ones, as in a strip
// of triangles, their numbers stay in registers, four ahead. Through memory, each column would wait for the stores of
// the one before.
#pragma once

#include "core/kernels/arithmetic/width.hpp"
#include "core/kernels/molecules/schedule.hpp"

namespace holonomic::HOL_ISA::graph {

constexpr int32_t columns_ahead = 4;  // memory behind the numbers of all columns

// Whether the n rows of column p are p + 1 .. p + n, and few.
HOL_INLINE bool are_next(const int32_t *below, int32_t p, int32_t n) {
    return n <= columns_ahead && (n == 0 || below[n - 1] == p + n);
}

// y of row[e] loses entry[e] y_p, column after column. y has n_core + columns_ahead + 1 values.
template <class V>
HOL_INLINE void forward_columns(const Schedule &s, const V *entry, V *y) {
    V c0 = y[0], c1 = y[1], c2 = y[2], c3 = y[3], c4 = y[4];
    for (int32_t p = 0; p < s.n_core; ++p) {
        const int32_t first = s.column_start[p], n = s.column_start[p + 1] - first;
        const V *const l = entry + first;
        const int32_t *const below = s.row + first;
        y[p] = c0;
        if (__builtin_expect(are_next(below, p, n), 1)) {
            if (n > 0) c1 = mul_add(-l[0], c0, c1);
            if (n > 1) c2 = mul_add(-l[1], c0, c2);
            if (n > 2) c3 = mul_add(-l[2], c0, c3);
            if (n > 3) c4 = mul_add(-l[3], c0, c4);
        } else {
            y[p + 1] = c1;
            y[p + 2] = c2;
            y[p + 3] = c3;
            y[p + 4] = c4;
            for (int32_t a = 0; a < n; ++a) y[below[a]] = mul_add(-l[a], c0, y[below[a]]);
            c1 = y[p + 1];
            c2 = y[p + 2];
            c3 = y[p + 3];
            c4 = y[p + 4];
        }
        c0 = c1;
        c1 = c2;
        c2 = c3;
        c3 = c4;
        c4 = y[p + 1 + columns_ahead];
    }
}

// t_p = r_p y_p less entry[e] t of row[e], from the last column on, the nearest row last; t takes the place of y and is
// given to found(p, t). per_pivot(p): r_p.
template <class V, class PerPivot, class Found>
HOL_INLINE void back_columns(const Schedule &s, const V *entry, V *y, const PerPivot &per_pivot, const Found &found) {
    V c1 = {}, c2 = {}, c3 = {}, c4 = {};
    for (int32_t p = s.n_core - 1; p >= 0; --p) {
        const int32_t first = s.column_start[p], n = s.column_start[p + 1] - first;
        const V *const l = entry + first;
        const int32_t *const below = s.row + first;
        V t = y[p] * per_pivot(p);
        if (__builtin_expect(are_next(below, p, n), 1)) {
            if (n > 3) t = mul_add(-l[3], c4, t);
            if (n > 2) t = mul_add(-l[2], c3, t);
            if (n > 1) t = mul_add(-l[1], c2, t);
            if (n > 0) t = mul_add(-l[0], c1, t);
        } else {
            for (int32_t a = n - 1; a >= 0; --a) t = mul_add(-l[a], y[below[a]], t);
        }
        y[p] = t;
        found(p, t);
        c4 = c3;
        c3 = c2;
        c2 = c1;
        c1 = t;
    }
}

}  // namespace holonomic::HOL_ISA::graph
