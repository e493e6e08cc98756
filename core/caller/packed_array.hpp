// A vector per atom in the caller's memory.
#pragma once

#include "core/kernels/atom.hpp"

namespace holonomic {

// [n_atoms][3] doubles; absent if p is a null pointer.
inline AtomArray packed_array(const double *p) {
    if (!p) return AtomArray{};
    char *const x = const_cast<char *>(reinterpret_cast<const char *>(p));
    return {x, x + sizeof(double), x + 2 * sizeof(double), 3 * sizeof(double), false, true};
}

// The kernels read arrays in place only if all of a call are packed.
inline void unify_layout(AtomArray *const *arrays, int n) {
    bool packed = true;
    for (int i = 0; i < n; ++i) packed = packed && (arrays[i]->packed || !arrays[i]->x);
    for (int i = 0; i < n; ++i) arrays[i]->packed = packed;
}

}  // namespace holonomic
