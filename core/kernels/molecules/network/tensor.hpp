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

// a += f b (x) c
HOL_INLINE void add_product(Tensor &a, double f, const Vector3<double> &b, const Vector3<double> &c) {
    a.row[0] = add_times(a.row[0], f * b.x, c);
    a.row[1] = add_times(a.row[1], f * b.y, c);
    a.row[2] = add_times(a.row[2], f * b.z, c);
}

HOL_INLINE Tensor inverse_of(const Tensor &a) {
    const Vector3<double> x = cross(a.row[1], a.row[2]), y = cross(a.row[2], a.row[0]), z = cross(a.row[0], a.row[1]);
    const double f = 1 / dot(a.row[0], x);
    return {{{f * x.x, f * y.x, f * z.x}, {f * x.y, f * y.y, f * z.y}, {f * x.z, f * y.z, f * z.z}}};
}

}  // namespace graph
}  // namespace HOL_ISA
}  // namespace holonomic
#endif
