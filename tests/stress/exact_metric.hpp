/**
 * @file exact_metric.hpp
 * What solution_metric_make gives, in time proportional to the number of bonds, so that chains of thousands can be
 * checked by the thousand: inverse elements by elimination from both ends.
 */
#ifndef STRESS_EXACT_METRIC_HPP
#define STRESS_EXACT_METRIC_HPP

#include <cstdint>
#include <vector>

#include "solution.h"

namespace stress
{

struct exact_metric {
    bool regular = false; /**< false: Z~ is singular; nothing else is set */
    long double log_det = 0, condition = 0;
    std::vector<long double> force, force_scale; /**< of the Fixman potential over kT, [n+1][3] and [n+1] */
    /** What the sines and cosines of joints, known to the rounding of twice the precision, leave of these;
     * chain_reference alone. */
    std::vector<long double> force_margin;
    long double log_det_margin = 0;
    std::vector<long double> diagonal, step; /**< (Z~^-1)_kk and (Z~^-1)_{k-1,k} / (Z~^-1)_kk */

    /** (Z~^-1)_ij, i <= j counted from 0. */
    long double entry(std::int64_t i, std::int64_t j) const;
};

exact_metric metric_of(const solution_problem &problem);

}  // namespace stress

#endif
