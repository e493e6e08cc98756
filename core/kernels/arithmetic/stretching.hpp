// Bonds in a box that changes.
#ifndef HOLONOMIC_KERNELS_ARITHMETIC_STRETCHING_HPP
#define HOLONOMIC_KERNELS_ARITHMETIC_STRETCHING_HPP

#include "core/kernels/arithmetic/vector3.hpp"

namespace holonomic {
namespace HOL_ISA {

// d.(L d), which depends on the sums of mirrored elements of L alone: s has xx xy xz yy yz zz.
template <class V>
HOL_INLINE V stretching(const double *s, const Vector3<V> &d) {
    return d.x * (s[0] * d.x + s[1] * d.y + s[2] * d.z) + (d.y * (s[3] * d.y + s[4] * d.z) + d.z * (s[5] * d.z));
}

}  // namespace HOL_ISA
}  // namespace holonomic
#endif
