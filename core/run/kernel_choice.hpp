// Which kernels the calculations use.
#pragma once

#include "core/kernels/call.hpp"

namespace holonomic {

// The kernels of long chains and of molecules that are no chains, whatever the call: how these are cut, and so their
// digits, depends on the number of lanes. HOLONOMIC_ISA forces a set. Thread-safe.
const Kernels &kernels();

// The kernels of chains that fit into lanes: those, or a set that gives the same bits and is faster for such a unit, a
// chain that comes alone among them.
const Kernels &kernels(const Unit &unit);
const Kernels &kernels_for_one_chain();

// The set that HOLONOMIC_ISA has chosen, or that of kernels().
const char *name_of_kernels();

// Scratch that either needs for chains of up to n_bonds bonds.
int64_t scratch_bytes(int64_t n_bonds);

}  // namespace holonomic
