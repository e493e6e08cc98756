// What is left of each constraint.
#pragma once

#include "core/molecules/chains.hpp"

namespace holonomic {

// Of each bond, [n_bonds] in the caller's order: (d.d - a^2) / a^2 and d.(v_j - v_i + L d), 0 without v; either may be
// nullptr. Throws Error once all molecules that give numbers are done.
void residuals(const Chains &chains, const AtomArray &r, const AtomArray &v, double *length, double *rate);

}  // namespace holonomic
