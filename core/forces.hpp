// Acceleration level: multipliers and constraint forces of all chains.
#pragma once

#include "core/molecules/chains.hpp"

namespace holonomic {

// `call`: with arrays, outputs and whether to add, the rest is filled in. It is made where the call comes from: a copy
// of arrays that have just been described waits for that. virial [9] or nullptr. Throws Error once everything that is
// due has been written.
void forces(const Chains &chains, ForcesCall &call, double *virial);

// d.(w_j f_j - w_i f_i) + |v_j - v_i + L d|^2, twice, of all bonds of active molecules without bodies; L [9].
void right_hand_sides(const Chains &chains, const Box &box, const double *L, const AtomArray &r, const AtomArray &v,
                      const AtomArray &f, double *rhs);

}  // namespace holonomic
