// The image of one bond.
#pragma once

#include "core/kernels/arithmetic/image.hpp"
#include "core/kernels/arithmetic/width.hpp"

namespace holonomic::HOL_ISA::graph {

// Minimum image of a bond vector; `lo` gets what the rounding of d leaves off.
template <bool extended, class V>
HOL_INLINE void take_image(const Box &box, Vector3<V> &d, Vector3<V> &lo) {
    if (box.lattice != Box::none) wrap<extended>(box, d, lo);
}

template <int n, class V>
HOL_NOINLINE void take_images_of(const Box &box, Vector3<V> *d) {
    Vector3<V> unused = {};
    for (int k = 0; k < n; ++k) wrap<false>(box, d[k], unused);
}

// Minimum images of n bond vectors, which stay in registers where there is no box.
template <int n, class V>
HOL_INLINE void take_images(const Box &box, Vector3<V> *d) {
    if (__builtin_expect(box.lattice == Box::none, 1)) return;
    Vector3<V> image[n];
    HOL_UNROLL
    for (int k = 0; k < n; ++k) image[k] = d[k];
    take_images_of<n>(box, image);
    HOL_UNROLL
    for (int k = 0; k < n; ++k) d[k] = image[k];
}

}  // namespace holonomic::HOL_ISA::graph
