/**
 * @file chain_reference.hpp
 * Everything that a chain is compared with, from one elimination in wide numbers and in time proportional to the number
 * of bonds. It is made once per chain and serves every set of kernels. What sums only positive terms, or is wanted to
 * some roundings of its scale, is done in long double. tests/stress/check_reference.cpp compares it with the solutions
 * of tests/reference.
 */
#ifndef STRESS_CHAIN_REFERENCE_HPP
#define STRESS_CHAIN_REFERENCE_HPP

#include <vector>

#include "exact_metric.hpp"
#include "hostile_chain.hpp"

namespace stress
{

using long_vec = std::vector<long double>;

/** Multipliers of one level, what they do, and the scales of solution.h. */
struct level_reference {
    long_vec lambda, scale;  ///< [n_bonds]
    long_vec g, g_scale;     ///< [n_bonds+1][3] and [n_bonds+1]
    long double virial[9] = {}, virial_scale = 0;
};

struct chain_reference {
    exact_metric metric;  ///< metric.regular: Z has an inverse; nothing below is set otherwise
    level_reference forces, velocities;
    long_vec d;          ///< [n_bonds][3] bond vectors
    long_vec underflow;  ///< what underflow may cost each multiplier; far below everything in ordinary units

    explicit chain_reference(const hostile_chain &c);

    /** |Z^-1| times these sizes. */
    long_vec spread(long_vec size) const;

    /** Sizes of what projecting velocities (or displacements) of the given sizes pulls each atom with, times w. */
    long_vec pulls_by(const hostile_chain &c, const long_vec &size) const;

private:
    long_vec pivot_, ratio_;  // P_k of Z, and |Z_{k,k-1}| / P_{k-1}
};

/** K of tests/oracle/README.md. */
long double oracle_bound(std::int64_t n_bonds);

}  // namespace stress

#endif
