// Goes through the molecules of a set with the kernels that keep factors, or solve with them.
#pragma once

#include "core/molecules/chains.hpp"

namespace holonomic {

// What keep() marks molecules with: 1, or this where they are left of forces alone.
constexpr unsigned char left_of_forces = 2;

// Both mark the molecules that are left to the ordinary verbs. Throw std::bad_alloc before any work is done.
void keep(const Chains &chains, const KeepCall &call);
// n calls, unit by unit; more than one only of sets whose plan copies nothing.
Tally solve_kept(const Chains &chains, const KeptCall *calls, int n);

}  // namespace holonomic
