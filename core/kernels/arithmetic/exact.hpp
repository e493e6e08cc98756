// Arithmetic on unevaluated sums hi + lo of two doubles, for what cancels: dot products of nearly orthogonal and cross
// products of nearly parallel vectors. Valid for V = double and V = vec. Error-free transformations after Dekker (1971)
// and Knuth; see Ogita, Rump and Oishi, SIAM J. Sci. Comput. 26, 1955 (2005).
#pragma once

#include "core/kernels/arithmetic/thresholds.hpp"
#include "core/kernels/arithmetic/vector3.hpp"

namespace holonomic::HOL_ISA {

template <class V>
struct Pair {
    V hi, lo;
};

// a + b = hi + lo, exactly.
template <class V>
HOL_INLINE Pair<V> two_sum(V a, V b) {
    const V s = a + b, bb = s - a;
    return {s, (a - (s - bb)) + (b - bb)};
}

template <class V>
HOL_INLINE Pair<V> two_difference(V a, V b) {
    const V s = a - b, bb = s - a;
    return {s, (a - (s - bb)) - (b + bb)};
}

// a + b = hi + lo, exactly, if |a| >= |b|.
template <class V>
HOL_INLINE Pair<V> fast_two_sum(V a, V b) {
    const V s = a + b;
    return {s, b - (s - a)};
}

// What the rounded product p = a * b has lost.
#if HOL_HAS_FMA
template <class V>
HOL_INLINE V lost_of_product(V a, V b, V p) {
    return mul_add(a, b, -p);
}
#else
template <class V>
HOL_INLINE_UNLESS_SMALL V lost_of_product(V a, V b, V p) {
    const double split = 134217729.0;  // 2^27 + 1
    const V ca = split * a, ah = ca - (ca - a), al = a - ah;
    const V cb = split * b, bh = cb - (cb - b), bl = b - bh;
    return ((ah * bh - p) + ah * bl + al * bh) + al * bl;
}
#endif

// a * b = hi + lo, exactly, barring overflow and underflow.
template <class V>
HOL_INLINE Pair<V> two_product(V a, V b) {
    const V p = a * b;
    return {p, lost_of_product(a, b, p)};
}

// (a + a_lo) . (b + b_lo) as if in twice the precision, rounded once.
template <class V>
HOL_INLINE V dot_compensated(const Vector3<V> &a, const Vector3<V> &a_lo, const Vector3<V> &b, const Vector3<V> &b_lo) {
    const Pair<V> x = two_product(a.x, b.x), y = two_product(a.y, b.y), z = two_product(a.z, b.z);
    const Pair<V> s = two_sum(x.hi, y.hi), t = two_sum(s.hi, z.hi);
    return t.hi + ((t.lo + s.lo) + ((x.lo + y.lo) + z.lo) + (dot(a, b_lo) + dot(a_lo, b)));
}

// |a + a_lo|^2, in which nothing cancels: to a few roundings.
template <class V>
HOL_INLINE V square_of(const Vector3<V> &a, const Vector3<V> &a_lo) {
    const V half = dot(a, a_lo);
    return dot(a, a) + (half + half);
}

// As dot_compensated() (a + al) (b + bl) - (c + cl) (d + dl). With fused products after Kahan (Jeannerod, Louvet and
// Muller, Math. Comp. 82, 2245 (2013)).
template <class V>
HOL_INLINE V minor_compensated(V a, V al, V b, V bl, V c, V cl, V d, V dl) {
#if HOL_HAS_FMA
    const V p = c * d, lost = mul_add(-c, d, p);
    const V low = mul_add(a, bl, mul_add(al, b, mul_add(-c, dl, mul_add(-cl, d, lost))));
    return mul_add(a, b, -p) + low;
#else
    const Pair<V> p = two_product(a, b), q = two_product(c, d);
    const Pair<V> s = two_difference(p.hi, q.hi);
    const V low = mul_add(a, bl, al * b) - mul_add(c, dl, cl * d);
    return s.hi + (s.lo + (p.lo - q.lo) + low);
#endif
}

template <class V>
HOL_INLINE Vector3<V> cross_compensated(const Vector3<V> &a, const Vector3<V> &al, const Vector3<V> &b,
                                        const Vector3<V> &bl) {
    return {minor_compensated(a.y, al.y, b.z, bl.z, a.z, al.z, b.y, bl.y),
            minor_compensated(a.z, al.z, b.x, bl.x, a.x, al.x, b.z, bl.z),
            minor_compensated(a.x, al.x, b.y, bl.y, a.y, al.y, b.x, bl.x)};
}

// The sum of three numbers and their low words, as if in twice the precision.
template <class Three>
HOL_INLINE double sum_compensated(const Three &hi, const Three &lo) {
    const Pair<double> s = two_sum<double>(hi[0], hi[1]), t = two_sum<double>(s.hi, hi[2]);
    return t.hi + ((t.lo + s.lo) + ((lo[0] + lo[1]) + lo[2]));
}

}  // namespace holonomic::HOL_ISA
