// One atom in the caller's memory, for what is not done in lanes. Internal linkage: the kernels of every instruction
// set have it, too.
#pragma once

#include "core/kernels/call.hpp"

namespace holonomic {

// The caller's number of an atom of a chain or of a molecule.
template <class AnyLane>
static inline int64_t atom_of(const AnyLane &lane, int64_t i) {
    return lane.atoms ? lane.atoms[i] : lane.first_atom + i;
}

// x [3]; a component that the array does not have is 0.
static inline void read_atom(const AtomArray &array, int64_t atom, double *x) {
    if (array.packed && array.x) {
        const double *const from = reinterpret_cast<const double *>(array.x) + 3 * atom;
        for (int c = 0; c < 3; ++c) x[c] = from[c];
        return;
    }
    const char *const components[3] = {array.x, array.y, array.z};
    for (int c = 0; c < 3; ++c) {
        const char *p = components[c];
        if (p) p += atom * array.stride;
        x[c] = !p               ? 0
               : array.is_float ? static_cast<double>(*reinterpret_cast<const float *>(p))
                                : *reinterpret_cast<const double *>(p);
    }
}

static inline void write_atom(const AtomArray &array, int64_t atom, const double *x) {
    if (array.packed) {
        double *const to = reinterpret_cast<double *>(array.x) + 3 * atom;
        for (int c = 0; c < 3; ++c) to[c] = x[c];
        return;
    }
    char *const components[3] = {array.x, array.y, array.z};
    for (int c = 0; c < 3; ++c) {
        char *p = components[c];
        if (!p) continue;
        p += atom * array.stride;
        if (array.is_float)
            *reinterpret_cast<float *>(p) = static_cast<float>(x[c]);
        else
            *reinterpret_cast<double *>(p) = x[c];
    }
}

}  // namespace holonomic
