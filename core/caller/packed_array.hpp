// A vector per atom in the caller's memory.
#pragma once

#include <cstdint>

#include "core/kernels/atom.hpp"

namespace holonomic {

// [n_atoms][3] doubles; absent if p is a null pointer: then nobody looks at the rest, and numbers are added, not
// pointers, so that there is no branch.
inline AtomArray packed_array(const double *p) {
    const std::uintptr_t x = reinterpret_cast<std::uintptr_t>(p);
    const auto component = [x](std::uintptr_t c) { return reinterpret_cast<char *>(x + c * sizeof(double)); };
    return {component(0), component(1), component(2), 3 * sizeof(double), false, true};
}

// The kernels read arrays in place only if all of a call are packed.
inline void unify_layout(AtomArray *const *arrays, int n) {
    bool packed = true;
    for (int i = 0; i < n; ++i) packed = packed & arrays[i]->packed;
    if (packed) return;
    packed = true;
    for (int i = 0; i < n; ++i) packed = packed && (arrays[i]->packed || !arrays[i]->x);
    for (int i = 0; i < n; ++i) arrays[i]->packed = packed;
}

}  // namespace holonomic
