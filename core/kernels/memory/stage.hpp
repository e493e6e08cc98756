// Copies of atoms that are not packed: into scratch, and back.
#pragma once

#include <stdint.h>

#include "core/kernels/memory/block.hpp"

namespace holonomic::HOL_ISA {

HOL_INLINE long staged_size(long n_bonds) { return (3 * (n_bonds + 1) + 7) / 8 * 8; }

// Copies atoms `from` .. `from + n` of a chain into packed[n+1][3].
void stage(const AtomArray &, const Lane &, long from, long n, double *packed);

// Copies them back, or adds them.
void unstage(const AtomArray &, const Lane &, long from, long n, const double *packed, bool add);

HOL_INLINE bool in_place(const AtomArray &array, const Lane &lane) { return array.packed && !lane.atoms; }

// Where lane i of the block finds its vectors: in place, or staged from atom `from` on.
HOL_INLINE void open_lane(const AtomArray &array, const Lane &lane, long from, long n, long n_max, Packed &packed,
                          int i, double *staging, bool read) {
    if (in_place(array, lane)) {
        packed.lane[i] = reinterpret_cast<double *>(array.x) + 3 * (lane.first_atom + from);
    } else {
        packed.lane[i] = staging + i * staged_size(n_max);
        if (read) stage(array, lane, from, n, packed.lane[i]);
    }
}

// The lanes past the last one in use repeat the first.
HOL_INLINE void repeat_first(Packed &packed, int lanes) {
    for (int i = lanes; i < W; ++i) packed.lane[i] = packed.lane[0];
}

}  // namespace holonomic::HOL_ISA
