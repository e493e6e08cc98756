// Scratch memory of a thread.
#ifndef HOLONOMIC_KERNELS_MEMORY_ARENA_HPP
#define HOLONOMIC_KERNELS_MEMORY_ARENA_HPP

#include "core/kernels/isa/lanes.hpp"

namespace holonomic {
namespace HOL_ISA {

// Scratch memory handed out front to back.
struct Arena {
    double *next;
    vec *vecs(long n) {
        vec *p = reinterpret_cast<vec *>(next);
        next += n * W;
        return p;
    }
    double *doubles(long n) {
        double *p = next;
        constexpr long least = W > 8 ? W : 8;  // vectors that follow are aligned
        next += (n + least - 1) / least * least;
        return p;
    }
};

}  // namespace HOL_ISA
}  // namespace holonomic
#endif
