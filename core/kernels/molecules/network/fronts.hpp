// The unknowns of a network eliminated directly, front by front (core/plan/fronts.hpp): L D U of their matrix (I. Duff,
// J. Reid, ACM Trans. Math. Softw. 9, 302 (1983)). It is a preconditioner: what rounding does to it, residuals show.
#pragma once

#include "core/kernels/molecules/network/dense.hpp"
#include "core/kernels/molecules/scratch.hpp"
#include "core/plan/network.hpp"
#include "core/plan/sparse_ldl.hpp"

namespace holonomic::HOL_ISA::graph {

struct Fronts {
    // Where a front's numbers begin; what it leaves, until it is taken up; and where that is made. What a subtree
    // leaves inside of it stands in the memory of the thread, all other in `waiting`.
    struct Offsets {
        int64_t entry, pivot, left, made;
    };
    const FrontPlan &s;
    const LongTeam *team;
    double *buffer;                     // of this thread; those of the others are as large
    double *lower, *upper, *per_pivot;  // front by front
    double *waiting;                    // what fronts leave
    double *given;                      // by row: what those before give to it of a right-hand side
    Offsets *offsets;
    int64_t before_stack;  // of a thread's memory

    static int64_t values(const FrontPlan &s, bool symmetric) {
        if (s.n_fronts == 0) return 0;
        const Sizes n = sizes(s);
        return of_factor(n, symmetric) + in_fours(n.waiting) + in_fours(n_rows(s)) +
               in_fours(4 * static_cast<int64_t>(s.n_fronts));
    }
    static int64_t values_of_factor(const FrontPlan &s) { return s.n_fronts == 0 ? 0 : of_factor(sizes(s), true); }
    static int64_t values_of_buffer(const FrontPlan &s) {
        const Sizes n = sizes(s);
        return for_one(n) + in_fours(n.stack);
    }
    Fronts(const FrontPlan &plan, bool symmetric, const LongTeam *threads, double *of_thread, Memory<double> &of_factor,
           Memory<double> &memory)
        : s(plan), team(threads), buffer(of_thread) {
        if (s.n_fronts == 0) return;
        offsets = reinterpret_cast<Offsets *>(memory.values(in_fours(4 * static_cast<int64_t>(s.n_fronts))));
        const Sizes n = lay_out(s, [&](int32_t f, const Offsets &p) { offsets[f] = p; });
        lower = of_factor.values(in_fours(n.entries));
        upper = symmetric ? lower : of_factor.values(in_fours(n.entries));
        per_pivot = of_factor.values(in_fours(n.pivots));
        waiting = memory.values(in_fours(n.waiting));
        given = memory.values(in_fours(n_rows(s)));
        before_stack = for_one(n);
    }

    // Calls add(front, its matrix) for leaves, which adds their terms; diagonal(unknown): the whole element.
    template <class Add, class Diagonal>
    bool factorize(double least_left, const Add &add, const Diagonal &diagonal) const {
        bool good = true;
        for_subtrees([&](const FrontPlan::Subtree &b, double *of_thread) {
            for (int32_t f = b.first; f < b.end && __atomic_load_n(&good, __ATOMIC_RELAXED); ++f)
                if (!factorize(f, nullptr, of_thread, least_left, add, diagonal))
                    __atomic_store_n(&good, false, __ATOMIC_RELAXED);
        });
        for (int32_t f = 0; f < s.n_fronts && good; ++f)
            if (s.front[f].subtree < 0) good = factorize(f, team, buffer, least_left, add, diagonal);
        return good;
    }
    // x: right-hand sides, which become the solution.
    __attribute__((noinline)) void solve(double *x) const {
        for_subtrees([&](const FrontPlan::Subtree &b, double *of_thread) {
            for (int32_t f = b.first; f < b.end; ++f) take_up(f, x, of_thread);
        });
        for (int32_t f = 0; f < s.n_fronts; ++f)
            if (s.front[f].subtree < 0) take_up(f, x, buffer);
        for (int32_t f = s.n_fronts; f-- > 0;)
            if (s.front[f].subtree < 0) take_down(f, x, buffer);
        for_subtrees([&](const FrontPlan::Subtree &b, double *of_thread) {
            for (int32_t f = b.end; f-- > b.first;) take_down(f, x, of_thread);
        });
    }

    // The element of two rows of a front; of a symmetric one, whose row is not above its column.
    HOL_STATIC double &element(const FrontPlan::Front &f, const Dense &a, int32_t row, int32_t column) {
        const int32_t i = row_in(f, a, row), j = row_in(f, a, column);
        if (j < a.own && i >= j) return a.lower[static_cast<int64_t>(j) * a.height + i];
        if (i < a.own) return a.upper[static_cast<int64_t>(i) * a.height + j];
        return a.left[static_cast<int64_t>(j - a.own) * (a.height - a.own) + i - a.own];
    }

private:
    struct Sizes {
        int64_t entries, pivots, waiting, tallest, stack;
    };
    // Calls each(front, its index). What waits in a subtree, and in the separator, is a stack.
    template <class Each>
    static Sizes lay_out(const FrontPlan &s, const Each &each) {
        Sizes all = {0, 0, 0, 0, 0};
        const auto square_left = [&](const FrontPlan::Front &f) {
            return static_cast<int64_t>(rest_of(f)) * rest_of(f);
        };
        for (int32_t b = 0; b <= s.n_subtrees; ++b) {
            const bool is_separator = b == s.n_subtrees;
            int64_t top = is_separator ? all.waiting : 0, &most = is_separator ? all.waiting : all.stack;
            for (int32_t f = is_separator ? 0 : s.subtree[b].first; f < (is_separator ? s.n_fronts : s.subtree[b].end);
                 ++f) {
                const FrontPlan::Front &front = s.front[f];
                if (is_separator && front.subtree >= 0) continue;
                const int64_t own = Dense::filled(front.n_own), height = own + rest_of(front),
                              left = square_left(front);
                Offsets p = {all.entries, all.pivots, top, top};
                for (const int32_t half : front.half)
                    if (half >= 0 && s.front[half].subtree == front.subtree) p.left -= square_left(s.front[half]);
                top = p.left + left;
                most = p.made + left > most ? p.made + left : most;
                if (is_last_of_subtree(s, f)) {
                    p.left = all.waiting;
                    all.waiting += left;
                }
                each(f, p);
                all.entries += own * height;
                all.pivots += own;
                all.tallest = height > all.tallest ? height : all.tallest;
            }
        }
        return all;
    }
    static int64_t of_factor(const Sizes &n, bool symmetric) {
        return (symmetric ? 1 : 2) * in_fours(n.entries) + in_fours(n.pivots);
    }
    // What a front is worked on with: the panels of Dense, and its right-hand side.
    static int64_t for_one(const Sizes &n) { return (2 * Dense::panel + 2) * in_fours(n.tallest); }
    __attribute__((noinline)) static Sizes sizes(const FrontPlan &s) {
        return lay_out(s, [](int32_t, const Offsets &) {});
    }
    static bool is_last_of_subtree(const FrontPlan &s, int32_t f) {
        return s.front[f].subtree >= 0 && s.subtree[s.front[f].subtree].end == f + 1;
    }
    static int32_t n_rows(const FrontPlan &s) {
        const FrontPlan::Front &last = s.front[s.n_fronts - 1];
        return last.first_row + last.n_rows;
    }
    // Calls body(subtree, memory of the thread).
    template <class Body>
    HOL_FORCED void for_subtrees(const Body &body) const {
        share_out(s.n_subtrees > 1 ? team : nullptr, buffer, s.n_subtrees,
                  [&](int32_t b, double *of_thread) { body(s.subtree[b], of_thread); });
    }
    double *left_by(int32_t f, double *of_thread) const {
        const bool waits = s.front[f].subtree < 0 || is_last_of_subtree(s, f);
        return (waits ? waiting : of_thread + before_stack) + offsets[f].left;
    }
    Dense dense(int32_t f, double *of_thread) const {
        const FrontPlan::Front &front = s.front[f];
        const int32_t own = Dense::filled(front.n_own);
        const Offsets &p = offsets[f];
        double *const left = (front.subtree < 0 ? waiting : of_thread + before_stack) + p.made;
        return {own,  own + rest_of(front), lower + p.entry, upper + p.entry,
                left, per_pivot + p.pivot,  of_thread,       nullptr};
    }
    HOL_STATIC double *behind_factor(const Dense &a) { return a.factor + 2 * Dense::panel * in_fours(a.height); }

    template <class Add, class Diagonal>
    bool factorize(int32_t f, const LongTeam *threads, double *of_thread, double least_left, const Add &add,
                   const Diagonal &diagonal) const {
        const FrontPlan::Front &front = s.front[f];
        Dense a = dense(f, of_thread);
        a.team = threads;
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
        for (const int32_t half : front.half)
            if (half >= 0) take_half(s.front[half], left_by(half, of_thread), front, a);
        if (!a.eliminate(least_left)) return false;
        double *const left = left_by(f, of_thread);
        for (int64_t i = 0; i < rest * rest && left != a.left; ++i) left[i] = a.left[i];
        return true;
    }
    void take_up(int32_t f, double *x, double *of_thread) const {
        const FrontPlan::Front &front = s.front[f];
        const Dense a = dense(f, of_thread);
        double *const z = behind_factor(a);
        const int32_t *const row = s.row + front.first_row, fill = a.own - front.n_own;
        for (int32_t i = 0; i < front.n_own; ++i) z[i] = x[row[i]];
        for (int32_t i = front.n_own; i < a.height; ++i) z[i] = 0;
        for (const int32_t h : front.half) {
            if (h < 0) continue;
            const FrontPlan::Front &half = s.front[h];
            const int32_t *const to = s.to_parent + half.first_row;
            for (int32_t i = half.n_own; i < half.n_rows; ++i)
                z[to[i] + (to[i] < front.n_own ? 0 : fill)] += given[half.first_row + i];
        }
        a.take_up(z);
        for (int32_t i = 0; i < front.n_own; ++i) x[row[i]] = z[i];
        for (int32_t i = front.n_own; i < front.n_rows; ++i) given[front.first_row + i] = z[i + fill];
    }
    void take_down(int32_t f, double *x, double *of_thread) const {
        const FrontPlan::Front &front = s.front[f];
        const Dense a = dense(f, of_thread);
        double *const z = behind_factor(a);
        const int32_t *const row = s.row + front.first_row, fill = a.own - front.n_own;
        for (int32_t i = 0; i < front.n_own; ++i) z[i] = x[row[i]];
        for (int32_t i = front.n_own; i < a.own; ++i) z[i] = 0;
        for (int32_t i = front.n_own; i < front.n_rows; ++i) z[i + fill] = x[row[i]];
        for (int32_t i = front.n_rows + fill; i < a.height; ++i) z[i] = 0;
        a.take_down(z);
        for (int32_t i = 0; i < front.n_own; ++i) x[row[i]] = z[i];
    }

    HOL_STATIC int32_t rest_of(const FrontPlan::Front &f) { return Dense::filled(f.n_rows - f.n_own); }
    HOL_STATIC int32_t row_in(const FrontPlan::Front &f, const Dense &a, int32_t row) {
        return row < f.n_own ? row : row - f.n_own + a.own;
    }
    HOL_STATIC void clear(double *x, int64_t n) {
        for (int64_t i = 0; i < n; ++i) x[i] = 0;
    }
    // What a half has left is added.
    __attribute__((noinline)) void take_half(const FrontPlan::Front &half, const double *from,
                                             const FrontPlan::Front &whole, const Dense &a) const {
        const int32_t n = half.n_rows - half.n_own, stride = rest_of(half), rest = a.height - a.own;
        int32_t *const at = reinterpret_cast<int32_t *>(behind_factor(a));
        for (int32_t i = 0; i < n; ++i) at[i] = row_in(whole, a, s.to_parent[half.first_row + half.n_own + i]);
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
    }
};

}  // namespace holonomic::HOL_ISA::graph
