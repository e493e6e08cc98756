// Velocity level: the exact projection onto the constraints.
#pragma once

#include "core/molecules/chains.hpp"

namespace holonomic {

// `call`: with arrays and outputs, the rest is filled in (core/forces.hpp). virial [9] or nullptr. Throws Error once
// everything that is due has been written.
void project_velocities(const Chains &chains, VelocitiesCall &call, double *virial);

}  // namespace holonomic
