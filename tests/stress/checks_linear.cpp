#include <algorithm>
#include <cmath>

#include "checks.hpp"

namespace stress
{

namespace
{

constexpr long double eps = DBL_EPSILON, smallest = 4.9406564584124654e-324L;

std::size_t at(std::int64_t i)
{
    return static_cast<std::size_t>(i);
}

long double size_of(const hostile_chain &c, std::size_t k)
{
    return c.length[k];
}

}  // namespace

namespace
{

/**
 * What each multiplier may be off by beside K eps times its scale: what underflow costs it, and K eps times 1e-80 of
 * the largest one of its chain. Multipliers that small are products of the elimination's multipliers along many bonds:
 * their roundings add up, and in the segments of long chains the product vanishes earlier than what it is multiplied by
 * allows.
 */
long_vec slack_of(const hostile_chain &c, const level_reference &s, long_vec out)
{
    const long double largest = *std::max_element(s.scale.begin(), s.scale.end());
    for (std::size_t k = 0; k < out.size(); ++k)
        if (s.scale[k] > 0) out[k] += oracle_bound(c.n_bonds) * eps * 1e-80L * largest;
    return out;
}

void check_forces(const hostile_chain &c, const chain_reference &exact, const library_results &alone, verdict &out)
{
    const level_reference &ref = exact.forces;
    const long_vec margin = slack_of(c, ref, exact.underflow);
    const long double k_eps = oracle_bound(c.n_bonds) * eps;
    const std::size_t n = at(c.n_bonds);
    long_vec g_margin(n + 1, 0);
    long double virial_margin = 0;
    for (std::size_t k = 0; k < n; ++k) {
        out.compare(LAMBDA, alone.lambda[k], ref.lambda[k], eps * ref.allowed[k] + margin[k]);
        out.compare(LAMBDA_NEAR, alone.lambda[k], ref.lambda[k], k_eps * ref.scale[k] + margin[k]);
        const long double pull = margin[k] > 0 ? 2 * margin[k] * size_of(c, k) + 8 * smallest : 0;
        g_margin[k] += pull;
        g_margin[k + 1] += pull;
        virial_margin += pull * size_of(c, k) + 8 * (pull > 0 ? smallest : 0);
    }
    for (std::size_t i = 0; i < 3 * (n + 1); ++i)
        out.compare(FORCE, alone.g[i], ref.g[i], eps * ref.g_allowed[i / 3] + g_margin[i / 3]);
    for (std::size_t i = 0; i < 9; ++i)
        out.compare(VIRIAL, alone.virial[i], ref.virial[i], eps * ref.virial_allowed + virial_margin);
}

void check_velocities(const hostile_chain &c, const chain_reference &exact, const library_results &alone, verdict &out)
{
    const level_reference &ref = exact.velocities;
    const long_vec margin = slack_of(c, ref, exact.underflow);
    const long double k_eps = oracle_bound(c.n_bonds) * eps;
    const std::size_t n = at(c.n_bonds);
    long_vec term(n + 1, 0), g_margin(n + 1, 0);  // sizes of what adds up to the velocity of an atom
    for (std::size_t k = 0; k < n; ++k) {
        out.compare(VELOCITY_LAMBDA, alone.velocity_lambda[k], ref.lambda[k], eps * ref.allowed[k] + margin[k]);
        const long double larger =
            std::max(std::fabs(ref.lambda[k]), std::fabs(static_cast<long double>(alone.velocity_lambda[k])));
        const long double pull = 2 * larger * size_of(c, k);
        for (std::size_t i = k; i <= k + 1; ++i) {
            term[i] += c.w[i] * pull;
            if (margin[k] > 0) g_margin[i] += 2 * margin[k] * size_of(c, k) * c.w[i] + 8 * smallest * (1 + c.w[i]);
        }
    }
    for (std::size_t i = 0; i <= n; ++i)
        for (std::size_t x = 0; x < 3; ++x)
            term[i] += std::fabs(static_cast<long double>(c.v[3 * i + x])) +
                       std::fabs(static_cast<long double>(alone.v[3 * i + x]));
    const long_vec second = exact.pulls_by(c, term);  // of a projection of the rounding, in units of eps
    for (std::size_t i = 0; i <= n; ++i)
        for (std::size_t x = 0; x < 3; ++x) {
            const long double before = c.v[3 * i + x], after = before + c.w[i] * ref.g[3 * i + x];
            out.compare(VELOCITY, alone.v[3 * i + x], after,
                        k_eps * (std::fabs(before) + second[i]) + eps * c.w[i] * ref.g_allowed[i] + g_margin[i]);
        }
    for (std::size_t i = 0; i <= n; ++i) term[i] += eps * second[i];
    for (std::size_t k = 0; k < n; ++k) {
        long double left = 0;
        for (std::size_t x = 0; x < 3; ++x)
            left += exact.d[3 * k + x] * (static_cast<long double>(alone.v[3 * k + 3 + x]) - alone.v[3 * k + x]);
        left = std::fabs(left);
        const long double allowed = size_of(c, k) * (k_eps * (term[k] + term[k + 1]) + g_margin[k] + g_margin[k + 1]);
        if (c.w[k] != 0 || c.w[k + 1] != 0) out.note(VELOCITY_RESIDUAL, left == 0 ? 0 : left / allowed);
    }
}

}  // namespace

void check_linear_levels(const hostile_chain &c, const chain_reference &exact, const library_results &alone,
                         verdict &out)
{
    if (alone.forces == HOL_OK) check_forces(c, exact, alone, out);
    if (alone.velocities == HOL_OK) check_velocities(c, exact, alone, out);
}

}  // namespace stress
