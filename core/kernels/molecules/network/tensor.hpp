// Matrices of three rows and columns: what trees and strands leave of an atom's inverse mass.
#ifndef HOLONOMIC_KERNELS_MOLECULES_NETWORK_TENSOR_HPP
#define HOLONOMIC_KERNELS_MOLECULES_NETWORK_TENSOR_HPP

#include "core/kernels/arithmetic/vector3.hpp"

namespace holonomic {
namespace HOL_ISA {
namespace graph {

struct Tensor {
    Vector3<double> row[3];
};

HOL_INLINE Tensor diagonal_tensor(double a) { return {{{a, 0, 0}, {0, a, 0}, {0, 0, a}}}; }

HOL_INLINE Vector3<double> operator*(const Tensor &a, const Vector3<double> &b) {
    return {dot(a.row[0], b), dot(a.row[1], b), dot(a.row[2], b)};
}

// The inverse mass of an atom that also accelerates others, by bonds b, new ones D, which offer E: the inverse of
// mass^-1 + b (x) D / E. One rank after the other is as good where E is next to nothing, and where the atom is held
// fixed.
HOL_INLINE void load(Tensor &mass, double E, const Vector3<double> &b, const Vector3<double> &D) {
    const Vector3<double> pushed = mass * b;
    const double f = -1 / (E + dot(D, pushed));
    const Vector3<double> by = add_times(add_times(D.x * mass.row[0], D.y, mass.row[1]), D.z, mass.row[2]);
    mass.row[0] = add_times(mass.row[0], f * pushed.x, by);
    mass.row[1] = add_times(mass.row[1], f * pushed.y, by);
    mass.row[2] = add_times(mass.row[2], f * pushed.z, by);
}

}  // namespace graph
}  // namespace HOL_ISA
}  // namespace holonomic
#endif
