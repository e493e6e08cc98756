// Positions that lie anywhere are moved onto the constraints.
#pragma once

#include "core/positions.hpp"

namespace holonomic {

// A damped Newton's method, each step along the bonds as they are then; molecules with rigid bodies are projected along
// what they are. Throws Error once everything that is due has been written; molecules that fail stay as they were.
void impose(const Chains &chains, const AtomArray &r, Report *report);

}  // namespace holonomic
