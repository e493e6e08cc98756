// The shortest image of a bond in a periodic box.
#pragma once

#include "core/kernels/arithmetic/exact.hpp"
#include "core/kernels/call.hpp"

namespace holonomic::HOL_ISA {

// Minimum image of bond vectors, of all lanes or of one; `lo` gets what d's rounding left off.
template <bool extended, class V>
HOL_INLINE void wrap(const Box &box, Vector3<V> &d, Vector3<V> &lo) {
    const double *h = box.h, *in = box.inverse;
    if (!extended && box.lattice == Box::orthorhombic) {
        const double *const per_side = box.per_side, *const minus_side = box.minus_side;
        d.x = mul_add(round(d.x * per_side[0]), V{} + minus_side[0], d.x);
        d.y = mul_add(round(d.y * per_side[1]), V{} + minus_side[1], d.y);
        d.z = mul_add(round(d.z * per_side[2]), V{} + minus_side[2], d.z);
        return;
    }
    const V n[3] = {round(d.x * in[0] + d.y * in[3] + d.z * in[6]), round(d.x * in[1] + d.y * in[4] + d.z * in[7]),
                    round(d.x * in[2] + d.y * in[5] + d.z * in[8])};
    V *component[3] = {&d.x, &d.y, &d.z}, *low[3] = {&lo.x, &lo.y, &lo.z};
    HOL_UNROLL
    for (int c = 0; c < 3; ++c) {
        HOL_UNROLL
        for (int i = 0; i < 3; ++i) {
            const V side = V{} + h[3 * i + c];
            if (extended) {
                const Pair<V> p = two_product<V>(n[i], side);
                const Pair<V> s = two_difference<V>(*component[c], p.hi);
                const Pair<V> t = fast_two_sum<V>(s.hi, s.lo - p.lo + *low[c]);
                *component[c] = t.hi;
                *low[c] = t.lo;
            } else {
                *component[c] = mul_add(n[i], -side, *component[c]);
            }
        }
    }
}

// Out of line and by value: what it is made of stays in registers where there is no such box.
HOL_NOINLINE Vector3<vec> triclinic_image(const Box &box, Vector3<vec> d) {
    Vector3<vec> unused = {};
    wrap<false>(box, d, unused);
    return d;
}

// The vector from one atom to another.
HOL_INLINE Vector3<double> bond_vector(const Box &box, const double *from, const double *to) {
    Vector3<double> d = {to[0] - from[0], to[1] - from[1], to[2] - from[2]}, unused = {};
    if (box.lattice != Box::none) wrap<false>(box, d, unused);
    return d;
}

// The same, unrounded: d + lo. Of all lanes or of one.
template <class V>
HOL_INLINE void unrounded_bond(const Box &box, const Vector3<V> &from, const Vector3<V> &to, Vector3<V> &d,
                               Vector3<V> &lo) {
    const Pair<V> x = two_difference<V>(to.x, from.x), y = two_difference<V>(to.y, from.y),
                  z = two_difference<V>(to.z, from.z);
    d = {x.hi, y.hi, z.hi};
    lo = {x.lo, y.lo, z.lo};
    if (box.lattice != Box::none) wrap<true>(box, d, lo);
}
HOL_INLINE void unrounded_bond(const Box &box, const double *from, const double *to, Vector3<double> &d,
                               Vector3<double> &lo) {
    unrounded_bond(box, Vector3<double>{from[0], from[1], from[2]}, Vector3<double>{to[0], to[1], to[2]}, d, lo);
}

#if HOL_LANES == 4 || HOL_FOURS
// From the coordinates of the two atoms: x, y and z at once.
#if HOL_FOURS
typedef four components;
#else
typedef vec components;
#endif
HOL_INLINE Pair<components> unrounded_bond(const Box &box, components from, components to) {
    Pair<components> d = two_difference<components>(to, from);
    if (box.lattice == Box::none) return d;
    const double *const h = box.h, *const in = box.inverse;
    const auto fold = [&](components n, components side) HOL_FORCED {
        const Pair<components> p = two_product<components>(n, side), s = two_difference<components>(d.hi, p.hi);
        d = fast_two_sum<components>(s.hi, s.lo - p.lo + d.lo);
    };
    if (box.lattice == Box::orthorhombic) {
        fold(round(d.hi * components{in[0], in[4], in[8], 0}), components{h[0], h[4], h[8], 0});
        return d;
    }
    const components n =
        round(d.hi[0] * components{in[0], in[1], in[2], 0} + d.hi[1] * components{in[3], in[4], in[5], 0} +
              d.hi[2] * components{in[6], in[7], in[8], 0});
    for (int i = 0; i < 3; ++i) fold(n[i] - components{}, components{h[3 * i], h[3 * i + 1], h[3 * i + 2], 0});
    return d;
}
#endif

}  // namespace holonomic::HOL_ISA
