// LINCS (Hess, Bekker, Berendsen and Fraaije 1997, J. Comput. Chem. 18, 1463): a projection along the old bond
// directions with the inverse of the coupling matrix expanded in powers up to `order`, then `iterations` corrections
// for the lengthening by rotation, as in Hess 2008 (P-LINCS). Bond lengths, not their squares, are what it works on.
#include <algorithm>
#include <cmath>
#include <memory>

#include "methods.hpp"

namespace bench {
namespace {

struct Workspace {
    std::vector<double> b;         ///< old bond directions [n][3]
    std::vector<double> s;         ///< 1 / sqrt(w + w')
    std::vector<double> coupling;  ///< [n]: between bonds k and k+1
    std::vector<double> right, next, sum;
    explicit Workspace(const Problem &p) : b(3 * p.n()), coupling(p.n()), right(p.n()), next(p.n()), sum(p.n()) {
        for (std::size_t k = 0; k < p.n(); ++k) s.push_back(1 / std::sqrt(p.w[k] + p.w[k + 1]));
    }
};

/// sum = (1 + A + A^2 + .. + A^order) right
void expand(Workspace &a, int order) {
    const std::size_t n = a.right.size();
    a.sum = a.right;
    for (int power = 0; power < order; ++power) {
        for (std::size_t k = 0; k < n; ++k) {
            double x = 0;
            if (k > 0) x += a.coupling[k - 1] * a.right[k - 1];
            if (k + 1 < n) x += a.coupling[k] * a.right[k + 1];
            a.next[k] = x;
            a.sum[k] += x;
        }
        a.right.swap(a.next);
    }
}

void move(const Problem &p, const Workspace &a, double *r) {
    for (std::size_t k = 0; k < p.n(); ++k) {
        const double t = a.s[k] * a.sum[k];
        for (std::size_t x = 0; x < 3; ++x) {
            r[3 * k + x] += p.w[k] * t * a.b[3 * k + x];
            r[3 * k + 3 + x] -= p.w[k + 1] * t * a.b[3 * k + x];
        }
    }
}

void project(const Problem &p, const double *reference, int order, int iterations, Workspace &a, double *r) {
    const std::size_t n = p.n();
    for (std::size_t k = 0; k < n; ++k) {
        const double *from = reference + 3 * k;
        double *b = &a.b[3 * k];
        for (int x = 0; x < 3; ++x) b[x] = from[x + 3] - from[x];
        const double inverse = 1 / std::sqrt(b[0] * b[0] + b[1] * b[1] + b[2] * b[2]);
        for (int x = 0; x < 3; ++x) b[x] *= inverse;
    }
    for (std::size_t k = 0; k < n; ++k) {
        const double *b = &a.b[3 * k], *at = r + 3 * k;
        if (k + 1 < n) a.coupling[k] = p.w[k + 1] * a.s[k] * a.s[k + 1] * (b[0] * b[3] + b[1] * b[4] + b[2] * b[5]);
        const double along = b[0] * (at[3] - at[0]) + b[1] * (at[4] - at[1]) + b[2] * (at[5] - at[2]);
        a.right[k] = a.s[k] * (along - p.length[k]);
    }
    expand(a, order);
    move(p, a, r);
    for (int i = 0; i < iterations; ++i) {
        for (std::size_t k = 0; k < n; ++k) {
            const double *at = r + 3 * k;
            const double d[3] = {at[3] - at[0], at[4] - at[1], at[5] - at[2]};
            // The projection of the bond on its old direction must be this long for the bond to have its length.
            const double square = 2 * p.length[k] * p.length[k] - (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
            a.right[k] = a.s[k] * (p.length[k] - std::sqrt(std::max(square, 0.0)));
        }
        expand(a, order);
        move(p, a, r);
    }
}

}  // namespace

Method lincs(const Problem &p, int order, int iterations) {
    auto a = std::make_shared<Workspace>(p);
    const std::string setting = "order " + std::to_string(order) + " iterations " + std::to_string(iterations);
    return {"lincs", setting, [&p, order, iterations, a](State &state) {
                state.iterations = iterations;
                for (std::size_t c = 0; c < p.n_chains(); ++c) {
                    const std::size_t atom = 3 * p.first_atom(c);
                    project(p, &p.r[atom], order, iterations, *a, &state.r[atom]);
                }
            }};
}

}  // namespace bench
