// Acceleration level: multipliers and constraint forces of all chains.
#pragma once

#include "core/molecules/chains.hpp"

namespace holonomic {

// virial [9] or nullptr. Throws Error once everything that is due has been written.
void forces(const Chains &chains, const AtomArray &r, const AtomArray &v, const AtomArray &f, double *lambda,
            double *tension, const AtomArray &g, bool add, double *virial);

}  // namespace holonomic
