/**
 * @file chain_reference.hpp
 * Everything that a chain is compared with, from one elimination in wide numbers and in time proportional to the number
 * of bonds. It is made once per chain and serves every set of kernels. What sums only positive terms, or is wanted to
 * some roundings of its scale, is done in long double. tests/stress/check_reference.cpp compares it with the solutions
 * of tests/reference.
 */
#ifndef STRESS_CHAIN_REFERENCE_HPP
#define STRESS_CHAIN_REFERENCE_HPP

#include <cstdint>
#include <vector>

#include "exact_metric.hpp"
#include "hostile_chain.hpp"

namespace stress
{

using long_vec = std::vector<long double>;

/**
 * Multipliers of one level, what they do, the scales of solution.h, and how many eps each may be off by:
 *     allowed_k = K scale_k + 4 sum_l n_kl |Z^-1|_kl S_l,   scale_k = sum_l |Z^-1|_kl S_l,   K = 16 + sqrt(N).
 * What pulls at bond l reaches bond k through the joints between them, as a product of their multipliers. Each of these
 * has some sixteen roundings of half an eps at most, and one that is square to less than 1e-17 more, as its cosine is
 * known to 2^-106 (docs/stability.md): n_kl is their number, each with 2^-56 / |cos| more.
 */
struct level_reference {
    long_vec lambda, scale, allowed;  ///< [n_bonds]
    long_vec g, g_scale, g_allowed;   ///< [n_bonds+1][3] and [n_bonds+1]
    long double virial[9] = {}, virial_scale = 0, virial_allowed = 0;
};

struct chain_reference {
    exact_metric metric;  ///< metric.regular: Z has an inverse; nothing below is set otherwise
    level_reference forces, velocities;
    long_vec d;          ///< [n_bonds][3] bond vectors
    long_vec underflow;  ///< what underflow may cost each multiplier; far below everything in ordinary units

    explicit chain_reference(const hostile_chain &c);

    /** |Z^-1| times these sizes. */
    long_vec spread(long_vec size) const;

    /** Elements of |Z^-1| times n_kl, times these sizes. */
    long_vec spread_by_joints(const long_vec &size) const;

    /** n_kl. */
    long double roundings_between(std::size_t k, std::size_t l) const;

    /** Sizes of what projecting velocities (or displacements) of the given sizes pulls each atom with, times w. */
    long_vec pulls_by(const hostile_chain &c, const long_vec &size) const;

private:
    level_reference level(long_vec lambda, const long_vec &right_side, const long_vec &size) const;

    long_vec pivot_, ratio_;  // P_k of Z, and |Z_{k,k-1}| / P_{k-1}
    long_vec inverse_;        // (Z^-1)_kk
    long_vec roundings_;      // [k]: what the joint between bonds k-1 and k adds to n_kl
};

/**
 * Whether the reference's arithmetic decides about this chain: about all of them with MPFR, with 113 bits about those
 * whose reference is right to a thousandth of a rounding of the library's. Elimination without exchange solves a system
 * whose elements are off by some roundings u of this arithmetic, for Z is positive definite and tridiagonal. With Z~,
 * which has ones on its diagonal, the solution is off by N u cond(Z~) of its largest component, and that is at most
 * max Z_kk / min Z_kk of the smallest. If the condition number that 113 bits find is small in that sense, the true one
 * is the same but for this error.
 */
bool is_decided(const hostile_chain &c, const exact_metric &metric);

/** Exit status of a program that found nothing wrong, but could not decide about all its chains; ctest says so. */
constexpr int not_all_decided = 77;

/** A line that says how many of these it could not decide about, and why; 0 if it could about all of them. */
int status_of_undecided(std::int64_t undecided, std::int64_t chains);

/** K of tests/oracle/README.md. */
long double oracle_bound(std::int64_t n_bonds);

}  // namespace stress

#endif
