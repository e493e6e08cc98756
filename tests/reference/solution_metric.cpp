#include <cmath>
#include <cstdlib>
#include <vector>

#include "bond_matrix.hpp"
#include "solution.h"

namespace reference
{
namespace
{

/** ln det by elimination; the product is kept near one by powers of two, so that its logarithm keeps its digits. */
long double log_det(const tridiagonal &m)
{
    quad product = 1, pivot = 0;
    long exponent = 0;
    for (std::size_t k = 0; k < m.size(); ++k) {
        pivot = k == 0 ? m.diagonal[0] : m.diagonal[k] - m.lower[k] * m.upper[k - 1] / pivot;
        product *= pivot;
        for (; product < 0.5; product *= 2) --exponent;
    }
    const long double rest = static_cast<long double>(product - 1);
    return std::log1p(rest) + static_cast<long double>(exponent) * std::log(2.0L);
}

std::vector<quad> inverse_column(const tridiagonal &m, std::size_t column)
{
    std::vector<quad> x(m.size(), quad(0));
    x[column] = 1;
    if (!solve_banded(m, x)) x.clear();
    return x;
}

int metric(const solution_problem &p, solution_metric &out)
{
    const exact_chain c(p);
    const std::size_t n = c.n_bonds();
    const tridiagonal z = scaled_bond_matrix(c);
    out.log_det = log_det(z);
    std::vector<quad> size(n), h(n + 1, quad(0));
    std::vector<quad3> u(n), normal(n + 1, quad3{}), phi(n + 2, quad3{});
    for (std::size_t k = 0; k < n; ++k) {
        size[k] = norm(c.d[k]);
        u[k] = (1 / size[k]) * c.d[k];
    }
    quad row_sum = 0, inverse_row_sum = 0;
    for (std::size_t k = 0; k < n; ++k) {
        const std::vector<quad> column = inverse_column(z, k);
        if (column.empty()) return -1;
        out.inverse_diagonal[k] = static_cast<long double>(column[k]);
        quad sum = 0, entries = 1;
        for (quad x : column) sum += absolute(x);
        if (sum > inverse_row_sum) inverse_row_sum = sum;
        if (k > 0) entries += absolute(z.lower[k]);
        if (k + 1 < n) entries += absolute(z.upper[k]);
        if (entries > row_sum) row_sum = entries;
        if (k > 0) {  // Z~^-1 = sqrt(M_ii M_jj) M^-1, M_ii = w + w'
            const quad masses = square_root((c.w[k - 1] + c.w[k]) * (c.w[k] + c.w[k + 1]));
            h[k] = c.w[k] * column[k - 1] / masses;
            normal[k] = cross(u[k - 1], u[k]);
        }
    }
    out.condition = static_cast<long double>(row_sum * inverse_row_sum);
    std::vector<quad> scale(n + 2, quad(0));
    for (std::size_t k = 0; k < n; ++k) {
        phi[k + 1] = (1 / size[k]) * cross(u[k], h[k] * normal[k] - h[k + 1] * normal[k + 1]);
        scale[k + 1] = (absolute(h[k]) * norm(normal[k]) + absolute(h[k + 1]) * norm(normal[k + 1])) / size[k];
    }
    for (std::size_t i = 0; i <= n; ++i) {
        const quad3 force = phi[i] - phi[i + 1];
        for (std::size_t x = 0; x < 3; ++x) out.fixman_force[3 * i + x] = static_cast<long double>(force[x]);
        out.fixman_scale[i] = static_cast<long double>(scale[i] + scale[i + 1]);
    }
    return 0;
}

}  // namespace
}  // namespace reference

extern "C" int solution_metric_make(const solution_problem *p, solution_metric *out)
{
    const std::size_t n = static_cast<std::size_t>(p->n_bonds), atoms = n + 1;
    *out = solution_metric();
    out->fixman_force = static_cast<long double *>(std::calloc(4 * atoms + n, sizeof(long double)));
    if (!out->fixman_force) return -1;
    out->fixman_scale = out->fixman_force + 3 * atoms;
    out->inverse_diagonal = out->fixman_scale + atoms;
    if (reference::metric(*p, *out) == 0) return 0;
    solution_metric_free(out);
    return -1;
}

extern "C" void solution_metric_free(solution_metric *m)
{
    std::free(m->fixman_force);
    *m = solution_metric();
}

extern "C" int solution_inverse_column(const solution_problem *p, int64_t column, long double *values)
{
    const reference::exact_chain c(*p);
    const auto x = reference::inverse_column(reference::scaled_bond_matrix(c), static_cast<std::size_t>(column));
    for (std::size_t k = 0; k < x.size(); ++k) values[k] = static_cast<long double>(x[k]);
    return x.empty() ? -1 : 0;
}

extern "C" long double solution_epsilon(void)
{
    reference::quad eps = 1;
    while (reference::quad(1) + eps / 2 != reference::quad(1)) eps /= 2;
    return static_cast<long double>(eps);
}
