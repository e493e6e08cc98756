#include <algorithm>
#include <cmath>

#include "bond_matrix.hpp"
#include "checks.hpp"
#include "linear_solve.hpp"

namespace stress
{

using namespace reference;

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

struct reference_solution {
    solution s{};
    bool ok;
    reference_solution(const hostile_chain &c, int (*solve)(const solution_problem *, solution *))
    {
        const solution_problem p = c.problem();
        ok = solve(&p, &s) == 0;
    }
    ~reference_solution()
    {
        if (ok) solution_free(&s);
    }
    reference_solution(const reference_solution &) = delete;
    reference_solution &operator=(const reference_solution &) = delete;
};

}  // namespace

/**
 * Every product and sum of a right-hand side may be off by the smallest number, and so may each step of the two sweeps,
 * whose unit of mass is the chain's own where all are equal; what a multiplier is off by, its bond pulls at the others.
 * That is seen where forces are denormal numbers, or where multipliers die away along a chain until they are.
 */
std::vector<long double> underflow_of(const hostile_chain &c)
{
    std::vector<long double> out(at(c.n_bonds), 0);
    const exact_chain e(c.problem());
    std::vector<quad> rhs;
    for (std::size_t k = 0; k < e.n_bonds(); ++k) {
        quad s = 1;
        for (std::size_t x = 0; x < 3; ++x) s += absolute(e.d[k][x]);
        rhs.push_back(64 * s * (1 + e.w[k] + e.w[k + 1]));
    }
    if (!solve_banded(with_negative_neighbours(bond_matrix(e)), rhs)) return out;
    const long double longest = *std::max_element(c.length.begin(), c.length.end());
    const long double steps = 4 * static_cast<long double>(c.n_bonds) * (1 + static_cast<long double>(c.mass[0]));
    for (std::size_t k = 0; k < out.size(); ++k)
        out[k] = smallest * (static_cast<long double>(rhs[k]) + steps * (longest / size_of(c, k)));
    return out;
}

/**
 * A projection removes from a bond what its atoms' displacements, or velocities, put into it; their sizes are given.
 */
std::vector<long double> pulls_by(const hostile_chain &c, const std::vector<long double> &size)
{
    const exact_chain e(c.problem());
    const std::size_t n = at(c.n_bonds);
    std::vector<long double> pull(n + 1, 0);
    std::vector<quad> lambda;
    for (std::size_t k = 0; k < n; ++k) {
        quad s = 0;
        for (std::size_t x = 0; x < 3; ++x) s += 2 * absolute(e.d[k][x]) * quad(size[k] + size[k + 1]);
        lambda.push_back(s);
    }
    if (!solve_banded(with_negative_neighbours(bond_matrix(e)), lambda)) return pull;
    for (std::size_t k = 0; k < n; ++k)
        for (std::size_t i = k; i <= k + 1; ++i)
            pull[i] += c.w[i] * 2 * static_cast<long double>(lambda[k]) * size_of(c, k);
    return pull;
}

namespace
{

/**
 * What each multiplier may be off by beside K eps times its scale: what underflow costs it, and K eps times 1e-80 of
 * the largest one of its chain. Multipliers that small are products of the elimination's multipliers along many bonds:
 * their roundings add up, and in the segments of long chains the product vanishes earlier than what it is multiplied by
 * allows.
 */
std::vector<long double> slack_of(const hostile_chain &c, const solution &s)
{
    std::vector<long double> out = underflow_of(c);
    const long double largest = *std::max_element(s.lambda_scale, s.lambda_scale + c.n_bonds);
    for (std::size_t k = 0; k < out.size(); ++k)
        if (s.lambda_scale[k] > 0) out[k] += oracle_bound(c.n_bonds) * eps * 1e-80L * largest;
    return out;
}

void check_forces(const hostile_chain &c, const library_results &alone, verdict &out)
{
    const reference_solution ref(c, solution_forces);
    if (!ref.ok) return;
    const std::vector<long double> slack = slack_of(c, ref.s);
    const long double k_eps = oracle_bound(c.n_bonds) * eps;
    const std::size_t n = at(c.n_bonds);
    std::vector<long double> g_slack(n + 1, 0);
    long double virial_slack = 0;
    for (std::size_t k = 0; k < n; ++k) {
        out.compare(LAMBDA, alone.lambda[k], ref.s.lambda[k], k_eps * ref.s.lambda_scale[k] + slack[k]);
        const long double pull = slack[k] > 0 ? 2 * slack[k] * size_of(c, k) + 8 * smallest : 0;
        g_slack[k] += pull;
        g_slack[k + 1] += pull;
        virial_slack += pull * size_of(c, k) + 8 * (pull > 0 ? smallest : 0);
    }
    for (std::size_t i = 0; i < 3 * (n + 1); ++i)
        out.compare(FORCE, alone.g[i], ref.s.g[i], k_eps * ref.s.g_scale[i / 3] + g_slack[i / 3]);
    for (std::size_t i = 0; i < 9; ++i)
        out.compare(VIRIAL, alone.virial[i], ref.s.virial[i], k_eps * ref.s.virial_scale + virial_slack);
}

void check_velocities(const hostile_chain &c, const library_results &alone, verdict &out)
{
    const reference_solution ref(c, solution_velocities);
    if (!ref.ok) return;
    const std::vector<long double> slack = slack_of(c, ref.s);
    const exact_chain e(c.problem());
    const long double k_eps = oracle_bound(c.n_bonds) * eps;
    const std::size_t n = at(c.n_bonds);
    std::vector<long double> term(n + 1, 0), g_slack(n + 1, 0);  // sizes of what adds up to the velocity of an atom
    for (std::size_t k = 0; k < n; ++k) {
        out.compare(VELOCITY_LAMBDA, alone.velocity_lambda[k], ref.s.lambda[k],
                    k_eps * ref.s.lambda_scale[k] + slack[k]);
        const long double larger =
            std::max(std::fabs(ref.s.lambda[k]), std::fabs(static_cast<long double>(alone.velocity_lambda[k])));
        const long double pull = 2 * larger * size_of(c, k);
        for (std::size_t i = k; i <= k + 1; ++i) {
            term[i] += c.w[i] * pull;
            if (slack[k] > 0) g_slack[i] += 2 * slack[k] * size_of(c, k) * c.w[i] + 8 * smallest * (1 + c.w[i]);
        }
    }
    for (std::size_t i = 0; i <= n; ++i)
        for (std::size_t x = 0; x < 3; ++x)
            term[i] += std::fabs(static_cast<long double>(c.v[3 * i + x])) +
                       std::fabs(static_cast<long double>(alone.v[3 * i + x]));
    const std::vector<long double> second = pulls_by(c, term);  // of a projection of the rounding, in units of eps
    for (std::size_t i = 0; i <= n; ++i)
        for (std::size_t x = 0; x < 3; ++x) {
            const long double before = c.v[3 * i + x], exact = before + c.w[i] * ref.s.g[3 * i + x];
            out.compare(VELOCITY, alone.v[3 * i + x], exact,
                        k_eps * (std::fabs(before) + c.w[i] * ref.s.g_scale[i] + second[i]) + g_slack[i]);
        }
    for (std::size_t i = 0; i <= n; ++i) term[i] += eps * second[i];
    for (std::size_t k = 0; k < n; ++k) {
        const quad3 dv = row(alone.v.data(), k + 1) - row(alone.v.data(), k);
        const long double left = std::fabs(static_cast<long double>(dot(e.d[k], dv)));
        const long double allowed = size_of(c, k) * (k_eps * (term[k] + term[k + 1]) + g_slack[k] + g_slack[k + 1]);
        if (c.w[k] != 0 || c.w[k + 1] != 0) out.note(VELOCITY_RESIDUAL, left == 0 ? 0 : left / allowed);
    }
}

}  // namespace

long double oracle_bound(std::int64_t n_bonds)
{
    return 16 + std::sqrt(static_cast<long double>(n_bonds));
}

void check_linear_levels(const hostile_chain &c, const library_results &alone, verdict &out)
{
    if (alone.forces == HOL_OK) check_forces(c, alone, out);
    if (alone.velocities == HOL_OK) check_velocities(c, alone, out);
}

}  // namespace stress
