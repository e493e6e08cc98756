// Multipliers of given right-hand sides.
#ifndef HOLONOMIC_SOLVE_HPP
#define HOLONOMIC_SOLVE_HPP

#include "core/molecules/chains.hpp"

namespace holonomic {

// Z lambda = rhs. lambda, which may be rhs, g and virial [9]: or nullptr. Throws Error once everything that is due has
// been written.
void solve(const Chains &chains, const AtomArray &r, const double *rhs, double *lambda, const AtomArray &g, bool add,
           double *virial);

}  // namespace holonomic
#endif
