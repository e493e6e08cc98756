// Velocity level: the exact projection onto the constraints.
#pragma once

#include "core/molecules/chains.hpp"

namespace holonomic {

// virial [9] or nullptr. Throws Error once everything that is due has been written.
void project_velocities(const Chains &chains, const AtomArray &r, const AtomArray &v, double *lambda, double *virial);

}  // namespace holonomic
