// Vectors in space, of doubles or of lanes.
#pragma once

#include "core/kernels/isa/lanes.hpp"

namespace holonomic::HOL_ISA {

template <class V>
struct Vector3 {
    V x, y, z;
};

template <class V>
HOL_INLINE V dot(const Vector3<V> &a, const Vector3<V> &b) {
    return mul_add(a.z, b.z, mul_add(a.y, b.y, a.x * b.x));
}

template <class V>
HOL_INLINE Vector3<V> cross(const Vector3<V> &a, const Vector3<V> &b) {
    return {mul_add(a.y, b.z, -(a.z * b.y)), mul_add(a.z, b.x, -(a.x * b.z)), mul_add(a.x, b.y, -(a.y * b.x))};
}

template <class V>
HOL_INLINE Vector3<V> operator+(const Vector3<V> &a, const Vector3<V> &b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class V>
HOL_INLINE Vector3<V> operator-(const Vector3<V> &a, const Vector3<V> &b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class V>
HOL_INLINE Vector3<V> operator*(V s, const Vector3<V> &a) {
    return {s * a.x, s * a.y, s * a.z};
}
// c + s a and c - s a
// s a - t b
template <class V>
HOL_INLINE Vector3<V> difference(V s, const Vector3<V> &a, V t, const Vector3<V> &b) {
    return {mul_add(s, a.x, -(t * b.x)), mul_add(s, a.y, -(t * b.y)), mul_add(s, a.z, -(t * b.z))};
}
template <class V>
HOL_INLINE Vector3<V> add_times(const Vector3<V> &c, V s, const Vector3<V> &a) {
    return {mul_add(s, a.x, c.x), mul_add(s, a.y, c.y), mul_add(s, a.z, c.z)};
}

// d.d - a2
template <class V>
HOL_INLINE V excess(const Vector3<V> &d, V a2) {
    return mul_add(d.z, d.z, mul_add(d.y, d.y, mul_add(d.x, d.x, -a2)));
}

typedef Vector3<vec> vec3;

// d.(L d), which depends on the sums of mirrored elements of L alone: s has xx xy xz yy yz zz.
template <class V>
HOL_INLINE V stretching(const double *s, const Vector3<V> &d) {
    return d.x * (s[0] * d.x + s[1] * d.y + s[2] * d.z) + (d.y * (s[3] * d.y + s[4] * d.z) + d.z * (s[5] * d.z));
}

}  // namespace holonomic::HOL_ISA
