// Finds what a solution leaves of the equations of a whole molecule, in twice the precision: the accelerations
// a = w (f + G) and then, per bond, d.(a_j - a_i) + c, which vanishes at the exact solution. Refinement against it
// mends what LDL^T of a core loses.
#pragma once

#include "core/kernels/molecules/molecules.hpp"

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
HOL_INLINE Pair<V> dot_pairs(const Pair3<V> &a, const Pair3<V> &b) {
    return add_pairs(multiply_pairs(a.x, b.x), add_pairs(multiply_pairs(a.y, b.y), multiply_pairs(a.z, b.z)));
}
template <class V>
HOL_INLINE Pair3<V> difference_of(const Vector3<V> &from, const Vector3<V> &to) {
    return {two_difference<V>(to.x, from.x), two_difference<V>(to.y, from.y), two_difference<V>(to.z, from.z)};
}

// What the right-hand sides are made of, kept for residuals: per atom by slot, per bond by place; or nullptr.
template <class V>
struct Equations {
    Vector3<V> *r;         // coordinates
    Vector3<V> *velocity;  // c = |v_j - v_i|^2
    Vector3<V> *force;     // a = w (force + G)
    Vector3<V> *start;     // a = start + w G
    V *given;              // c = given
    Pair3<V> *a;           // [n_atoms] working memory
    Pair3<V> *d;           // [n_bonds] unrounded bonds

    // The velocity or acceleration of an atom of inverse mass w, but for G.
    HOL_FORCED Vector3<V> input_of(int32_t slot, const V &w) const {
        Vector3<V> input = {};
        if (start) input = start[slot];
        if (force) input = input + w * force[slot];
        return input;
    }
};

// Finds the unrounded bonds, once for all residuals.
template <class V>
HOL_INLINE void find_unrounded(const Molecules<V> &x, const Equations<V> &e) {
    for (int32_t k = 0; k < x.s.n_bonds; ++k) {
        int32_t from, to;
        ends_of(x.s, k, from, to);
        Vector3<V> d, lo;
        unrounded_bond(*x.box, e.r[from], e.r[to], d, lo);
        e.d[k] = pairs_of(d, lo);
    }
}

// The residual of the bond at place k, from the accelerations of the atoms in the slots of its ends.
template <class V>
HOL_INLINE V residual_of(const Molecules<V> &x, const Equations<V> &e, int32_t k, int32_t from, int32_t to,
                         const Pair3<V> &a_from, const Pair3<V> &a_to) {
    Pair<V> sum = dot_pairs(e.d[k], subtract_pairs(a_to, a_from));
    if (e.velocity) {
        const Pair3<V> dv = difference_of(e.velocity[from], e.velocity[to]);
        sum = add_pairs(sum, dot_pairs(dv, dv));
    }
    if (e.given) sum = add_pairs(sum, {e.given[k], V{}});
    if (x.in.strain) sum = add_pairs(sum, {stretching(x.in.strain, x.row[k].d), V{}});
    return sum.hi + sum.lo;
}

// Puts the residuals into t of the rows. The solution is t[place].
template <class V>
HOL_NOINLINE void find_residuals(const Molecules<V> &x, const Equations<V> &e, const V *t) {
    const Schedule &s = x.s;
    const Vector3<V> zero = {};
    for (int32_t i = 0; i < s.n_atoms; ++i) e.a[i] = pairs_of(e.force ? e.force[i] : zero, zero);
    for (int32_t k = 0; k < s.n_bonds; ++k) {
        int32_t from, to;
        ends_of(s, k, from, to);
        const Pair3<V> pull = scale_pairs(t[k], e.d[k]);
        e.a[from] = add_pairs(e.a[from], pull);
        e.a[to] = subtract_pairs(e.a[to], pull);
    }
    for (int32_t i = 0; i < s.n_atoms; ++i) {
        e.a[i] = scale_pairs(x.w[i], e.a[i]);
        if (e.start) e.a[i] = add_pairs(e.a[i], pairs_of(e.start[i], zero));
    }
    for (int32_t k = 0; k < s.n_bonds; ++k) {
        int32_t from, to;
        ends_of(s, k, from, to);
        x.row[k].t = residual_of(x, e, k, from, to, e.a[from], e.a[to]);
    }
}

}  // namespace holonomic::HOL_ISA::graph
