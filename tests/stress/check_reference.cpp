/**
 * chain_reference against the solutions of tests/reference, which know nothing of its single elimination:
 *     check_reference [CHAINS [FIRST]]
 * Exit status 1 if a number is off by more than the rounding of long double explains; 77 if none is, but without MPFR
 * some chains are not decided.
 */
#include <cfloat>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "bond_matrix.hpp"
#include "chain_reference.hpp"
#include "solution.h"

using namespace stress;

namespace
{

long double worst = 0;

void compare(long double value, long double reference, long double scale)
{
    const long double error = std::fabs(value - reference);
    if (error == 0) return;
    const long double off = error / (LDBL_EPSILON * scale);
    if (!(off <= worst)) worst = off;
}

void compare_level(const hostile_chain &c, const level_reference &x, int (*solve)(const solution_problem *, solution *))
{
    const solution_problem p = c.problem();
    solution s;
    if (solve(&p, &s)) {
        worst = HUGE_VALL;
        return;
    }
    const std::size_t n = static_cast<std::size_t>(c.n_bonds);
    for (std::size_t k = 0; k < n; ++k) {
        compare(x.lambda[k], s.lambda[k], s.lambda_scale[k]);
        compare(x.scale[k], s.lambda_scale[k], s.lambda_scale[k]);
    }
    for (std::size_t i = 0; i < 3 * (n + 1); ++i) compare(x.g[i], s.g[i], s.g_scale[i / 3]);
    for (std::size_t i = 0; i <= n; ++i) compare(x.g_scale[i], s.g_scale[i], s.g_scale[i]);
    for (std::size_t i = 0; i < 9; ++i) compare(x.virial[i], s.virial[i], s.virial_scale);
    compare(x.virial_scale, s.virial_scale, s.virial_scale);
    solution_free(&s);
}

void compare_metric(const exact_metric &x, const exact_metric &y)
{
    // Both take their logarithm of a product that may differ from 1 by less than it can hold.
    const long double rounding = static_cast<long double>(y.diagonal.size()) * solution_epsilon();
    compare(x.log_det, y.log_det, std::fabs(y.log_det) + rounding / LDBL_EPSILON);
    compare(x.condition, y.condition, y.condition);
    for (std::size_t k = 0; k < y.diagonal.size(); ++k) {
        compare(x.diagonal[k], y.diagonal[k], y.diagonal[k]);
        compare(x.step[k], y.step[k], std::fabs(y.step[k]));
    }
    for (std::size_t i = 0; i < y.force.size(); ++i) compare(x.force[i], y.force[i], y.force_scale[i / 3]);
    for (std::size_t i = 0; i < y.force_scale.size(); ++i)
        compare(x.force_scale[i], y.force_scale[i], y.force_scale[i]);
}

/** Against the elements of the inverse one by one. */
void compare_spread(const hostile_chain &c, const chain_reference &x)
{
    const std::int64_t n = c.n_bonds;
    const auto at = [](std::int64_t i) { return static_cast<std::size_t>(i); };
    long_vec size, root;
    for (std::int64_t k = 0; k < n; ++k) {
        size.push_back(1 + static_cast<long double>(k % 7));
        root.push_back(2 * std::sqrt(static_cast<long double>(c.w[at(k)]) + c.w[at(k + 1)]) *
                       std::hypot(x.d[3 * at(k)], x.d[3 * at(k) + 1], x.d[3 * at(k) + 2]));
    }
    const long_vec far = x.spread_by_joints(size);
    for (std::int64_t k = 0; k < n; ++k) {
        long double sum = 0;
        for (std::int64_t l = 0; l < n; ++l) {
            const long double element = std::fabs(x.metric.entry(k < l ? k : l, k < l ? l : k));
            sum += x.roundings_between(at(k), at(l)) * element / root[at(k)] / root[at(l)] * size[at(l)];
        }
        compare(far[at(k)], sum, sum);
    }
}

}  // namespace

int main(int argc, char **argv)
{
    const int count = argc > 1 ? std::atoi(argv[1]) : 300;
    const std::uint64_t first = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 1;
    int regular = 0, undecided = 0;
    for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
        const hostile_chain c = make_hostile_chain(seed, 300);
        const chain_reference x(c);
        const exact_metric metric = metric_of(c.problem());
        if (!is_decided(c, metric)) {
            ++undecided;
            continue;
        }
        if (metric.regular != x.metric.regular) {
            std::printf("chain %llu: one of the two takes it for singular\n", static_cast<unsigned long long>(seed));
            return 1;
        }
        if (!metric.regular) continue;
        ++regular;
        compare_level(c, x.forces, solution_forces);
        compare_level(c, x.velocities, solution_velocities);
        compare_metric(x.metric, metric);
        compare_spread(c, x);
        if (worst > 4 * (16 + 300)) {
            std::printf("chain %llu: off by %.3Lg roundings of long double\n", static_cast<unsigned long long>(seed),
                        worst);
            return 1;
        }
    }
    std::printf("%d chains, %d regular: off by %.3Lg roundings of long double at the most\n", count, regular, worst);
    return status_of_undecided(undecided, count);
}
