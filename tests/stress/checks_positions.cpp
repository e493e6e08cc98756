#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "checks.hpp"

namespace stress
{

namespace
{

constexpr long double eps = DBL_EPSILON;

std::size_t at(std::int64_t i)
{
    return static_cast<std::size_t>(i);
}

/** Whether steps are counted that have an answer and are refused: for the table alone, as it takes more than all else.
 */
bool counts_refused_steps()
{
    static const bool wanted = std::getenv("STRESS_MARKDOWN") != nullptr;
    return wanted;
}

/** Whether the reference's Newton method finds an answer. */
bool has_answer(const hostile_chain &c)
{
    const solution_problem p = c.problem();
    solution s;
    std::vector<long double> r(3 * at(c.n_bonds + 1));
    if (solution_positions(&p, drifted(c).data(), c.length.data(), c.dt, r.data(), &s) < 0) return false;
    solution_free(&s);
    return true;
}

bool finite(const vec &x)
{
    return std::all_of(x.begin(), x.end(), [](double y) { return std::isfinite(y); });
}

bool all_unwritten(const vec &x)
{
    return std::all_of(x.begin(), x.end(), is_unwritten);
}

}  // namespace

void check_positions(const hostile_chain &c, const chain_reference &exact, const library_results &alone, verdict &out)
{
    if (c.dt == 0) return;
    const bool refused = alone.positions != HOL_OK;
    if (counts_refused_steps()) out.note(REFUSED_STEP, refused && has_answer(c));
    if (refused) return;
    const vec drift = drifted(c);
    const std::size_t n = at(c.n_bonds);
    const long double k_eps = oracle_bound(c.n_bonds) * eps;
    const long double dt2 = static_cast<long double>(c.dt) * c.dt;
    long double extent = 0;
    for (std::size_t i = 0; i < drift.size(); ++i)
        extent = std::max(
            {extent, std::fabs(static_cast<long double>(drift[i])), std::fabs(static_cast<long double>(c.r[i]))});
    const long double shortest = *std::min_element(c.length.begin(), c.length.end());
    long_vec term(n + 1, 0);
    long_vec shift(3 * (n + 1), 0);
    for (std::size_t k = 0; k < n; ++k) {
        const long double a = c.length[k], lambda = alone.position_lambda[k];
        long double square = 0;
        for (std::size_t x = 0; x < 3; ++x) {
            const long double d = static_cast<long double>(alone.r[3 * k + 3 + x]) - alone.r[3 * k + x];
            square += d * d;
        }
        const long double error = std::fabs(square - a * a) / (a * a);
        // a bond between atoms that are both fixed stays as it is; there is none here
        out.note(POSITION_LENGTH, error / (8 * eps * (1 + extent / shortest)));
        out.note(POSITION_LENGTH_LOCAL, error / (8 * eps * (1 + extent / c.length[k])));
        for (std::size_t x = 0; x < 3; ++x) {
            const long double pull = 2 * lambda * exact.d[3 * k + x];
            shift[3 * k + x] += pull;
            shift[3 * k + 3 + x] -= pull;
        }
        const long double size = 2 * std::fabs(lambda) * a;
        term[k] += dt2 * c.w[k] * size;
        term[k + 1] += dt2 * c.w[k + 1] * size;
    }
    for (std::size_t i = 0; i <= n; ++i)
        for (std::size_t x = 0; x < 3; ++x) term[i] += std::fabs(static_cast<long double>(drift[3 * i + x]));
    const long_vec second = exact.pulls_by(c, term);
    for (std::size_t i = 0; i <= n; ++i)
        for (std::size_t x = 0; x < 3; ++x) {
            const long double after = drift[3 * i + x] + dt2 * c.w[i] * shift[3 * i + x];
            const long double error = std::fabs(alone.r[3 * i + x] - after);
            const long double allowed = k_eps * (term[i] + eps * second[i]);
            out.note(POSITION_SHIFT, error == 0 ? 0 : error / allowed);
        }
}

void check_outputs(const hostile_chain &c, const library_results &part, verdict &out)
{
    const auto level = [&](int status, bool kept, bool complete) {
        const bool failed = status != HOL_OK;  // of this chain, or of another in the same call
        out.note(OUTPUTS_KEPT, !(complete || (failed && kept)));
    };
    const vec drift = drifted(c);
    level(part.forces, all_unwritten(part.lambda) && all_unwritten(part.g), finite(part.lambda) && finite(part.g));
    level(part.metric, all_unwritten(part.log_det) && all_unwritten(part.fixman),
          finite(part.log_det) && finite(part.fixman));
    level(part.velocities, all_unwritten(part.velocity_lambda) && same_bits(part.v, c.v),
          finite(part.velocity_lambda) && finite(part.v));
    level(part.positions, all_unwritten(part.position_lambda) && same_bits(part.r, drift) && same_bits(part.moved, c.v),
          finite(part.position_lambda) && finite(part.r) && finite(part.moved));
}

void check_same(const library_results &one, const library_results &other, verdict &out)
{
    const vec library_results::*const all[] = {&library_results::lambda,
                                               &library_results::g,
                                               &library_results::log_det,
                                               &library_results::fixman,
                                               &library_results::velocity_lambda,
                                               &library_results::v,
                                               &library_results::position_lambda,
                                               &library_results::r,
                                               &library_results::moved};
    for (const auto member : all) out.note(SAME_BITS, !same_bits(one.*member, other.*member));
}

verdict check_alone(const hostile_chain &c, const chain_reference &exact)
{
    verdict out;
    const arrangement a = arrange({&c}, 0);
    const library_results alone = compute(a, c.dt > 0 ? c.dt : 1);
    check_outputs(c, alone, out);
    const bool undecided = !is_decided(c, exact.metric);
    out.note(UNDECIDED, undecided);
    if (undecided) return out;
    if (!exact.metric.regular) {  // nothing to compare with: the chain is taut between fixed atoms
        out.note(ACCEPTED, alone.forces != HOL_ERR_DEGENERATE || alone.velocities != HOL_ERR_DEGENERATE ||
                               alone.metric != HOL_ERR_DEGENERATE);
        return out;
    }
    out.note(REFUSED, alone.forces != HOL_OK || alone.velocities != HOL_OK || alone.metric != HOL_OK);
    check_linear_levels(c, exact, alone, out);
    check_metric(c, exact, a, alone, out);
    check_positions(c, exact, alone, out);
    return out;
}

}  // namespace stress
