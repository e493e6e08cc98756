// Which kernels the calculations use.
#pragma once

#include "core/kernels/call.hpp"

namespace holonomic {

struct KernelChoice {
    const Kernels &any;                 // for all but
    const Kernels &chains, &one_chain;  // chains that fit into lanes
};
KernelChoice choose_kernels();
inline const KernelChoice &kernel_choice() {
    static const KernelChoice found = choose_kernels();
    return found;
}

// The kernels of long chains and of molecules that are no chains, whatever the call: how these are cut, and so their
// digits, depends on the number of lanes. HOLONOMIC_ISA forces a set. Thread-safe.
inline const Kernels &kernels() { return kernel_choice().any; }

// The kernels of chains that fit into lanes: those, or a set that gives the same bits and is faster for such a unit, a
// chain that comes alone among them.
inline const Kernels &kernels_for_one_chain() { return kernel_choice().one_chain; }
inline const Kernels &kernels(const Unit &unit) {
    return unit.count == 1 ? kernel_choice().one_chain : kernel_choice().chains;
}

// The set that HOLONOMIC_ISA has chosen, or that of kernels().
const char *name_of_kernels();

// Scratch that either needs for chains of up to n_bonds bonds.
int64_t scratch_bytes(int64_t n_bonds);

}  // namespace holonomic
