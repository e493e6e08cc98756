// Long steps: molecules that Newton's method does not bring back in one go, or that come so far from their lengths that
// it may bring them to another root than the reference's.
#pragma once

#include "core/kernels/tally.hpp"
#include "core/molecules/chains.hpp"

namespace holonomic {

class Reference;

// A molecule with a larger |D.D - a^2| / a^2 is not solved among the others, but here; one by sparse LDL^T only beyond
// that of chains, for its kernels test the root themselves (LdlPositions::rejected()). Of 5000 steps that turn small
// molecules by up to 60 degrees 2 below it came to another root; ordinary steps leave it below 0.01. Linear chains bear
// more: of 10,800 of 1 to 30 bonds in Brownian steps of up to 12 per cent of a bond Newton's method brought all to the
// root of the path, and Brownian dynamics takes such steps all the time.
constexpr double far_from_lengths_of_chains = 0.5;
constexpr double far_from_lengths = 0.15;

// With a lower bound on its iterations a molecule gets nothing but these.
constexpr int enough_iterations = 20;

// Looks for the molecules that a call has left, solves those that can be, in the caller's arrays, and returns the tally
// as if the call had. call.worst_trial: beyond which nothing is tried. `reference`: what stands in for reference
// positions, or nullptr.
Tally finish_long_steps(const Chains &chains, const PositionsCall &call, const Reference *reference,
                        const Tally &tally);

}  // namespace holonomic
