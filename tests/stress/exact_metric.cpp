#include "exact_metric.hpp"

#include <cmath>

#include "bond_matrix.hpp"
#include "linear_solve.hpp"

namespace stress
{

using namespace reference;

namespace
{

/** Pivots of the elimination from the first row on, or from the last. Empty if one is not positive. */
std::vector<quad> pivots(const tridiagonal &z, bool from_last)
{
    const std::size_t n = z.size();
    std::vector<quad> p(n);
    for (std::size_t step = 0; step < n; ++step) {
        const std::size_t k = from_last ? n - 1 - step : step;
        p[k] = z.diagonal[k];
        if (step > 0) {
            const std::size_t before = from_last ? k + 1 : k - 1;
            const quad beside = from_last ? z.upper[k] : z.lower[k];
            p[k] -= beside * beside / p[before];
        }
        if (!(p[k] > 0)) return {};
    }
    return p;
}

/** ln of the product; it is kept near one by powers of two, so that its logarithm keeps its digits. */
long double log_product(const std::vector<quad> &factors)
{
    quad product = 1;
    long exponent = 0;
    for (const quad &x : factors) {
        product *= x;
        for (; product < 0.5; product *= 2) --exponent;
    }
    return std::log1p(static_cast<long double>(product - 1)) + static_cast<long double>(exponent) * std::log(2.0L);
}

long double largest_row_sum(const std::vector<quad> &rows)
{
    quad largest = 0;
    for (const quad &x : rows)
        if (x > largest) largest = x;
    return static_cast<long double>(largest);
}

}  // namespace

long double exact_metric::entry(std::int64_t i, std::int64_t j) const
{
    long double value = diagonal[static_cast<std::size_t>(j)];
    for (std::int64_t k = j; k > i; --k) value *= step[static_cast<std::size_t>(k)];
    return value;
}

exact_metric metric_of(const solution_problem &problem)
{
    exact_metric out;
    const exact_chain c(problem);
    const std::size_t n = c.n_bonds();
    for (std::size_t k = 0; k < n; ++k)
        if (!(c.w[k] + c.w[k + 1] > 0) || !(dot(c.d[k], c.d[k]) > 0)) return out;
    const tridiagonal z = scaled_bond_matrix(c);
    const std::vector<quad> forward = pivots(z, false), backward = pivots(z, true);
    if (forward.empty() || backward.empty()) return out;
    out.log_det = log_product(forward);

    std::vector<quad> h(n + 1, quad(0)), size(n);
    std::vector<quad3> u(n), normal(n + 1, quad3{}), phi(n + 2, quad3{});
    std::vector<quad> row_sum(n, quad(1)), inverse_row_sum(n, quad(1)), scale(n + 2, quad(0));
    for (std::size_t k = 0; k < n; ++k) {
        size[k] = norm(c.d[k]);
        u[k] = (1 / size[k]) * c.d[k];
        const quad diagonal = 1 / (forward[k] + backward[k] - 1);
        if (!(diagonal > 0)) return out;
        const quad step = k > 0 ? -z.lower[k] / forward[k - 1] : quad(0);
        out.diagonal.push_back(static_cast<long double>(diagonal));
        out.step.push_back(static_cast<long double>(step));
        if (k > 0) {  // Z~^-1 = sqrt(M_ii M_jj) M^-1, M_ii = w + w'
            h[k] = c.w[k] * step * diagonal / square_root((c.w[k - 1] + c.w[k]) * (c.w[k] + c.w[k + 1]));
            normal[k] = cross(u[k - 1], u[k]);
            row_sum[k] += absolute(z.lower[k]);
            row_sum[k - 1] += absolute(z.lower[k]);
        }
    }
    if (!solve_banded(with_negative_neighbours(z), inverse_row_sum)) return out;
    out.condition = largest_row_sum(row_sum) * largest_row_sum(inverse_row_sum);
    if (!(out.condition < 1e60L)) return out;  // singular but for the rounding of this arithmetic
    for (std::size_t k = 0; k < n; ++k) {
        phi[k + 1] = (1 / size[k]) * cross(u[k], h[k] * normal[k] - h[k + 1] * normal[k + 1]);
        scale[k + 1] = (absolute(h[k]) * norm(normal[k]) + absolute(h[k + 1]) * norm(normal[k + 1])) / size[k];
    }
    for (std::size_t i = 0; i <= n; ++i) {
        const quad3 force = phi[i] - phi[i + 1];
        for (std::size_t x = 0; x < 3; ++x) out.force.push_back(static_cast<long double>(force[x]));
        out.force_scale.push_back(static_cast<long double>(scale[i] + scale[i + 1]));
    }
    out.regular = true;
    return out;
}

}  // namespace stress
