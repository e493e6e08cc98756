// The equations of one molecule: Newton's method and the linear ones, corrected by residuals in twice the precision.
#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

#include "core/index.hpp"
#include "core/long_step/long_steps.hpp"
#include "core/rigid/system.hpp"

namespace holonomic::rigid {

namespace {

using plain::bodies::least_plain;
using plain::bodies::least_wide;
using plain::bodies::small_correction;
using plain::bodies::small_residual;

double dot3(const double *a, const double *b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

void round_to(double *to, const PairVector *from, std::int64_t n) {
    for (std::int64_t e = 0; e < n; ++e) {
        to[3 * e] = from[e].x.hi;
        to[3 * e + 1] = from[e].y.hi;
        to[3 * e + 2] = from[e].z.hi;
    }
}

void add_to(double &sum, double x) { sum += x; }
void add_to(DoublePair &sum, const DoublePair &x) { sum = sum + x; }
void put(double &to, const DoublePair &x) { to = rounded(x); }
void put(DoublePair &to, const DoublePair &x) { to = x; }
DoublePair wide_of(double x) { return as_pair(x); }
DoublePair wide_of(const DoublePair &x) { return x; }

// The first row of a symmetric matrix of which not more than `least` of its diagonal element is left where it comes
// last; -1: none. No order leaves less; a pivot alone tells nothing of what those before it have lost. One over what is
// left is the diagonal of the inverse Z, which is found from its end, within the pattern of the factors, as
// Z = D^-1 L^-1 + (1 - L^T) Z. diagonal [n_rows] and below [as l] are overwritten by it.
std::int32_t dependent_row(const MoleculeKind &s, const Factor<DoublePair> &f, double least, DoublePair *diagonal,
                           DoublePair *below) {
    const std::int32_t *const start = s.column_start.data(), *const row = s.row.data();
    for (std::int32_t k = s.n_rows - 1; k >= 0; --k) {
        const std::int32_t begin = start[k], end = start[k + 1];
        std::fill(below + begin, below + end, DoublePair{});
        diagonal[k] = as_pair(1) / f.diagonal[k];
        for (std::int32_t a = begin; a < end; ++a) {
            below[a] = below[a] - f.l[a] * diagonal[row[a]];
            std::int32_t entry = start[row[a]];
            for (std::int32_t b = a + 1; b < end; ++b) {
                while (row[entry] < row[b]) ++entry;
                below[a] = below[a] - f.l[b] * below[entry];
                below[b] = below[b] - f.l[a] * below[entry];
            }
            diagonal[k] = diagonal[k] - f.l[a] * below[a];
        }
        if (!(diagonal[k].hi * f.before[k] * least < 1)) return k;
    }
    return -1;
}

}  // namespace

// Entry (k, l) is the sum of w gradient_k . gradient_l, of the first conformation and of the second.
template <class T>
std::int32_t System::assemble(const Factor<T> &f, const Conformation &rows, const Conformation &columns) const {
    constexpr bool plain = std::is_same_v<T, double>;
    const bool same = rows.gradient == columns.gradient;
    if constexpr (plain) {
        const std::int64_t n_entries = static_cast<std::int64_t>(s_.entries.size());
        round_to(gradient_[0], rows.gradient, n_entries);
        if (!same) round_to(gradient_[1], columns.gradient, n_entries);
    }
    const auto product = [&](std::int32_t p, std::int32_t q) {
        if constexpr (plain)
            return dot3(gradient_[0] + 3 * p, gradient_[same ? 0 : 1] + 3 * q);
        else
            return dot(rows.gradient[p], columns.gradient[q]);
    };
    std::fill(f.diagonal, f.diagonal + s_.n_rows, T{});
    std::fill(f.l, f.l + s_.row.size(), T{});
    std::fill(f.u, f.u + s_.row.size(), T{});
    for (const Product &p : s_.products) {
        const double w = s_.w[at(s_.entries[at(p.a)].node)];
        const T upper = w * product(p.a, p.b);
        if (p.of_diagonal) {
            add_to(f.diagonal[p.element], upper);
            continue;
        }
        add_to(f.u[p.element], upper);
        add_to(f.l[p.element], same ? upper : w * product(p.b, p.a));
    }
    const std::int32_t bad = f.eliminate(s_, plain ? least_plain : least_wide);
    if constexpr (!plain)
        if (bad < 0 && same) return dependent_row(s_, f, least_wide, residual_, inverse_);
    return bad;
}

template std::int32_t System::assemble(const Factor<double> &, const Conformation &, const Conformation &) const;
template std::int32_t System::assemble(const Factor<DoublePair> &, const Conformation &, const Conformation &) const;

// Sizes of corrections are compared in the units of each row: |x| sqrt of its diagonal.
template <class T>
Outcome System::project_with(const Factor<T> &f, T *x, const Conformation &where, const DoublePair *constant,
                             PairVector *z, DoublePair *multipliers) const {
    if (assemble(f, where, where) >= 0) return Outcome::degenerate;
    for (std::int32_t k = 0; k < s_.n_rows; ++k) multipliers[k] = as_pair(0);
    double before = std::numeric_limits<double>::infinity();
    for (int pass = 0; pass < 12; ++pass) {
        for (std::int32_t k = 0; k < s_.n_rows; ++k) {
            DoublePair sum = constant ? constant[k] : as_pair(0);
            for (std::int32_t e = s_.entry_start[at(k)]; e < s_.entry_start[at(k + 1)]; ++e)
                sum = sum + dot(where.gradient[e], z[s_.entries[at(e)].node]);
            put(x[k], sum);
        }
        f.solve(s_, x);
        double correction = 0, whole = 0;
        for (std::int32_t k = 0; k < s_.n_rows; ++k) {
            const double unit = std::sqrt(f.before[k]);
            multipliers[k] = multipliers[k] + wide_of(x[k]);
            correction = std::max(correction, std::fabs(first_word(x[k])) * unit);
            whole = std::max(whole, std::fabs(multipliers[k].hi) * unit);
            move_along(where, k, wide_of(x[k]), z);
        }
        if (!std::isfinite(correction) || !std::isfinite(whole)) return Outcome::not_finite;
        if (correction <= small_correction * whole) return Outcome::good;
        if (pass > 1 && correction > 0.1 * before) break;
        before = correction;
    }
    // At the end of twice the precision nothing more is to be gained.
    return std::is_same_v<T, double> ? Outcome::no_convergence : Outcome::good;
}

Outcome System::project(const Conformation &where, const DoublePair *constant, PairVector *z,
                        DoublePair *multipliers) const {
    if (s_.n_rows == 0) return Outcome::good;
    std::copy(z, z + s_.n_nodes, start_);
    const Outcome first = project_with(plain_, x_, where, constant, z, multipliers);
    if (first == Outcome::good) return first;
    std::copy(start_, start_ + s_.n_nodes, z);
    return project_with(wide_, wide_x_, where, constant, z, multipliers);
}

template <class T>
Outcome System::restore_with(const Factor<T> &f, T *x, const Conformation &from, const Conformation &to,
                             double tolerance, int most_iterations, DoublePair *multipliers, int *iterations,
                             double *error) const {
    double before = std::numeric_limits<double>::infinity();
    for (*iterations = 0;; ++*iterations) {
        *error = residuals(to, residual_);
        if (!std::isfinite(*error)) return Outcome::not_finite;
        if (*error <= tolerance) return Outcome::good;
        if (*error<small_residual && * error> 0.1 * before) return Outcome::good;
        if (*iterations >= most_iterations) return Outcome::no_convergence;
        before = *error;
        differentiate(to);
        if (assemble(f, to, from) >= 0) return Outcome::degenerate;
        for (std::int32_t k = 0; k < s_.n_rows; ++k) put(x[k], residual_[k]);
        f.solve(s_, x);
        for (std::int32_t k = 0; k < s_.n_rows; ++k) {
            multipliers[k] = multipliers[k] + wide_of(x[k]);
            move_along(from, k, wide_of(x[k]), to.q);
        }
    }
}

// From the positions as they came by Newton's method, then by following the solution from the reference. A singular
// matrix on the way says nothing of the molecule; at the reference it does.
Outcome System::restore(const Conformation &from, const Conformation &to, double tolerance, int most_iterations,
                        DoublePair *multipliers, int *iterations, double *error) const {
    std::copy(to.q, to.q + s_.n_nodes, start_);
    const auto begin_again = [&] {
        std::copy(start_, start_ + s_.n_nodes, to.q);
        std::fill(multipliers, multipliers + s_.n_rows, as_pair(0));
    };
    const auto newton = [&](bool in_doubles) {
        if (in_doubles)
            return restore_with(plain_, x_, from, to, tolerance, most_iterations, multipliers, iterations, error);
        return restore_with(wide_, wide_x_, from, to, tolerance, most_iterations, multipliers, iterations, error);
    };
    for (const bool in_doubles : {true, false}) {
        begin_again();
        const Outcome outcome = newton(in_doubles);
        if (outcome == Outcome::good || (outcome == Outcome::not_finite && *iterations == 0)) return outcome;
    }
    for (const bool in_doubles : {true, false}) {
        const int steps = most_iterations < enough_iterations ? 0 : follow(from, to, multipliers);
        if (steps == 0) break;
        const Outcome outcome = newton(in_doubles);
        *iterations += steps;
        if (outcome == Outcome::good) return outcome;
    }
    return assemble(wide_, from, from) < 0 ? Outcome::no_convergence : Outcome::degenerate;
}

}  // namespace holonomic::rigid
