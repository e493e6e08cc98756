// How far positions and velocities are from the constraints.
#ifndef HOLONOMIC_VIOLATION_HPP
#define HOLONOMIC_VIOLATION_HPP

#include "core/molecules/chains.hpp"

struct hol_worst;

namespace holonomic {

void violation(const Chains &chains, const AtomArray &r, const AtomArray &v, hol_worst *worst);

}  // namespace holonomic
#endif
