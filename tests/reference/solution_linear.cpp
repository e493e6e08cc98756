#include <cstdlib>
#include <vector>

#include "bond_matrix.hpp"
#include "solution.h"

namespace reference
{
namespace
{

bool allocate(solution &s, std::size_t n)
{
    const std::size_t atoms = n + 1;
    s.n_bonds = static_cast<int64_t>(n);
    s.lambda = static_cast<long double *>(std::calloc(3 * n + 4 * atoms, sizeof(long double)));
    if (!s.lambda) return false;
    s.lambda_scale = s.lambda + n;
    s.tension = s.lambda_scale + n;
    s.g = s.tension + n;
    s.g_scale = s.g + 3 * atoms;
    return true;
}

}  // namespace

int fill(const exact_chain &c, const std::vector<quad> &lambda, const std::vector<quad> &scale, solution &out)
{
    const std::size_t n = c.n_bonds();
    if (!allocate(out, n)) return -1;
    quad virial[9] = {}, virial_scale = 0;
    std::vector<quad3> g(n + 1, quad3{});
    std::vector<quad> g_scale(n + 1, quad(0));
    for (std::size_t k = 0; k < n; ++k) {
        const quad3 pull = 2 * lambda[k] * c.d[k];
        const quad size = norm(c.d[k]);
        g[k] = g[k] + pull;
        g[k + 1] = g[k + 1] - pull;
        g_scale[k] += 2 * scale[k] * size;
        g_scale[k + 1] += 2 * scale[k] * size;
        for (std::size_t x = 0; x < 3; ++x)
            for (std::size_t y = 0; y < 3; ++y) virial[3 * x + y] -= pull[x] * c.d[k][y];
        virial_scale += 2 * scale[k] * size * size;
        out.lambda[k] = static_cast<long double>(lambda[k]);
        out.lambda_scale[k] = static_cast<long double>(scale[k]);
        out.tension[k] = static_cast<long double>(2 * lambda[k] * size);
    }
    for (std::size_t i = 0; i <= n; ++i) {
        for (std::size_t x = 0; x < 3; ++x) out.g[3 * i + x] = static_cast<long double>(g[i][x]);
        out.g_scale[i] = static_cast<long double>(g_scale[i]);
    }
    for (std::size_t x = 0; x < 9; ++x) out.virial[x] = static_cast<long double>(virial[x]);
    out.virial_scale = static_cast<long double>(virial_scale);
    return 0;
}

namespace
{

int solve_level(const exact_chain &c, std::vector<quad> &right_side, std::vector<quad> &size, solution &out)
{
    const tridiagonal z = bond_matrix(c);
    if (!solve(z, right_side) || !solve_banded(with_negative_neighbours(z), size)) return -1;
    return fill(c, right_side, size, out);
}

}  // namespace
}  // namespace reference

using namespace reference;

extern "C" int solution_forces(const solution_problem *p, solution *out)
{
    const exact_chain c(*p);
    std::vector<quad> right_side, size;
    for (std::size_t k = 0; k < c.n_bonds(); ++k) {
        const quad3 f0 = row(p->f, k), f1 = row(p->f, k + 1), dv = row(p->v, k + 1) - row(p->v, k);
        quad s = 2 * dot(dv, dv);
        right_side.push_back(2 * dot(c.d[k], c.w[k + 1] * f1 - c.w[k] * f0) + s);
        for (std::size_t x = 0; x < 3; ++x)
            s += 2 * absolute(c.d[k][x]) * (c.w[k + 1] * absolute(f1[x]) + c.w[k] * absolute(f0[x]));
        size.push_back(s);
    }
    return solve_level(c, right_side, size, *out);
}

extern "C" int solution_velocities(const solution_problem *p, solution *out)
{
    const exact_chain c(*p);
    std::vector<quad> right_side, size;
    for (std::size_t k = 0; k < c.n_bonds(); ++k) {
        const quad3 v0 = row(p->v, k), v1 = row(p->v, k + 1);
        quad s = 0;
        right_side.push_back(2 * dot(c.d[k], v1 - v0));
        for (std::size_t x = 0; x < 3; ++x) s += 2 * absolute(c.d[k][x]) * (absolute(v1[x]) + absolute(v0[x]));
        size.push_back(s);
    }
    return solve_level(c, right_side, size, *out);
}

extern "C" void solution_free(solution *s)
{
    std::free(s->lambda);
    *s = solution();
}
