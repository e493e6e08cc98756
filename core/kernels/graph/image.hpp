// The image of one bond.
#ifndef HOLONOMIC_KERNELS_GRAPH_IMAGE_HPP
#define HOLONOMIC_KERNELS_GRAPH_IMAGE_HPP

#include "core/kernels/arithmetic/image.hpp"
#include "core/kernels/graph/width.hpp"

namespace holonomic {
namespace HOL_ISA {
namespace graph {

// Minimum image of a bond vector; `lo` gets what the rounding of d leaves off.
template <bool careful, class V>
HOL_INLINE void take_image(const Box &box, Vector3<V> &d, Vector3<V> &lo) {
    if (box.shape != Box::none) wrap<careful>(box, d, lo);
}

template <int n, class V>
HOL_NOINLINE void take_images_of(const Box &box, Vector3<V> *d) {
    Vector3<V> unused = {};
    for (int k = 0; k < n; ++k) wrap<false>(box, d[k], unused);
}

// Minimum images of n bond vectors, which stay in registers where there is no box.
template <int n, class V>
HOL_INLINE void take_images(const Box &box, Vector3<V> *d) {
    if (__builtin_expect(box.shape == Box::none, 1)) return;
    Vector3<V> image[n];
    HOL_UNROLL
    for (int k = 0; k < n; ++k) image[k] = d[k];
    take_images_of<n>(box, image);
    HOL_UNROLL
    for (int k = 0; k < n; ++k) d[k] = image[k];
}

// The vector from one atom to another, unrounded: d + lo.
template <class V>
HOL_INLINE void exact_bond(const Box &box, const Vector3<V> &from, const Vector3<V> &to, Vector3<V> &d,
                           Vector3<V> &lo) {
    const Pair<V> x = two_difference<V>(to.x, from.x), y = two_difference<V>(to.y, from.y),
                  z = two_difference<V>(to.z, from.z);
    d = {x.hi, y.hi, z.hi};
    lo = {x.lo, y.lo, z.lo};
    take_image<true>(box, d, lo);
}

}  // namespace graph
}  // namespace HOL_ISA
}  // namespace holonomic
#endif
