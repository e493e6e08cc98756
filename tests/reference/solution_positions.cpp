#include <vector>

#include "bond_matrix.hpp"
#include "solution.h"

namespace reference
{
namespace
{

/** One Newton problem: bonds D_k(t) = D0_k + dt^2 (w_k G_k - w_{k-1} G_{k-1}), G from 2 lambda along the old bonds. */
struct newton {
    exact_chain c;  // the old bonds
    std::vector<quad3> drifted;
    std::vector<quad> length;
    quad dt2;

    std::vector<quad3> bonds(const std::vector<quad> &lambda) const
    {
        const std::size_t n = c.n_bonds();
        std::vector<quad3> d;
        for (std::size_t k = 0; k < n; ++k) {
            quad3 change = quad(-2) * (c.w[k] + c.w[k + 1]) * lambda[k] * c.d[k];
            if (k > 0) change = change + 2 * c.w[k] * lambda[k - 1] * c.d[k - 1];
            if (k + 1 < n) change = change + 2 * c.w[k + 1] * lambda[k + 1] * c.d[k + 1];
            d.push_back(drifted[k] + dt2 * change);
        }
        return d;
    }

    /** d sigma_k / d lambda_l. */
    tridiagonal jacobian(const std::vector<quad3> &d) const
    {
        const std::size_t n = c.n_bonds();
        tridiagonal j(n);
        for (std::size_t k = 0; k < n; ++k) {
            j.diagonal[k] = -4 * dt2 * (c.w[k] + c.w[k + 1]) * dot(d[k], c.d[k]);
            if (k > 0) j.lower[k] = 4 * dt2 * c.w[k] * dot(d[k], c.d[k - 1]);
            if (k + 1 < n) j.upper[k] = 4 * dt2 * c.w[k + 1] * dot(d[k], c.d[k + 1]);
        }
        return j;
    }
};

/** Iterations until the worst relative error of a bond is at the rounding of the arithmetic; -1 if it does not get
 * there. */
int iterate(const newton &problem, std::vector<quad> &lambda)
{
    const std::size_t n = problem.c.n_bonds();
    const int limit = 100;
    const long double done = sizeof(quad) > 8 && solution_epsilon() < 1e-30L ? 1e-28L : 1e-17L;
    for (int step = 0; step <= limit; ++step) {
        const std::vector<quad3> d = problem.bonds(lambda);
        std::vector<quad> error(n);
        long double worst = 0;
        for (std::size_t k = 0; k < n; ++k) {
            const quad square = problem.length[k] * problem.length[k];
            error[k] = square - dot(d[k], d[k]);
            const long double relative = static_cast<long double>(absolute(error[k]) / square);
            if (!(relative <= worst)) worst = relative;
        }
        if (worst <= done) return step;
        if (!(worst < 1e30L) || !solve(problem.jacobian(d), error)) return -1;
        for (std::size_t k = 0; k < n; ++k) lambda[k] += error[k];
    }
    return -1;
}

}  // namespace
}  // namespace reference

using namespace reference;

extern "C" int solution_positions(const solution_problem *p, const double *drifted, const double *length, double dt,
                                  long double *positions, solution *out)
{
    solution_problem moved = *p;
    moved.r = drifted;
    newton problem{exact_chain(*p), exact_chain(moved).d, {}, quad(dt) * quad(dt)};
    const std::size_t n = problem.c.n_bonds();
    for (std::size_t k = 0; k < n; ++k) problem.length.push_back(length[k]);
    std::vector<quad> lambda(n, quad(0)), no_scale(n, quad(0));
    const int steps = iterate(problem, lambda);
    if (steps < 0 || fill(problem.c, lambda, no_scale, *out)) return -1;
    for (std::size_t i = 0; i <= n; ++i)
        for (std::size_t x = 0; x < 3; ++x) {
            quad g = 0;
            if (i < n) g += 2 * lambda[i] * problem.c.d[i][x];
            if (i > 0) g -= 2 * lambda[i - 1] * problem.c.d[i - 1][x];
            positions[3 * i + x] =
                static_cast<long double>(quad(drifted[3 * i + x]) + problem.dt2 * problem.c.w[i] * g);
        }
    return steps;
}
