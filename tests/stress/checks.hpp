/**
 * @file checks.hpp
 * Compares what the library says about one chain with the reference solution. Bounds are those of
 * tests/oracle/README.md, K = 16 + sqrt(N) in units of eps times the componentwise scale, for multipliers with four
 * more for each joint between a bond and what pulls at it (chain_reference.hpp); where the README has none, they are
 * given here.
 */
#ifndef STRESS_CHECKS_HPP
#define STRESS_CHECKS_HPP

#include "chain_reference.hpp"
#include "hostile_chain.hpp"
#include "library_results.hpp"
#include "quantities.hpp"

namespace stress
{

/**
 * lambda, G and virial of hol_forces; lambda and v of hol_project_velocities.
 * Velocities: |v_i - ref| <= K eps |v_i0| + eps w_i g_allowed_i, g_allowed with all terms of the velocities in its
 * right-hand side: what rounding them may do. These terms are what goes in, what comes out and the pulls 2 w lambda
 * |d|. Of d.dv may be left K eps |d| times those of its two atoms, with the pulls of projecting their rounding.
 */
void check_linear_levels(const hostile_chain &c, const chain_reference &exact, const library_results &alone,
                         verdict &out);

/** ln det, Fixman force, elements of the inverse, its condition number (2 K eps) and the guaranteed error bound. */
void check_metric(const hostile_chain &c, const chain_reference &ref, const arrangement &a,
                  const library_results &alone, verdict &out);

/**
 * Bond lengths: |d.d - a^2| / a^2 <= 8 eps (1 + extent / shortest bond), twice what hol_chains_set_tolerance describes
 * as the default because rounding the coordinates comes on top. Shift: r - drift = dt^2 w G(lambda) along the old bonds
 * to K eps of the terms of that sum, with the pulls of projecting their rounding.
 */
void check_positions(const hostile_chain &c, const chain_reference &exact, const library_results &alone, verdict &out);

/** A chain that failed keeps its outputs bit for bit; one that did not has only finite ones. */
void check_outputs(const hostile_chain &c, const library_results &part, verdict &out);

/** Whether everything is the same to the last bit. */
void check_same(const library_results &one, const library_results &other, verdict &out);

/** Everything about one chain on its own. */
verdict check_alone(const hostile_chain &c, const chain_reference &exact);

}  // namespace stress

#endif
