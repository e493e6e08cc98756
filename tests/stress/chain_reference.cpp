#include "chain_reference.hpp"

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <cstdint>
#include <cstdio>

#include "bond_matrix.hpp"

namespace stress
{

using namespace reference;

namespace
{

constexpr long double smallest = 4.9406564584124654e-324L;
constexpr long double eps_of_joint = 4;  // that a multiplier may be off by for each joint that a pull has passed
// Of the cosine and of the sine of a joint, sums of products in twice the precision. It counts where they are below
// 1e-17.
constexpr long double rounding_of_products = 0x1p-106L;

long double narrow(const quad &x)
{
    return static_cast<long double>(x);
}

/** Z of a chain and its pivots, P_k = Z_kk - Z_{k,k-1}^2 / P_{k-1}. */
struct elimination {
    std::vector<quad> diagonal, beside, pivot, ratio;  // beside[k] = Z_{k,k-1}, ratio[k] = beside[k] / pivot[k-1]
    bool good = true;                                  // all pivots are positive

    explicit elimination(const exact_chain &c)
    {
        const std::size_t n = c.n_bonds();
        diagonal.reserve(n), beside.reserve(n), pivot.reserve(n), ratio.reserve(n);
        for (std::size_t k = 0; k < n && good; ++k) {
            diagonal.push_back(4 * (c.w[k] + c.w[k + 1]) * dot(c.d[k], c.d[k]));
            beside.push_back(k > 0 ? -4 * c.w[k] * dot(c.d[k - 1], c.d[k]) : quad(0));
            ratio.push_back(k > 0 ? beside[k] / pivot[k - 1] : quad(0));
            pivot.push_back(k > 0 ? diagonal[k] - ratio[k] * beside[k] : diagonal[k]);
            good = pivot[k] > 0;
        }
    }

    long_vec solve(std::vector<quad> b) const
    {
        const std::size_t n = b.size();
        long_vec x(n);
        for (std::size_t k = 1; k < n; ++k) b[k] -= ratio[k] * b[k - 1];
        for (std::size_t k = n; k-- > 0;) {
            b[k] /= pivot[k];
            if (k + 1 < n) b[k] -= ratio[k + 1] * b[k + 1];
            x[k] = narrow(b[k]);
        }
        return x;
    }
};

/** ln of the product of P_k / Z_kk; it is kept near one by powers of two, so that its logarithm keeps its digits. */
long double log_det(const elimination &z)
{
    quad product = 1;
    long exponent = 0;
    for (std::size_t k = 0; k < z.pivot.size(); ++k) {
        product *= z.pivot[k] / z.diagonal[k];
        for (; product < 0.5; product *= 2) --exponent;
    }
    return std::log1p(narrow(product - 1)) + static_cast<long double>(exponent) * std::log(2.0L);
}

struct sizes {
    long_vec size, w;  // |d| and inverse masses
};

/** (Z~^-1)_kk and its neighbours, and the normals u x u' of the joints. */
void fill_metric(const exact_chain &c, const elimination &z, const sizes &s, const long_vec &d, exact_metric &out)
{
    const std::size_t n = c.n_bonds();
    std::vector<quad> backward(n);
    for (std::size_t k = n; k-- > 0;)
        backward[k] = k + 1 < n ? z.diagonal[k] - z.beside[k + 1] * z.beside[k + 1] / backward[k + 1] : z.diagonal[k];
    long_vec h(n + 1, 0), normal(3 * (n + 1), 0), phi(3 * (n + 2), 0), scale(n + 2, 0), margin(n + 2, 0);
    for (std::size_t k = 0; k < n; ++k) {
        const quad whole = z.pivot[k] + backward[k] - z.diagonal[k];
        if (!(whole > 0)) return;
        const long double diagonal = narrow(z.diagonal[k]) / narrow(whole);
        out.diagonal.push_back(diagonal);
        out.step.push_back(
            k > 0 ? -narrow(z.ratio[k]) * std::sqrt(narrow(z.diagonal[k - 1])) / std::sqrt(narrow(z.diagonal[k])) : 0);
        if (k == 0) continue;
        h[k] = s.w[k] * out.step[k] * diagonal /
               (std::sqrt(s.w[k - 1] + s.w[k]) * std::sqrt(s.w[k] + s.w[k + 1]));  // of M^-1, M_kk = w + w'
        out.log_det_margin += 2 * rounding_of_products * std::fabs(h[k]);          // d ln det M / d cosine = 2 h
        const quad3 area = cross(c.d[k - 1], c.d[k]);
        for (std::size_t x = 0; x < 3; ++x) normal[3 * k + x] = narrow(area[x]) / s.size[k - 1] / s.size[k];
    }
    const auto weight = [&](std::size_t k) {
        return std::fabs(h[k]) * std::hypot(normal[3 * k], normal[3 * k + 1], normal[3 * k + 2]);
    };
    const auto loose = [&](std::size_t k) {
        if (k == 0 || k == n) return 0.0L;
        const long double cosine = std::fabs(narrow(dot(c.d[k - 1], c.d[k]))) / s.size[k - 1] / s.size[k];
        return std::fabs(h[k]) * (cosine > 0 ? 1 + 1 / cosine : 1);
    };
    for (std::size_t k = 0; k < n; ++k) {
        long double u[3], v[3];
        for (std::size_t x = 0; x < 3; ++x) {
            u[x] = d[3 * k + x] / s.size[k];
            v[x] = h[k] * normal[3 * k + x] - h[k + 1] * normal[3 * k + 3 + x];
        }
        for (std::size_t x = 0; x < 3; ++x) {
            const std::size_t y = (x + 1) % 3, q = (x + 2) % 3;
            phi[3 * (k + 1) + x] = (u[y] * v[q] - u[q] * v[y]) / s.size[k];
        }
        scale[k + 1] = (weight(k) + weight(k + 1)) / s.size[k];
        // of the sines, and of the cosines that h has as a factor
        margin[k + 1] = rounding_of_products * (loose(k) + loose(k + 1)) / s.size[k];
    }
    for (std::size_t i = 0; i <= n; ++i) {
        for (std::size_t x = 0; x < 3; ++x) out.force.push_back(phi[3 * i + x] - phi[3 * i + 3 + x]);
        out.force_scale.push_back(scale[i] + scale[i + 1]);
        out.force_margin.push_back(margin[i] + margin[i + 1]);
    }
    out.log_det = log_det(z);
    out.regular = true;
}

}  // namespace

long_vec chain_reference::spread(long_vec size) const
{
    for (std::size_t k = 1; k < size.size(); ++k) size[k] += ratio_[k] * size[k - 1];
    for (std::size_t k = size.size(); k-- > 0;)
        size[k] = size[k] / pivot_[k] + (k + 1 < size.size() ? ratio_[k + 1] * size[k + 1] : 0);
    return size;
}

long_vec chain_reference::pulls_by(const hostile_chain &c, const long_vec &size) const
{
    const std::size_t n = pivot_.size();
    long_vec pull(n + 1, 0), lambda(n);
    for (std::size_t k = 0; k < n; ++k)
        lambda[k] =
            2 * (std::fabs(d[3 * k]) + std::fabs(d[3 * k + 1]) + std::fabs(d[3 * k + 2])) * (size[k] + size[k + 1]);
    lambda = spread(std::move(lambda));
    for (std::size_t k = 0; k < n; ++k)
        for (std::size_t i = k; i <= k + 1; ++i) pull[i] += c.w[i] * 2 * lambda[k] * c.length[k];
    return pull;
}

long_vec chain_reference::spread_by_joints(const long_vec &size) const
{
    // (Z^-1)_kl = (Z^-1)_kk times the ratios of the joints between them, of the elimination that comes from l.
    const std::size_t n = size.size();
    long_vec out(n);
    const auto sweep = [&](std::size_t from, std::size_t step, const auto &ratio) {
        long double sum = 0, far = 0;  // of the bonds so far, without and with the roundings of joints
        for (std::size_t i = 0, k = from; i < n; ++i, k += step) {
            const std::size_t joint = std::max(k, k - step);
            const long double l = i > 0 ? ratio(k) : 0;
            far = i > 0 ? l * (far + roundings_[joint] * sum) : 0;
            out[k] += inverse_[k] * far;
            sum = l * sum + size[k];
        }
    };
    sweep(0, 1, [&](std::size_t k) { return ratio_[k]; });
    sweep(n - 1, SIZE_MAX, [&](std::size_t k) { return inverse_[k + 1] * ratio_[k + 1] / inverse_[k]; });
    return out;
}

long double chain_reference::roundings_between(std::size_t k, std::size_t l) const
{
    long double sum = 0;
    for (std::size_t joint = std::min(k, l) + 1; joint <= std::max(k, l); ++joint) sum += roundings_[joint];
    return sum;
}

level_reference chain_reference::level(long_vec lambda, const long_vec &right_side, const long_vec &size) const
{
    level_reference out;
    const std::size_t n = lambda.size();
    const long double bound = oracle_bound(static_cast<std::int64_t>(n));
    const long_vec scale = spread(right_side), far = spread_by_joints(right_side);
    out.g.assign(3 * (n + 1), 0);
    out.g_scale.assign(n + 1, 0);
    out.g_allowed = out.g_scale;
    for (std::size_t k = 0; k < n; ++k) {
        for (std::size_t x = 0; x < 3; ++x) {
            const long double pull = 2 * lambda[k] * d[3 * k + x];
            out.g[3 * k + x] += pull;
            out.g[3 * k + 3 + x] -= pull;
            for (std::size_t y = 0; y < 3; ++y) out.virial[3 * x + y] -= pull * d[3 * k + y];
        }
        const long double allowed = bound * scale[k] + eps_of_joint * far[k];
        for (std::size_t i = k; i <= k + 1; ++i) {
            out.g_scale[i] += 2 * scale[k] * size[k];
            out.g_allowed[i] += 2 * allowed * size[k];
        }
        out.virial_scale += 2 * scale[k] * size[k] * size[k];
        out.virial_allowed += 2 * allowed * size[k] * size[k];
        out.allowed.push_back(allowed);
    }
    out.lambda = std::move(lambda);
    out.scale = scale;
    return out;
}

chain_reference::chain_reference(const hostile_chain &c)
{
    const exact_chain e(c.problem());
    const std::size_t n = e.n_bonds();
    for (std::size_t k = 0; k < n; ++k)
        if (!(c.w[k] + c.w[k + 1] > 0) || !(dot(e.d[k], e.d[k]) > 0)) return;
    const elimination z(e);
    if (!z.good) return;
    sizes s;
    for (std::size_t i = 0; i <= n; ++i) s.w.push_back(narrow(e.w[i]));
    long_vec root(n), row_sum(n, 1);
    roundings_.assign(n, 1);
    for (std::size_t k = 0; k < n; ++k) {
        for (std::size_t x = 0; x < 3; ++x) d.push_back(narrow(e.d[k][x]));
        s.size.push_back(std::hypot(d[3 * k], d[3 * k + 1], d[3 * k + 2]));
        pivot_.push_back(narrow(z.pivot[k]));
        ratio_.push_back(std::fabs(narrow(z.ratio[k])));
        root[k] = std::sqrt(narrow(z.diagonal[k]));
        if (k == 0) continue;
        const long double cosine = std::fabs(narrow(dot(e.d[k - 1], e.d[k]))) / s.size[k - 1] / s.size[k];
        roundings_[k] = 1 + (cosine > 0 ? rounding_of_products / (eps_of_joint * DBL_EPSILON) / cosine : 0);
        const long double beside = std::fabs(narrow(z.beside[k])) / root[k - 1] / root[k];
        row_sum[k] += beside;
        row_sum[k - 1] += beside;
    }
    long_vec inverse_row_sum = spread(root);
    for (std::size_t k = 0; k < n; ++k) inverse_row_sum[k] *= root[k];
    metric.condition = *std::max_element(row_sum.begin(), row_sum.end()) *
                       *std::max_element(inverse_row_sum.begin(), inverse_row_sum.end());
    if (!(metric.condition < 1e60L)) return;  // singular but for the rounding of this arithmetic
    fill_metric(e, z, s, d, metric);
    if (!metric.regular) return;
    for (std::size_t k = 0; k < n; ++k) inverse_.push_back(metric.diagonal[k] / root[k] / root[k]);

    std::vector<quad> force_side, velocity_side;
    long_vec force_size, velocity_size, one;
    for (std::size_t k = 0; k < n; ++k) {
        const quad3 f0 = row(c.f.data(), k), f1 = row(c.f.data(), k + 1);
        const quad3 dv = row(c.v.data(), k + 1) - row(c.v.data(), k);
        const quad squared = 2 * dot(dv, dv);
        force_side.push_back(2 * dot(e.d[k], e.w[k + 1] * f1 - e.w[k] * f0) + squared);
        velocity_side.push_back(2 * dot(e.d[k], dv));
        long double of_forces = narrow(squared), of_velocities = 0, reach = 1;
        for (std::size_t x = 0; x < 3; ++x) {
            const long double along = 2 * std::fabs(d[3 * k + x]);
            const auto size = [&](const std::vector<double> &v, std::size_t i) {
                return std::fabs(static_cast<long double>(v[3 * i + x]));
            };
            of_forces += along * (s.w[k + 1] * size(c.f, k + 1) + s.w[k] * size(c.f, k));
            of_velocities += along * (size(c.v, k + 1) + size(c.v, k));
            reach += along / 2;
        }
        force_size.push_back(of_forces);
        velocity_size.push_back(of_velocities);
        one.push_back(64 * reach * (1 + s.w[k] + s.w[k + 1]));
    }
    forces = level(z.solve(std::move(force_side)), force_size, s.size);
    velocities = level(z.solve(std::move(velocity_side)), velocity_size, s.size);

    // Every product and sum of a right-hand side may be off by the smallest number, and so may each step of the two
    // sweeps, whose unit of mass is the chain's own where all are equal; what a multiplier is off by, its bond pulls at
    // the others. That is seen where forces are denormal numbers, or where multipliers die away until they are.
    underflow = spread(std::move(one));
    const long double longest = *std::max_element(c.length.begin(), c.length.end());
    const long double steps = 4 * static_cast<long double>(n) * (1 + static_cast<long double>(c.mass[0]));
    for (std::size_t k = 0; k < n; ++k) underflow[k] = smallest * (underflow[k] + steps * (longest / c.length[k]));
}

bool is_decided(const hostile_chain &c, const exact_metric &metric)
{
    const long double rounding = solution_epsilon();
    if (rounding < 1e-60L) return true;
    if (!metric.regular) return false;
    long double least = HUGE_VALL, largest = 0;
    for (std::size_t k = 0; k < c.length.size(); ++k) {
        const long double length = c.length[k], diagonal = length * length * (c.w[k] + c.w[k + 1]);
        least = std::min(least, diagonal);
        largest = std::max(largest, diagonal);
    }
    const long double growth = metric.condition * static_cast<long double>(c.n_bonds) * (largest / least);
    return growth * rounding < 1e-3L * DBL_EPSILON;
}

int status_of_undecided(std::int64_t undecided, std::int64_t chains)
{
    if (undecided == 0) return 0;
    std::printf(
        "skipped: the reference has %.1Lg relative rounding, which does not decide about %lld of %lld chains; "
        "with MPFR (libmpfr-dev) it decides about all\n",
        solution_epsilon(), static_cast<long long>(undecided), static_cast<long long>(chains));
    return not_all_decided;
}

long double oracle_bound(std::int64_t n_bonds)
{
    return 16 + std::sqrt(static_cast<long double>(n_bonds));
}

}  // namespace stress
