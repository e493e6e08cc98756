#include <algorithm>
#include <cmath>

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

void check_inverse(const hostile_chain &c, const chain_reference &ref, const arrangement &a,
                   const library_results &alone, verdict &out)
{
    const exact_metric &exact = ref.metric;
    hol_inverse *made = nullptr;
    const int status = hol_inverse_create(a.chains.get(), 0, a.r.data(), &made);
    const inverse_handle inverse(made);
    out.note(REFUSED, status != HOL_OK);
    if (status != HOL_OK) return;
    const std::int64_t n = c.n_bonds;
    const long double k_eps = oracle_bound(n) * eps;
    vec band(2 * at(n));
    hol_inverse_band(made, HOL_UNIT_DIAGONAL, 1, band.data());
    for (std::size_t k = 0; k < at(n); ++k) {
        out.compare(INVERSE, band[2 * k], exact.diagonal[k], k_eps * exact.diagonal[k]);
        if (k + 1 == at(n)) break;
        const long double beside = exact.step[k + 1] * exact.diagonal[k + 1];
        out.compare(INVERSE, band[2 * k + 1], beside, (k_eps + 2 * eps) * std::fabs(beside));
    }
    random_stream stream = random_seed(c.seed);
    for (int sample = 0; sample < 8; ++sample) {
        std::int64_t i = random_integer(&stream, 0, n - 1), j = random_integer(&stream, 0, n - 1);
        double value = 0;
        hol_inverse_entry(made, HOL_UNIT_DIAGONAL, i, j, &value);
        if (i > j) std::swap(i, j);
        const long double reference = exact.entry(i, j);
        if (reference != 0 && std::fabs(reference) < 1e-290L) continue;  // underflows, and loses digits before
        out.compare(INVERSE, value, reference,
                    (oracle_bound(n) + 2 * static_cast<long double>(j - i)) * eps * std::fabs(reference));
    }
    double condition = 0;
    hol_inverse_condition(made, &condition);
    out.compare(CONDITION, condition, exact.condition, 2 * k_eps * exact.condition);

    if (alone.forces != HOL_OK) return;
    const level_reference &s = ref.forces;
    vec bound(at(n));
    double relative = 0;
    const int bounded =
        hol_inverse_error_bound(made, a.v.data(), a.f.data(), alone.lambda.data(), bound.data(), &relative);
    out.note(ERROR_BOUND, bounded != HOL_OK);
    for (std::size_t k = 0; k < at(n) && bounded == HOL_OK; ++k)
        out.compare(ERROR_BOUND, alone.lambda[k], s.lambda[k],
                    bound[k] + 4 * ref.underflow[k] +
                        std::fabs(s.lambda[k]) * 0x1p-62L);  // the reference is rounded to 64 bits
}

}  // namespace

void check_metric(const hostile_chain &c, const chain_reference &ref, const arrangement &a,
                  const library_results &alone, verdict &out)
{
    const exact_metric &exact = ref.metric;
    const long double k_eps = oracle_bound(c.n_bonds) * eps;
    if (alone.metric == HOL_OK) {
        // The reference takes its logarithm of a product that may differ from 1 by less than it can hold.
        const long double rounding = static_cast<long double>(c.n_bonds) * solution_epsilon();
        out.compare(LOG_DET, alone.log_det[0], exact.log_det,
                    k_eps * std::fabs(exact.log_det) + rounding + 16 * exact.log_det_margin);
        for (std::size_t i = 0; i < exact.force.size(); ++i)
            out.compare(FIXMAN_FORCE, alone.fixman[i], exact.force[i],
                        2 * k_eps * exact.force_scale[i / 3] + 16 * exact.force_margin[i / 3]);
    }
    check_inverse(c, ref, a, alone, out);
}

}  // namespace stress
