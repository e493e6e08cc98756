// Theory (38)-(41).
#include "core/inverse/tridiagonal.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "core/error.hpp"
#include "core/kernel_choice.hpp"

namespace holonomic {

namespace {

void check_rows(std::int64_t n) {
    if (n < 1 || n > std::numeric_limits<std::int64_t>::max() / 64)
        throw make_error(Status::value, "n is %lld; it must be at least 1", static_cast<long long>(n));
}

// What an Omega^2 adds to ln det. `removed` is 1 - Omega^2, with its own digits.
double log_of(double removed, double omega2) { return removed < 0.5 ? std::log1p(-removed) : std::log(omega2); }

// Memory for a call: small matrices need none of the system's.
class Scratch {
public:
    explicit Scratch(std::size_t size) {
        if (size > sizeof here_ / sizeof *here_) far_.reset(new double[size]);
    }
    double *data() { return far_ ? far_.get() : here_; }

private:
    double here_[384];
    std::unique_ptr<double[]> far_;
};

}  // namespace

void tridiagonal_pivots(std::int64_t n, const double *gamma, double *omega2) {
    check_rows(n);
    Scratch pivots(static_cast<std::size_t>(n));
    if (!kernels().tridiagonal.pivots(n, gamma, pivots.data())) return Tridiagonal(n, gamma).pivots(omega2);
    std::copy(pivots.data(), pivots.data() + n, omega2);
}

double tridiagonal_log_det(std::int64_t n, const double *gamma) {
    check_rows(n);
    Scratch scratch(static_cast<std::size_t>(n));
    double *const pivots = scratch.data();
    if (!kernels().tridiagonal.pivots(n, gamma, pivots)) return Tridiagonal(n, gamma).log_det();
    DoublePair sum = as_pair(0);
    for (std::int64_t k = 1; k < n; ++k)
        sum = sum + as_pair(log_of(gamma[k - 1] * gamma[k - 1] / pivots[k - 1], pivots[k]));
    return rounded(sum);
}

void tridiagonal_solve(std::int64_t n, const double *gamma, const double *b, double *x) {
    check_rows(n);
    Scratch scratch(3 * static_cast<std::size_t>(n));
    if (!kernels().tridiagonal.solve(n, gamma, b, x, scratch.data())) Tridiagonal(n, gamma).solve(b, x);
}

Tridiagonal::Tridiagonal(std::int64_t n, const double *gamma) : n_(static_cast<std::size_t>(n)), gamma_(gamma) {
    check_rows(n);
    for (std::size_t k = 1; k < n_; ++k) {
        if (std::isfinite(gamma_[k - 1])) continue;
        Error error = make_error(Status::not_finite, "gamma between rows %lld and %lld is not finite",
                                 static_cast<long long>(k) - 1, static_cast<long long>(k));
        error.bond = static_cast<std::int64_t>(k) - 1;
        throw error;
    }
    omega2_.resize(n_);
    omega2_[0] = as_pair(1);
    for (std::size_t k = 1; k < n_; ++k) {
        const bool small = std::fabs(gamma_[k - 1]) < 1;  // whatever the row before, which also spares an overflow
        if (small) omega2_[k] = as_pair(1) - this->gamma(k) * this->gamma(k) / omega2_[k - 1];
        if (small && omega2_[k].hi > 0) continue;
        Error error =
            make_error(Status::not_definite, "the matrix is not positive definite: Omega^2 of row %lld is not",
                       static_cast<long long>(k));
        error.bond = static_cast<std::int64_t>(k);
        throw error;
    }
}

void Tridiagonal::pivots(double *omega2) const {
    for (std::size_t k = 0; k < n_; ++k) omega2[k] = rounded(omega2_[k]);
}

double Tridiagonal::log_det() const {
    DoublePair sum = as_pair(0);  // of terms that all have the same sign
    for (std::size_t k = 1; k < n_; ++k) {
        const double removed = rounded(gamma(k) * factor(k));
        sum = sum + as_pair(log_of(removed, rounded(omega2_[k])));
    }
    return rounded(sum);
}

void Tridiagonal::solve(const double *b, double *x) const {
    for (std::size_t k = 0; k < n_; ++k) {
        if (std::isfinite(b[k])) continue;
        Error error = make_error(Status::not_finite, "b of row %lld is not finite", static_cast<long long>(k));
        error.bond = static_cast<std::int64_t>(k);
        throw error;
    }
    std::vector<DoublePair> y(n_);
    y[0] = as_pair(b[0]);
    for (std::size_t k = 1; k < n_; ++k) y[k] = as_pair(b[k]) + factor(k) * y[k - 1];
    DoublePair next = as_pair(0);
    for (std::size_t k = n_; k-- > 0;) {
        y[k] = y[k] / omega2_[k];
        if (k + 1 < n_) y[k] = y[k] + factor(k + 1) * next;
        next = y[k];
    }
    for (std::size_t k = 0; k < n_; ++k) x[k] = rounded(y[k]);
}

// 1 / (Omega_i^2 + Omega'_i^2 - 1), Omega' from the last row on.
std::vector<double> Tridiagonal::inverse_diagonal() const {
    std::vector<double> diagonal(n_);
    DoublePair removed = as_pair(0);  // 1 - Omega'^2
    for (std::size_t k = n_; k-- > 0;) {
        diagonal[k] = rounded(as_pair(1) / (omega2_[k] - removed));
        if (k > 0) removed = gamma(k) * gamma(k) / (as_pair(1) - removed);
    }
    return diagonal;
}

double Tridiagonal::inverse_entry(std::int64_t i, std::int64_t j) const {
    if (i < 0 || j < 0 || static_cast<std::size_t>(i) >= n_ || static_cast<std::size_t>(j) >= n_)
        throw make_error(Status::index, "element (%lld,%lld) is outside a matrix of %lld rows, counted from 0",
                         static_cast<long long>(i), static_cast<long long>(j), static_cast<long long>(n_));
    const std::size_t low = static_cast<std::size_t>(i < j ? i : j), high = static_cast<std::size_t>(i < j ? j : i);
    DoublePair removed = as_pair(0);
    for (std::size_t k = n_ - 1; k > high; --k) removed = gamma(k) * gamma(k) / (as_pair(1) - removed);
    DoublePair value = as_pair(1) / (omega2_[high] - removed);
    for (std::size_t k = high; k > low; --k) value = value * factor(k);
    return rounded(value);
}

void Tridiagonal::inverse_band(std::int64_t width, double *band) const {
    if (width < 0)
        throw make_error(Status::value, "width is %lld; it must be at least 0", static_cast<long long>(width));
    const std::vector<double> diagonal = inverse_diagonal();
    const std::size_t columns = static_cast<std::size_t>(width) + 1;
    std::vector<double> factors(n_);
    for (std::size_t k = 1; k < n_; ++k) factors[k] = rounded(factor(k));
    for (std::size_t j = 0; j < n_; ++j) {
        double value = diagonal[j];
        for (std::size_t k = 0; k < columns && k <= j; ++k) {
            band[(j - k) * columns + k] = value;
            value *= factors[j - k];
        }
    }
    for (std::size_t i = 0; i < n_; ++i)
        for (std::size_t k = n_ - i; k < columns; ++k) band[i * columns + k] = 0;
}

}  // namespace holonomic
