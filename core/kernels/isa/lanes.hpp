// Lanes: W doubles that are worked on at once, with one chain, or one piece of a chain, in each.
#ifndef HOLONOMIC_KERNELS_ISA_LANES_HPP
#define HOLONOMIC_KERNELS_ISA_LANES_HPP

#include "core/kernels/isa/avx.hpp"
#include "core/kernels/isa/generic.hpp"
#include "core/kernels/isa/transpose.hpp"
#include "core/kernels/isa/vector.hpp"

namespace holonomic::HOL_ISA {

// The sign bits of a mask tell.
HOL_INLINE bool any(mask m) { return bits(m) != 0; }
HOL_INLINE mask finite(vec a) { return equal(a - a, vec{}); }
HOL_INLINE mask none() { return mask{}; }
HOL_INLINE mask first_lanes(int n) {
    mask m{};
    for (int i = 0; i < W; ++i) m[i] = i < n ? -1 : 0;
    return m;
}
HOL_INLINE double sum_lanes(vec a) {  // in the order of the lanes
    double s = a[0];
    for (int i = 1; i < W; ++i) s += a[i];
    return s;
}

constexpr unsigned all_lanes = (1u << W) - 1;  // bits() of a mask with all lanes set

}  // namespace holonomic::HOL_ISA
#endif
