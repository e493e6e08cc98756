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

// The inverse mass of an atom that also accelerates others, by bonds b, new ones D, which offer E: the inverse of
// mass^-1 + b (x) D / E. One rank after the other is as good where E is next to nothing, and where the atom is held
// fixed.
template <class V>
HOL_INLINE void load(Tensor<V> &mass, const V &E, const Vector3<V> &b, const Vector3<V> &D) {
    const Vector3<V> pushed = mass * b;
    const V f = Width<V>::all(-1) / (E + dot(D, pushed));
    const Vector3<V> by = add_times(add_times(D.x * mass.row[0], D.y, mass.row[1]), D.z, mass.row[2]);
    mass.row[0] = add_times(mass.row[0], f * pushed.x, by);
    mass.row[1] = add_times(mass.row[1], f * pushed.y, by);
    mass.row[2] = add_times(mass.row[2], f * pushed.z, by);
}

}  // namespace holonomic::HOL_ISA::graph
