// A dense matrix of which the first unknowns are eliminated: A = L D U, with ones on the diagonals of L and U, and what
// is left of the others. No pivot is sought.
#pragma once

#include "core/kernels/arithmetic/width.hpp"
#include "core/kernels/molecules/share_out.hpp"

namespace holonomic::HOL_ISA::graph {

// Columns of L and rows of U, `height` numbers each, stand one behind the other; of a symmetric matrix they are the
// same array. What is left has `height - own` numbers in each column; below the diagonal is enough if it is symmetric.
// Own unknowns and all others are filled up to a multiple of `unit` by ones on the diagonal, and by zeros.
struct Dense {
    static constexpr int32_t step = 4, unit = W > step ? W : step;  // columns that are worked on at once
    static constexpr int32_t panel = 16;                            // columns whose products are added at once
    static constexpr int32_t rows_in_cache = 96, many_blocks = 6;   // that threads are worth waiting for
    int32_t own, height;
    double *lower, *upper, *left;
    double *per_pivot;  // [own]
    double *factor;     // [panel height] - D U of a panel, or - D L, row by row
    const LongTeam *team;

    static constexpr int32_t filled(int32_t n) { return (n + unit - 1) / unit * unit; }
    bool symmetric() const { return lower == upper; }

    // per_pivot has whole diagonal elements. False if a pivot is not more than this part of its own, of its sign.
    __attribute__((noinline)) bool eliminate(double least_left) const {
        double *const other = factor + static_cast<int64_t>(panel) * height;
        bool good = true;
        for (int32_t first = 0; first < own; first += panel) {
            const int32_t end = own - first < panel ? own : first + panel;
            for (int32_t c = first; c < end; c += step) {
                good = divide_step(c, least_left) && good;
                const int64_t next = (c + step) * panel + c - first;
                list_factors(upper, c, c + step, own, factor + next);
                if (!symmetric()) list_factors(lower, c, c + step, own, other + next);
                subtract(lower, height, lower, c, c + step, end, factor + c - first);
                if (!symmetric()) subtract(upper, height, upper, c, c + step, end, other + c - first);
            }
            subtract_panel(first, end, factor, other);
        }
        subtract_own();
        return good;
    }

    // The first half of a solution: what own unknowns give to all others. z: [height].
    __attribute__((noinline)) void take_up(double *z) const {
        for (int32_t c = 0; c < own; c += step) {
            const double *const l = lower + static_cast<int64_t>(c) * height;
            for (int32_t p = 0; p < step; ++p)
                for (int32_t q = p + 1; q < step; ++q) z[c + q] = mul_add(-l[p * height + c + q], z[c + p], z[c + q]);
            const double y[step] = {-z[c], -z[c + 1], -z[c + 2], -z[c + 3]};
            for_rows(c + step, [&](auto width, int32_t i) HOL_FORCED {
                typedef decltype(width) V;
                V sum = load_any<V>(z + i);
                for (int p = 0; p < step; ++p) sum = mul_add(load_any<V>(l + p * height + i), Width<V>::all(y[p]), sum);
                store_any(z + i, sum);
            });
        }
    }
    // The second half: the own ones from all others.
    __attribute__((noinline)) void take_down(double *z) const {
        for (int32_t c = own; (c -= step) >= 0;) {
            const double *const u = upper + static_cast<int64_t>(c) * height;
            double sum[step] = {};
            vec sums[step] = {};
            for_rows(c + step, [&](auto width, int32_t i) HOL_FORCED {
                typedef decltype(width) V;
                for (int p = 0; p < step; ++p)
                    add(load_any<V>(u + p * height + i), load_any<V>(z + i), sums[p], sum[p]);
            });
            for (int32_t p = step; p-- > 0;) {
                double &of = z[c + p];
                of = mul_add(of, per_pivot[c + p], -(sum[p] + sum_lanes(sums[p])));
                for (int32_t q = p + 1; q < step; ++q) of = mul_add(-u[p * height + c + q], z[c + q], of);
            }
        }
    }

private:
    double &at(double *of, int32_t row, int32_t column) const {
        return of[static_cast<int64_t>(column) * height + row];
    }
    HOL_FORCED static void add(const vec &a, const vec &b, vec &sum, double &) { sum = mul_add(a, b, sum); }
    HOL_FORCED static void add(double a, double b, vec &, double &sum) { sum = mul_add(a, b, sum); }
    // Calls body(value of the width, i) for all rows from `first` on.
    template <class Body>
    HOL_FORCED void for_rows(int32_t first, const Body &body) const {
        int32_t i = first;
        if (W > step)
            for (; i % W; ++i) body(double{}, i);
        for (; i < height; i += W) body(vec{}, i);
    }

    // Columns c to c + step of L, rows of U.
    bool divide_step(int32_t c, double least_left) const {
        double *const l = &at(lower, 0, c), *const u = &at(upper, 0, c);
        bool good = true;
        double pivot[step], per[step];
        for (int32_t p = 0; p < step; ++p) {
            double *const lp = l + p * height + c, *const up = u + p * height + c;
            const double d = lp[p], whole = per_pivot[c + p];
            good = good && (whole < 0 ? d < least_left * whole : d > least_left * whole);
            pivot[p] = d;
            per[p] = per_pivot[c + p] = 1 / d;
            for (int32_t q = p + 1; q < step; ++q) {
                lp[q] *= per[p];
                if (!symmetric()) up[q] *= per[p];
            }
            for (int32_t q = p + 1; q < step; ++q) {
                const double below = lp[q] * d, right = up[q] * d;
                for (int32_t i = q; i < step; ++i) {
                    l[q * height + c + i] = mul_add(-lp[i], right, l[q * height + c + i]);
                    if (!symmetric() && i > q) u[q * height + c + i] = mul_add(-up[i], below, u[q * height + c + i]);
                }
            }
        }
        divide_columns(l, u + c, c, pivot, per);
        if (!symmetric()) divide_columns(u, l + c, c, pivot, per);
        return good;
    }
    // The rows of `of` below these columns; `across`: the other factor's numbers in the block on the diagonal.
    HOL_FORCED void divide_columns(double *of, const double *across, int32_t c, const double *pivot,
                                   const double *per) const {
        double f[step][step];
        for (int p = 0; p < step; ++p)
            for (int q = p + 1; q < step; ++q) f[p][q] = -across[p * height + q] * pivot[p];
        for_rows(c + step, [&](auto width, int32_t i) HOL_FORCED {
            typedef decltype(width) V;
            V a[step];
            for (int p = 0; p < step; ++p) a[p] = load_any<V>(of + p * height + i);
            for (int p = 0; p < step; ++p) {
                a[p] = a[p] * Width<V>::all(per[p]);
                for (int q = p + 1; q < step; ++q) a[q] = mul_add(a[p], Width<V>::all(f[p][q]), a[q]);
                store_any(of + p * height + i, a[p]);
            }
        });
    }
    // - D times these columns of `of`, from a row on, row by row, to the columns of a panel.
    void list_factors(const double *of, int32_t c, int32_t begin, int32_t end, double *to) const {
        const double *const u = of + static_cast<int64_t>(c) * height;
        double minus[step];
        for (int p = 0; p < step; ++p) minus[p] = -1 / per_pivot[c + p];
        for (int32_t i = begin; i < end; ++i, to += panel)
            for (int p = 0; p < step; ++p) to[p] = minus[p] * u[p * height + i];
    }

    // From columns `begin` to `end` of `from`, in their rows from the diagonal on, the products of the step at c.
    HOL_FORCED void subtract(double *from, int32_t stride, const double *l, int32_t c, int32_t begin, int32_t end,
                             const double *factors) const {
        for (int32_t j = begin; j < end; j += step)
            subtract_rows(from + static_cast<int64_t>(j) * stride, stride, l + static_cast<int64_t>(c) * height,
                          j / W * W, height, factors + j * panel, step);
    }
    // The products of a whole panel from the own columns that follow.
    void subtract_panel(int32_t first, int32_t end, const double *factors, const double *other) const {
        const int64_t panel_begins = static_cast<int64_t>(first) * height;
        for (int32_t row = end / W * W; row < height; row += rows_in_cache) {
            const int32_t last = height - row < rows_in_cache ? height : row + rows_in_cache;
            for (int32_t j = end; j < own && j / W * W < last; j += step) {
                const int32_t begin = j / W * W > row ? j / W * W : row;
                subtract_rows(&at(lower, 0, j), height, lower + panel_begins, begin, last, factors + j * panel,
                              end - first);
                if (!symmetric())
                    subtract_rows(&at(upper, 0, j), height, upper + panel_begins, begin, last, other + j * panel,
                                  end - first);
            }
        }
    }
    // The products of all own columns from what is left, so many columns at a time.
    void subtract_own() const {
        const int32_t rest = height - own, columns = 2 * panel, n_blocks = (rest + columns - 1) / columns;
        share_out(n_blocks < many_blocks ? nullptr : team, factor, n_blocks, [&](int32_t block, double *factors) {
            const int32_t begin = own + block * columns, end = height - begin < columns ? height : begin + columns;
            for (int32_t c = 0; c < own; c += step)
                list_factors(upper, c, begin, end, factors + c / panel * panel * columns + c % panel);
            for (int32_t row = symmetric() ? begin / W * W : own; row < height; row += rows_in_cache) {
                const int32_t last = height - row < rows_in_cache ? height : row + rows_in_cache;
                for (int32_t first = 0; first < own; first += panel)
                    for (int32_t j = begin; j < end; j += step)
                        subtract_rows(left + static_cast<int64_t>(j - own) * rest - own, rest,
                                      lower + static_cast<int64_t>(first) * height,
                                      symmetric() && j / W * W > row ? j / W * W : row, last,
                                      factors + first * columns + (j - begin) * panel,
                                      own - first < panel ? own - first : panel);
            }
        });
    }

    // Of one step's columns, n terms.
    __attribute__((noinline)) void subtract_rows(double *from, int32_t stride, const double *l, int32_t begin,
                                                 int32_t end, const double *factors, int32_t n) const {
        int32_t i = begin;
        for (; i + 3 * W <= end; i += 3 * W) subtract_tile<3>(from + i, stride, l + i, factors, n);
        for (; i < end; i += W) subtract_tile<1>(from + i, stride, l + i, factors, n);
    }
    template <int vectors>
    HOL_FORCED void subtract_tile(double *from, int32_t stride, const double *l, const double *factors,
                                  int32_t n) const {
        vec sum[vectors][step];
        HOL_UNROLL
        for (int v = 0; v < vectors; ++v) HOL_UNROLL
        for (int j = 0; j < step; ++j) sum[v][j] = load(from + static_cast<int64_t>(j) * stride + v * W);
        for (int32_t p = 0; p < n; ++p) {
            const double *const column = l + static_cast<int64_t>(p) * height;
            vec a[vectors];
            HOL_UNROLL
            for (int v = 0; v < vectors; ++v) a[v] = load(column + v * W);
            HOL_UNROLL
            for (int j = 0; j < step; ++j) {
                const vec f = splat(factors[j * panel + p]);
                HOL_UNROLL
                for (int v = 0; v < vectors; ++v) sum[v][j] = mul_add(a[v], f, sum[v][j]);
            }
        }
        HOL_UNROLL
        for (int v = 0; v < vectors; ++v) HOL_UNROLL
        for (int j = 0; j < step; ++j) store(from + static_cast<int64_t>(j) * stride + v * W, sum[v][j]);
    }
};

}  // namespace holonomic::HOL_ISA::graph
