// The core of a molecule is what remains when its hanging trees are stripped. Its matrix is eliminated bond by bond in
// the order of the plan. It is not symmetric with D on the left and B on the right (theory (58)).
#pragma once

#include "core/kernels/extended/digits_lost.hpp"
#include "core/kernels/extended/molecule.hpp"

namespace holonomic::HOL_ISA::extended {

// Rows and columns are positions in the order of elimination.
struct Core {
    const ExtendedPlan *plan;
    bool mixed;
    Wide *diagonal;  // [n_core] of the matrix, then the pivots
    Wide *removed;   // [n_core] what has been subtracted from the diagonal
    Wide *full;      // [n_core] the diagonal as it was before
    Wide *lower;     // elements of the columns below the diagonal; then over the pivot
    Wide *upper;     // elements of the rows beside it, never over the pivot; equal to lower at first if not mixed
    // What each diagonal element, and each element below and beside it, has been made of: the roundings in it are those
    // of a number of this size. A pivot hands what it has lost on to all that it is divided into, so that several
    // losses one after the other multiply.
    double *size_of_diagonal, *size;
};

HOL_NOINLINE Core take_core(const ExtendedPlan &plan, bool mixed, ByteArena &memory) {
    Core x;
    x.plan = &plan;
    x.mixed = mixed;
    x.diagonal = memory.take<Wide>(plan.n_core);
    x.removed = memory.take<Wide>(plan.n_core);
    x.full = memory.take<Wide>(plan.n_core);
    x.lower = memory.take<Wide>(plan.column_start[plan.n_core]);
    x.upper = memory.take<Wide>(plan.column_start[plan.n_core]);
    x.size_of_diagonal = memory.take<double>(plan.n_core);
    x.size = memory.take<double>(plan.column_start[plan.n_core]);
    return x;
}

// Returns where a row's element stands in a column. The column must have one.
HOL_NOINLINE int64_t element(const ExtendedPlan &plan, int32_t row, int32_t column) {
    int64_t first = plan.column_start[column], end = plan.column_start[column + 1];
    while (end - first > 1) {
        const int64_t middle = first + (end - first) / 2;
        (plan.rows[middle] <= row ? first : end) = middle;
    }
    return first;
}

HOL_NOINLINE void clear(const Core &x) {
    for (int32_t c = 0; c < x.plan->n_core; ++c) {
        x.diagonal[c] = x.removed[c] = x.full[c] = wide(0);
        x.size_of_diagonal[c] = 0;
    }
    for (int64_t e = 0; e < x.plan->column_start[x.plan->n_core]; ++e) {
        x.lower[e] = x.upper[e] = wide(0);
        x.size[e] = 0;
    }
}

// Adds to the element of bonds k (row) and l (column) of the matrix, and `size` to what it is made of.
HOL_NOINLINE void add_element(const Core &x, int32_t k, int32_t l, const Wide &value, double size) {
    const int32_t row = x.plan->column_of[k], column = x.plan->column_of[l];
    const int64_t e = row > column ? element(*x.plan, row, column) : element(*x.plan, column, row);
    Wide &sum = (row > column ? x.lower : x.upper)[e];
    sum += value;
    x.size[e] += 0.5 * size;  // comes twice
}

// Eliminates column c from the columns behind it.
HOL_NOINLINE void eliminate_column(const Core &x, int32_t c, bool &good) {
    const int64_t first = x.plan->column_start[c], end = x.plan->column_start[c + 1];
    const Wide r = wide(1) / x.diagonal[c];
    const double size_of_r = x.size_of_diagonal[c] * abs(r.hi);  // times r
    for (int64_t a = first; a < end; ++a) x.lower[a] = x.lower[a] * r;
    for (int64_t a = first; a < end; ++a) {
        const int32_t column = x.plan->rows[a];
        const Wide taken = x.lower[a] * x.upper[a];
        const double factor = abs(x.lower[a].hi), of_factor = x.size[a] * abs(r.hi) + factor * size_of_r;
        const auto size_of_product = [&](int64_t b) { return of_factor * abs(x.upper[b].hi) + factor * x.size[b]; };
        x.diagonal[column] -= taken;
        x.removed[column] += taken;
        x.size_of_diagonal[column] += size_of_product(a);
        int64_t at = x.plan->column_start[column];
        for (int64_t b = a + 1; b < end; ++b, ++at) {
            while (x.plan->rows[at] != x.plan->rows[b]) ++at;
            const Wide up = x.lower[a] * x.upper[b];
            x.upper[at] -= up;
            x.lower[at] -= x.mixed ? x.lower[b] * x.upper[a] : up;
            x.size[at] += size_of_product(b);
        }
    }
    good = good && is_finite(r.hi);
}

HOL_NOINLINE bool factorize(const Core &x, Loss &loss, int32_t &bad) {
    bool good = true;
    for (int32_t c = 0; c < x.plan->n_core; ++c) {
        bad = x.plan->core[c];
        loss.note(abs(x.full[c].hi), x.diagonal[c]);
        loss.note(x.size_of_diagonal[c], x.diagonal[c]);
        if (!(abs(x.diagonal[c].hi) > redundant * abs(x.full[c].hi))) return false;
        eliminate_column(x, c, good);
        if (!good) return false;
    }
    return true;
}

// y is the right-hand side, in the order of elimination; the solution takes its place.
HOL_NOINLINE void solve(const Core &x, Wide *y) {
    const ExtendedPlan &plan = *x.plan;
    for (int32_t c = 0; c < plan.n_core; ++c)
        for (int64_t a = plan.column_start[c]; a < plan.column_start[c + 1]; ++a) y[plan.rows[a]] -= x.lower[a] * y[c];
    for (int32_t c = plan.n_core; c-- > 0;) {
        Wide sum = y[c];
        for (int64_t a = plan.column_start[c]; a < plan.column_start[c + 1]; ++a) sum -= x.upper[a] * y[plan.rows[a]];
        y[c] = sum / x.diagonal[c];
    }
}

}  // namespace holonomic::HOL_ISA::extended
