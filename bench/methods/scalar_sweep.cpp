// Multipliers and constraint forces of one chain after the other by an L D L^T elimination, written out for chains and
// inlined: one loop forward over the bonds, one back. The pivots are Z_kk Omega_k^2 / 4, so this is the recursion for
// Omega without the scaling to ones on the diagonal, and with its subtraction. It is the yardstick for what lanes give.
#include <memory>

#include "methods.hpp"

namespace bench {
namespace {

struct Workspace {
    std::vector<double> d, l, u;  ///< bonds [n][3]; below the diagonal; right sides over pivots
    explicit Workspace(std::size_t n) : d(3 * n), l(n + 1), u(n) {}
};

void sweep(const Problem &p, const double *__restrict__ r, const double *__restrict__ v, const double *__restrict__ f,
           Workspace &s, double *__restrict__ lambda, double *__restrict__ g) {
    const std::size_t n = p.n();
    const double *__restrict__ w = p.w.data();
    double *__restrict__ d = s.d.data(), *__restrict__ l = s.l.data(), *__restrict__ u = s.u.data();
    double beside = 0, inverse = 0, y = 0, last[3] = {0, 0, 0};
    for (std::size_t k = 0; k < n; ++k) {
        double q = 0, along = 0, b = 0;
        for (std::size_t x = 0; x < 3; ++x) {
            const std::size_t i = 3 * k + x;
            const double bond = r[i + 3] - r[i], dv = v[i + 3] - v[i];
            q += bond * bond;
            along += last[x] * bond;
            b += dv * dv + bond * (w[k + 1] * f[i + 3] - w[k] * f[i]);
            d[i] = last[x] = bond;
        }
        beside = -w[k] * along;
        l[k] = beside * inverse;
        y = b - l[k] * y;
        inverse = 1 / ((w[k] + w[k + 1]) * q - l[k] * beside);
        u[k] = y * inverse;
    }
    double t = 0, after[3] = {0, 0, 0};
    l[n] = 0;
    for (std::size_t k = n; k-- > 0;) {
        t = u[k] - l[k + 1] * t;
        lambda[k] = t / 2;
        for (std::size_t x = 0; x < 3; ++x) {
            const double pull = t * d[3 * k + x];
            g[3 * k + 3 + x] = after[x] - pull;
            after[x] = pull;
        }
    }
    for (std::size_t x = 0; x < 3; ++x) g[x] = after[x];
}

}  // namespace

Method scalar_sweep(const Problem &p) {
    auto s = std::make_shared<Workspace>(p.n());
    return {"omega-recursion", "unscaled scalar sweep", [&p, s](State &state) {
                for (std::size_t c = 0; c < p.n_chains(); ++c) {
                    const std::size_t atom = 3 * p.first_atom(c);
                    sweep(p, &p.r[atom], &p.v[atom], &p.f[atom], *s, &state.lambda[c * p.n()], &state.g[atom]);
                }
            }};
}

}  // namespace bench
