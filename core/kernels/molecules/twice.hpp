// Vectors in twice the precision, for what multipliers leave of the equations: the accelerations a = w (f + G) and
// then, per bond, d.(a_j - a_i) + c, which vanishes at the exact solution. Refinement against it mends what L D L^T
// loses.
#pragma once

#include "core/kernels/arithmetic/exact.hpp"

namespace holonomic::HOL_ISA::graph {

// Adds up low words as they come. High words stay right to a rounding, and a sum of few terms needs no more.
template <class V>
HOL_INLINE Pair<V> add_pairs(const Pair<V> &a, const Pair<V> &b) {
    const Pair<V> s = two_sum<V>(a.hi, b.hi);
    return {s.hi, s.lo + (a.lo + b.lo)};
}
template <class V>
HOL_INLINE Pair<V> subtract_pairs(const Pair<V> &a, const Pair<V> &b) {
    const Pair<V> s = two_difference<V>(a.hi, b.hi);
    return {s.hi, s.lo + (a.lo - b.lo)};
}
template <class V>
HOL_INLINE Pair<V> multiply_pairs(const Pair<V> &a, const Pair<V> &b) {
    const Pair<V> p = two_product<V>(a.hi, b.hi);
    return {p.hi, mul_add(a.hi, b.lo, mul_add(a.lo, b.hi, p.lo))};
}
template <class V>
HOL_INLINE Pair<V> scale_pair(const V &s, const Pair<V> &a) {
    const Pair<V> p = two_product<V>(s, a.hi);
    return {p.hi, mul_add(s, a.lo, p.lo)};
}

template <class V>
struct Pair3 {
    Pair<V> x, y, z;
};

template <class V>
HOL_INLINE Vector3<V> absolute(const Vector3<V> &a) {
    return {abs(a.x), abs(a.y), abs(a.z)};
}
template <class V>
HOL_INLINE Pair3<V> pairs_of(const Vector3<V> &hi, const Vector3<V> &lo) {
    return {{hi.x, lo.x}, {hi.y, lo.y}, {hi.z, lo.z}};
}
template <class V>
HOL_INLINE Pair3<V> add_pairs(const Pair3<V> &a, const Pair3<V> &b) {
    return {add_pairs(a.x, b.x), add_pairs(a.y, b.y), add_pairs(a.z, b.z)};
}
template <class V>
HOL_INLINE Pair3<V> subtract_pairs(const Pair3<V> &a, const Pair3<V> &b) {
    return {subtract_pairs(a.x, b.x), subtract_pairs(a.y, b.y), subtract_pairs(a.z, b.z)};
}
template <class V>
HOL_INLINE Pair3<V> scale_pairs(const V &s, const Pair3<V> &a) {
    return {scale_pair(s, a.x), scale_pair(s, a.y), scale_pair(s, a.z)};
}
template <class V>
HOL_INLINE Pair3<V> product_pairs(const V &s, const Vector3<V> &a) {
    return {two_product<V>(s, a.x), two_product<V>(s, a.y), two_product<V>(s, a.z)};
}
template <class V>
HOL_INLINE Vector3<V> rounded(const Pair3<V> &a) {
    return {a.x.hi + a.x.lo, a.y.hi + a.y.lo, a.z.hi + a.z.lo};
}
template <class V>
HOL_INLINE Pair<V> dot_pairs(const Pair3<V> &a, const Pair3<V> &b) {
    return add_pairs(multiply_pairs(a.x, b.x), add_pairs(multiply_pairs(a.y, b.y), multiply_pairs(a.z, b.z)));
}
template <class V>
HOL_INLINE Pair3<V> difference_of(const Vector3<V> &from, const Vector3<V> &to) {
    return {two_difference<V>(to.x, from.x), two_difference<V>(to.y, from.y), two_difference<V>(to.z, from.z)};
}

}  // namespace holonomic::HOL_ISA::graph
