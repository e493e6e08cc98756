// Matrices of three rows and columns: what trees and strands leave of an atom's inverse mass.
#pragma once

#include "core/kernels/arithmetic/vector3.hpp"
#include "core/kernels/arithmetic/width.hpp"

namespace holonomic::HOL_ISA::graph {

template <class V>
struct Tensor {
    Vector3<V> row[3];
};

HOL_INLINE Tensor<double> diagonal_tensor(double a) { return {{{a, 0, 0}, {0, a, 0}, {0, 0, a}}}; }

template <class V>
HOL_INLINE Vector3<V> operator*(const Tensor<V> &a, const Vector3<V> &b) {
    return {dot(a.row[0], b), dot(a.row[1], b), dot(a.row[2], b)};
}
// a^T B
template <class V>
HOL_INLINE Vector3<V> operator*(const Vector3<V> &a, const Tensor<V> &b) {
    return add_times(add_times(a.x * b.row[0], a.y, b.row[1]), a.z, b.row[2]);
}

// An inverse mass is lower * upper. These are each other's transposes if it is symmetric.
template <class V>
struct TensorFactors {
    Tensor<V> lower, upper;
};
HOL_STATIC TensorFactors<double> factors_of(const Tensor<double> &mass) {
    TensorFactors<double> f = {};
    double a[3][3], l[3][3] = {}, u[3][3] = {};
    for (int i = 0; i < 3; ++i) a[i][0] = mass.row[i].x, a[i][1] = mass.row[i].y, a[i][2] = mass.row[i].z;
    for (int k = 0; k < 3; ++k) {
        const double root = a[k][k] > 0 ? sqrt(a[k][k]) : 0, per = root > 0 ? 1 / root : 0;
        for (int i = k; i < 3; ++i) l[i][k] = a[i][k] * per, u[k][i] = a[k][i] * per;
        for (int i = k + 1; i < 3; ++i)
            for (int j = k + 1; j < 3; ++j) a[i][j] -= l[i][k] * u[k][j];
    }
    for (int i = 0; i < 3; ++i) {
        f.lower.row[i] = {l[i][0], l[i][1], l[i][2]};
        f.upper.row[i] = {u[i][0], u[i][1], u[i][2]};
    }
    return f;
}

// The inverse mass of an atom that also accelerates others, by bonds b, new ones D, which offer E: the inverse of
// mass^-1 + b (x) D / E. One rank after the other is as good where E is next to nothing, and where the atom is held
// fixed.
template <class V>
HOL_INLINE void add_offer(Tensor<V> &mass, const V &E, const Vector3<V> &b, const Vector3<V> &D) {
    const Vector3<V> pushed = mass * b;
    const V f = Width<V>::all(-1) / (E + dot(D, pushed));
    const Vector3<V> by = add_times(add_times(D.x * mass.row[0], D.y, mass.row[1]), D.z, mass.row[2]);
    mass.row[0] = add_times(mass.row[0], f * pushed.x, by);
    mass.row[1] = add_times(mass.row[1], f * pushed.y, by);
    mass.row[2] = add_times(mass.row[2], f * pushed.z, by);
}

}  // namespace holonomic::HOL_ISA::graph
