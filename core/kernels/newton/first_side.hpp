// The right-hand side of the first of few solves for positions.
#pragma once

#include "core/kernels/arithmetic/vector3.hpp"

namespace holonomic::HOL_ISA {

// 2 |D| (|D| - a) to the third order of sigma = D.D - a^2, which would take its place in Newton's method: a bond that
// goes straight back to its length gets there at once, and the others leave the square of what they turn.
template <class V>
HOL_INLINE V first_side(V sigma, V per_a2) {
    const V s = sigma * per_a2;
    return mul_add(sigma, s * (s * -0.125 + 0.25), sigma);
}

}  // namespace holonomic::HOL_ISA
