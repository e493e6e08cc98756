// Where the factors of a block of chains are kept: bond vectors, as lanes and as rows of what is in memory,
// multipliers, and reciprocals of pivots.
#pragma once

#include "core/kernels/eliminate/chain.hpp"

namespace holonomic::HOL_ISA::kept {

// Number of doubles of a block of n bonds. In front of the arrays: which lanes are kept, and how the block was read.
constexpr int64_t doubles(long n) { return W * (2 + 3 * (n + W) + (n + 1) + n); }
// And of one that is read in chunks.
constexpr int64_t doubles_with_rows(long n) { return doubles(n) + 3 * W * (n + W); }

HOL_INLINE bool is_small(const double *block) { return block[0] != 0; }  // as a block of memory/small.hpp
HOL_INLINE mask kept_lanes(const double *block) { return *reinterpret_cast<const mask *>(block + W); }
HOL_INLINE void set_head(double *block, bool small, mask lanes) {
    block[0] = small;
    *reinterpret_cast<mask *>(block + W) = lanes;
}

HOL_INLINE vec3 *bonds(const double *block) { return reinterpret_cast<vec3 *>(const_cast<double *>(block) + 2 * W); }
HOL_INLINE vec *multipliers(const double *block, long n) { return &bonds(block)->x + 3 * (n + W); }
HOL_INLINE vec *pivots(const double *block, long n) { return multipliers(block, n) + n + 1; }

// The bonds of chunk number c, 3 W rows.
HOL_INLINE vec *rows(const double *block, long n, long c) { return pivots(block, n) + n + 3 * W * c; }

// A system over a kept block, with right-hand sides elsewhere.
HOL_INLINE ChainSystem system(const double *block, long n, vec *t) {
    return ChainSystem(bonds(block), t, multipliers(block, n), pivots(block, n));
}

}  // namespace holonomic::HOL_ISA::kept
