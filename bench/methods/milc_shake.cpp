// MILC SHAKE (Bailey, Lowe and Sutton 2008, J. Comput. Phys. 227, 8949): the positions' non-linear equations are solved
// by repeated tridiagonal solves with the matrix of the first iterate, 2 dt^2 D_k.(w_k b_k ..), D being the bonds after
// the drift and b those before it.
#include <algorithm>
#include <cmath>
#include <memory>

#include "methods.hpp"
#ifdef BENCH_HAVE_LAPACK
#include "lapack_routines.hpp"
#endif

namespace bench {

#ifdef BENCH_HAVE_LAPACK

namespace {

const int iterations_at_most = 100;

struct Workspace {
    std::vector<double> b, lower, diagonal, upper, l, d, u, x;
    explicit Workspace(std::size_t n) : b(3 * n), lower(n), diagonal(n), upper(n), l(n), d(n), u(n), x(n) {}
};

double dot(const double *a, const double *b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/// The derivative of D_k.D_k with respect to the multipliers t, r_i += w_i (t_i b_i ..): rows from the drifted bonds.
void frozen_matrix(const Problem &p, const double *r, Workspace &s) {
    const std::size_t n = p.n();
    for (std::size_t k = 0; k < n; ++k) {
        const double *at = r + 3 * k;
        const double bond[3] = {at[3] - at[0], at[4] - at[1], at[5] - at[2]};
        s.diagonal[k] = 2 * (p.w[k] + p.w[k + 1]) * dot(bond, &s.b[3 * k]);
        if (k > 0) s.lower[k - 1] = -2 * p.w[k] * dot(bond, &s.b[3 * k - 3]);
        if (k + 1 < n) s.upper[k] = -2 * p.w[k + 1] * dot(bond, &s.b[3 * k + 3]);
    }
}

/// Fills x with what each bond is too long, relative to its square; returns the worst.
double excess(const Problem &p, const double *r, Workspace &s) {
    double worst = 0;
    for (std::size_t k = 0; k < p.n(); ++k) {
        const double *at = r + 3 * k;
        const double bond[3] = {at[3] - at[0], at[4] - at[1], at[5] - at[2]}, square = p.length[k] * p.length[k];
        s.x[k] = dot(bond, bond) - square;
        worst = std::max(worst, std::abs(s.x[k]) / square);
    }
    return worst;
}

std::int64_t project(const Problem &p, const double *reference, double tolerance, Workspace &s, double *r) {
    const int n = static_cast<int>(p.n()), one = 1;
    for (std::size_t i = 0; i < 3 * p.n(); ++i) s.b[i] = reference[i + 3] - reference[i];
    double worst = excess(p, r, s);
    if (worst <= tolerance) return 0;
    frozen_matrix(p, r, s);
    for (int iteration = 1; iteration <= iterations_at_most; ++iteration) {
        int info = 0;
        s.l = s.lower, s.d = s.diagonal, s.u = s.upper;  // dgtsv overwrites its matrix
        dgtsv_(&n, &one, s.l.data(), s.d.data(), s.u.data(), s.x.data(), &n, &info);
        if (info != 0) return iteration;
        for (std::size_t k = 0; k < p.n(); ++k)
            for (std::size_t x = 0; x < 3; ++x) {
                r[3 * k + x] += p.w[k] * s.x[k] * s.b[3 * k + x];
                r[3 * k + 3 + x] -= p.w[k + 1] * s.x[k] * s.b[3 * k + x];
            }
        const double before = worst;
        worst = excess(p, r, s);
        // Below the rounding of the coordinates it no longer falls; going on would only cost time.
        if (worst <= tolerance || (worst < 1e-9 && worst > 0.5 * before)) return iteration;
    }
    return iterations_at_most;
}

}  // namespace

Method milc_shake(const Problem &p, double tolerance) {
    auto s = std::make_shared<Workspace>(p.n());
    return {"milc-shake", tolerance_setting(tolerance), [&p, tolerance, s](State &state) {
                state.iterations = 0;
                for (std::size_t c = 0; c < p.n_chains(); ++c) {
                    const std::size_t atom = 3 * p.first_atom(c);
                    state.iterations =
                        std::max(state.iterations, project(p, &p.r[atom], tolerance, *s, &state.r[atom]));
                }
            }};
}

#else

Method milc_shake(const Problem &, double tolerance) {
    return {"milc-shake", tolerance_setting(tolerance), [](State &) {}};
}

#endif

}  // namespace bench
