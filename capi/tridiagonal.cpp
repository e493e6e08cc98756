#include "core/inverse/tridiagonal.hpp"

#include "boundary.hpp"

using holonomic::guarded;
using holonomic::need;
using holonomic::Tridiagonal;

namespace {

void need_gamma(std::int64_t n, const double *gamma) {
    if (n > 1) need(gamma, "gamma");
}

Tridiagonal matrix(std::int64_t n, const double *gamma) {
    need_gamma(n, gamma);
    return Tridiagonal(n, gamma);
}

}  // namespace

int hol_tridiagonal_pivots(int64_t n, const double *gamma, double *omega2) {
    return guarded(__func__, [&] {
        need(omega2, "omega2");
        need_gamma(n, gamma);
        holonomic::tridiagonal_pivots(n, gamma, omega2);
    });
}

int hol_tridiagonal_log_det(int64_t n, const double *gamma, double *log_det) {
    return guarded(__func__, [&] {
        need(log_det, "log_det");
        need_gamma(n, gamma);
        *log_det = holonomic::tridiagonal_log_det(n, gamma);
    });
}

int hol_tridiagonal_solve(int64_t n, const double *gamma, const double *b, double *x) {
    return guarded(__func__, [&] {
        need(b, "b");
        need(x, "x");
        need_gamma(n, gamma);
        holonomic::tridiagonal_solve(n, gamma, b, x);
    });
}

int hol_tridiagonal_inverse_entry(int64_t n, const double *gamma, int64_t i, int64_t j, double *value) {
    return guarded(__func__, [&] {
        need(value, "value");
        *value = matrix(n, gamma).inverse_entry(i, j);
    });
}

int hol_tridiagonal_inverse_band(int64_t n, const double *gamma, int64_t width, double *band) {
    return guarded(__func__, [&] {
        need(band, "band");
        matrix(n, gamma).inverse_band(width, band);
    });
}
