// A vector per atom in the caller's memory.
#ifndef HOLONOMIC_VIEW_HPP
#define HOLONOMIC_VIEW_HPP

#include <cstdint>

#include "core/kernels/call.hpp"

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

inline void read_atom(const AtomArray &array, std::int64_t atom, double *x) {
    const char *const components[3] = {array.x, array.y, array.z};
    for (int c = 0; c < 3; ++c) {
        const char *p = components[c];
        if (p) p += atom * array.stride;
        x[c] = !p               ? 0
               : array.is_float ? static_cast<double>(*reinterpret_cast<const float *>(p))
                                : *reinterpret_cast<const double *>(p);
    }
}

inline void write_atom(const AtomArray &array, std::int64_t atom, const double *x) {
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
#endif
