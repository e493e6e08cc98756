// The unknowns of a network eliminated directly, front by front (front_plan.hpp): L D U of their matrix (I. Duff, J.
// Reid, ACM Trans. Math. Softw. 9, 302 (1983)). It is a preconditioner: what rounding does to it, residuals show.
#pragma once

#include "core/kernels/molecules/list/flat_list.hpp"
#include "core/kernels/molecules/network/dense.hpp"
#include "core/kernels/molecules/network/network_plan.hpp"
#include "core/kernels/molecules/scratch.hpp"

namespace holonomic::HOL_ISA::graph {

struct Fronts {
    const FrontPlan &s;
    double *lower, *upper, *per_pivot;  // front by front
    double *waiting;                    // what fronts leave, until it is taken up
    double *factor, *z;                 // of one front
    int32_t *at;                        // where the rows of a half are

    struct Sizes {
        int64_t entries, pivots, waiting, tallest;
    };
    static Sizes sizes(const FrontPlan &s) {
        Sizes all = {0, 0, 0, 0};
        int64_t waits = 0;
        for (int32_t f = 0; f < s.n_fronts; ++f) {
            const FrontPlan::Front &front = s.front[f];
            const int64_t own = Dense::filled(front.n_own), rest = rest_of(front);
            all.entries += own * (own + rest);
            all.pivots += own;
            all.tallest = own + rest > all.tallest ? own + rest : all.tallest;
            all.waiting = waits + rest * rest > all.waiting ? waits + rest * rest : all.waiting;
            waits += rest * rest;
            for (const int32_t half : front.half)
                if (half >= 0) waits -= static_cast<int64_t>(rest_of(s.front[half])) * rest_of(s.front[half]);
        }
        return all;
    }
    static int64_t values(const FrontPlan &s, bool symmetric) {
        if (s.n_fronts == 0) return 0;
        const Sizes n = sizes(s);
        return (symmetric ? 1 : 2) * in_fours(n.entries) + in_fours(n.pivots) + in_fours(n.waiting) +
               (2 * Dense::panel + 2) * in_fours(n.tallest);
    }
    Fronts(const FrontPlan &plan, bool symmetric, Memory<double> &memory) : s(plan) {
        if (s.n_fronts == 0) return;
        const Sizes n = sizes(s);
        lower = memory.values(in_fours(n.entries));
        upper = symmetric ? lower : memory.values(in_fours(n.entries));
        per_pivot = memory.values(in_fours(n.pivots));
        waiting = memory.values(in_fours(n.waiting));
        factor = memory.values(2 * Dense::panel * in_fours(n.tallest));
        z = memory.values(in_fours(n.tallest));
        at = reinterpret_cast<int32_t *>(memory.values(in_fours(n.tallest)));
    }

    // A front whose columns begin at `entry`, whose pivots begin at `pivot`.
    Dense dense(const FrontPlan::Front &f, int64_t entry, int64_t pivot) const {
        const int32_t own = Dense::filled(f.n_own);
        return {own, own + rest_of(f), lower + entry, upper + entry, nullptr, per_pivot + pivot, factor};
    }
    // Calls add(front, its matrix) for leaves, which adds their terms; diagonal(unknown): the whole element.
    template <class Add, class Diagonal>
    bool factorize(double least_left, const Add &add, const Diagonal &diagonal) const {
        double *top = waiting;
        int64_t entry = 0, pivot = 0;
        for (int32_t f = 0; f < s.n_fronts; ++f) {
            const FrontPlan::Front &front = s.front[f];
            Dense a = dense(front, entry, pivot);
            a.left = top;
            const int64_t n = static_cast<int64_t>(a.own) * a.height, rest = a.height - a.own;
            clear(a.lower, n);
            if (!a.symmetric()) clear(a.upper, n);
            clear(a.left, rest * rest);
            for (int32_t i = 0; i < a.own; ++i) {
                const bool filled = i >= front.n_own;
                if (filled) a.lower[static_cast<int64_t>(i) * a.height + i] = 1;
                a.per_pivot[i] = filled ? 1 : diagonal(s.row[front.first_row + i]);
            }
            if (front.half[0] < 0) add(front, a);
            for (int i = 1; i >= 0 && front.half[i] >= 0; --i) top = take_half(s.front[front.half[i]], front, a, top);
            if (!a.eliminate(least_left)) return false;
            for (int64_t i = 0; i < rest * rest; ++i) top[i] = a.left[i];
            top += rest * rest;
            entry += n;
            pivot += a.own;
        }
        return true;
    }
    // x: right-hand sides, which become the solution.
    __attribute__((noinline)) void solve(double *x) const {
        int64_t entry = 0, pivot = 0;
        for (int32_t f = 0; f < s.n_fronts; ++f) {
            const FrontPlan::Front &front = s.front[f];
            const Dense a = dense(front, entry, pivot);
            read(front, a, x, false);
            a.take_up(z);
            for (int32_t i = 0; i < front.n_own; ++i) x[s.row[front.first_row + i]] = z[i];
            for (int32_t i = front.n_own; i < front.n_rows; ++i)
                x[s.row[front.first_row + i]] += z[i - front.n_own + a.own];
            entry += static_cast<int64_t>(a.own) * a.height;
            pivot += a.own;
        }
        for (int32_t f = s.n_fronts; f-- > 0;) {
            const FrontPlan::Front &front = s.front[f];
            entry -= static_cast<int64_t>(Dense::filled(front.n_own)) * (Dense::filled(front.n_own) + rest_of(front));
            pivot -= Dense::filled(front.n_own);
            const Dense a = dense(front, entry, pivot);
            read(front, a, x, true);
            a.take_down(z);
            for (int32_t i = 0; i < front.n_own; ++i) x[s.row[front.first_row + i]] = z[i];
        }
    }

    // The element of two rows of a front; of a symmetric one, whose row is not above its column.
    HOL_STATIC double &element(const FrontPlan::Front &f, const Dense &a, int32_t row, int32_t column) {
        const int32_t i = place(f, a, row), j = place(f, a, column);
        if (j < a.own && i >= j) return a.lower[static_cast<int64_t>(j) * a.height + i];
        if (i < a.own) return a.upper[static_cast<int64_t>(i) * a.height + j];
        return a.left[static_cast<int64_t>(j - a.own) * (a.height - a.own) + i - a.own];
    }

private:
    HOL_STATIC int32_t rest_of(const FrontPlan::Front &f) { return Dense::filled(f.n_rows - f.n_own); }
    HOL_STATIC int32_t place(const FrontPlan::Front &f, const Dense &a, int32_t row) {
        return row < f.n_own ? row : row - f.n_own + a.own;
    }
    HOL_STATIC void clear(double *x, int64_t n) {
        for (int64_t i = 0; i < n; ++i) x[i] = 0;
    }
    // What a half has left, which ends at `top`, is added; returns where it began.
    __attribute__((noinline)) double *take_half(const FrontPlan::Front &half, const FrontPlan::Front &whole,
                                                const Dense &a, double *top) const {
        const int32_t n = half.n_rows - half.n_own, stride = rest_of(half), rest = a.height - a.own;
        const double *const from = top - static_cast<int64_t>(stride) * stride;
        for (int32_t i = 0; i < n; ++i) at[i] = place(whole, a, s.to_parent[half.first_row + half.n_own + i]);
        for (int32_t j = 0; j < n; ++j) {
            const double *const column = from + static_cast<int64_t>(j) * stride;
            const int32_t c = at[j];
            double *const to = c < a.own ? a.lower + static_cast<int64_t>(c) * a.height
                                         : a.left + static_cast<int64_t>(c - a.own) * rest - a.own;
            for (int32_t i = j; i < n; ++i) to[at[i]] += column[i];
            if (a.symmetric()) continue;
            int32_t i = 0;
            for (; i < j && at[i] < a.own; ++i) a.upper[static_cast<int64_t>(at[i]) * a.height + c] += column[i];
            for (; i < j; ++i) to[at[i]] += column[i];
        }
        return top - static_cast<int64_t>(stride) * stride;
    }
    void read(const FrontPlan::Front &f, const Dense &a, const double *x, bool all) const {
        for (int32_t i = 0; i < a.own; ++i) z[i] = i < f.n_own ? x[s.row[f.first_row + i]] : 0;
        for (int32_t i = a.own; i < a.height; ++i) {
            const int32_t row = i - a.own + f.n_own;
            z[i] = all && row < f.n_rows ? x[s.row[f.first_row + row]] : 0;
        }
    }
};

}  // namespace holonomic::HOL_ISA::graph
