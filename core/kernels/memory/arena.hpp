// Scratch memory of a thread.
#pragma once

#include <stdint.h>

#include "core/kernels/isa/lanes.hpp"

namespace holonomic::HOL_ISA {

// Vectors per bond that the largest kernel needs. This is positions of staged chains with unequal masses and lengths:
// three arrays (9), masses (4), lengths (2), Newton's method (12), a copy to go back to after a coarse move (4).
constexpr int64_t vectors_per_bond = 32;

// Doubles for a block of chains of at most n bonds. Arrays may end with a whole chunk, or a whole cache line.
constexpr int64_t scratch_doubles(int64_t n) { return W * vectors_per_bond * (n + 2 * W + 8); }

// Hands out scratch memory from front to back. Builds with assertions or sanitizers stop if there is too little.
struct Arena {
    double *next;
    const double *end;
    Arena(double *scratch, const double *behind) : next(scratch), end(behind) {}
    Arena(double *scratch, int64_t n_bonds) : Arena(scratch, scratch + scratch_doubles(n_bonds)) {}
    vec *vecs(long n) { return reinterpret_cast<vec *>(take(n * W)); }
    double *doubles(long n) {
        constexpr long least = W > 8 ? W : 8;  // vectors that follow are aligned
        return take((n + least - 1) / least * least);
    }

private:
    HOL_FORCED double *take(long n) {
        double *const p = next;
        next += n;
#if defined(HOL_SANITIZED) || !defined(NDEBUG)
        if (next > end) __builtin_trap();
#endif
        return p;
    }
};

}  // namespace holonomic::HOL_ISA
