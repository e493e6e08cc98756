// An atom with many children. What they and the atom itself offer is one matrix of three rows and columns (theory
// (53b), (53c)), a sum in which nothing is subtracted, so that k of them cost O(k):
//
//     M = 1 + w sum_c d_c d_c^T / E_c,   N = M^-1,   E_e = w d_e^T N d_e,
//     l_c = w d_c^T N d_e / E_c,   u_c = (y_c - d_c.a) / E_c,   a = w N sum_c d_c y_c / E_c
//
// It does where M is well conditioned, and where no child is held by the atom alone: where of each d_c^T (w N / E_c)
// d_c, which S^-1 subtracts from 1, enough is missing. `margin` is negative where it does not.
#pragma once

#include "core/kernels/arithmetic/matrix3.hpp"
#include "core/kernels/arithmetic/thresholds.hpp"
#include "core/kernels/molecules/molecules.hpp"

namespace holonomic::HOL_ISA::graph {

// What is kept of such an atom: w N, then what siblings.hpp needs.
enum KeptOfMany { of_pulls = 6, of_rounding = 7 };

template <class V>
HOL_INLINE Matrix3<V> kept_matrix(const V *kept) {
    return {{kept[0], kept[1], kept[2]}, {kept[1], kept[3], kept[4]}, {kept[2], kept[4], kept[5]}};
}

// What up_joint() does.
template <class V, class Rows>
HOL_INLINE void up_many(const Rows &x, int k, double least_part, V &margin) {
    const V w = x.w(), one = Width<V>::all(1);
    Matrix3<V> M = Matrix3<V>::one();
    Vector3<V> sum = {};
    V pulls2 = {};
    for (int a = 0; a < k; ++a) {
        BondRow<V> &row = x.bond(a);
        row.r = one / row.E;
        const V u = row.t * row.r;
        M.add((w * row.r) * row.d, row.d);
        sum = add_times(sum, u, row.d);
        pulls2 = mul_add(row.q, u * u, pulls2);
    }
    V *const kept = x.multipliers();
    const Matrix3<V> whole = divided_by(M, w);
    const V part[6] = {whole.x.x, whole.x.y, whole.x.z, whole.y.y, whole.y.z, whole.z.z};
    for (int i = 0; i < 6; ++i) kept[i] = part[i];
    const Matrix3<V> B = kept_matrix(kept);
    const V size = B.trace(), uneven = M.trace() * (size / w),
            bound = size * (uneven * Width<V>::all(1 / least_uneven));
    V least = min(Width<V>::all(most_uneven) - uneven, uneven - Width<V>::all(least_uneven - 1));
    kept[of_pulls] = pulls2;
    kept[of_rounding] = bound * bound;

    BondRow<V> &e = x.above();
    const Vector3<V> a0 = B * sum, along = B * e.d;
    V y = e.t;
    for (int a = 0; a < k; ++a) {
        BondRow<V> &row = x.bond(a);
        const V left = mul_add(-row.r, dot(row.d, B * row.d), one);
        least = min(left - Width<V>::all(least_part), least);
        row.l = row.r * dot(row.d, along);
        y = mul_add(row.l, row.t, y);
        row.E = row.t * (row.r * left);  // what siblings.hpp compares with
        row.t = row.r * (row.t - dot(row.d, a0));
    }
    margin = min(least, margin);
    e.E = dot(e.d, along);
    e.t = y;
}

// What substitute_joint() does.
template <class V, class Rows>
HOL_INLINE void substitute_many(const Rows &x, int k) {
    Vector3<V> sum = {};
    V y = x.above().t;
    for (int a = 0; a < k; ++a) {
        const BondRow<V> &row = x.bond(a);
        sum = add_times(sum, row.t * row.r, row.d);
        y = mul_add(row.l, row.t, y);
    }
    const Vector3<V> a0 = kept_matrix(x.multipliers()) * sum;
    for (int a = 0; a < k; ++a) {
        BondRow<V> &row = x.bond(a);
        row.t = row.r * (row.t - dot(row.d, a0));
    }
    x.above().t = y;
}

}  // namespace holonomic::HOL_ISA::graph
