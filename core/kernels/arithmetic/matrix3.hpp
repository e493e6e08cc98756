// Matrices of three rows and columns, of doubles or of lanes.
#pragma once

#include "core/kernels/arithmetic/vector3.hpp"
#include "core/kernels/arithmetic/width.hpp"

namespace holonomic::HOL_ISA {

// Rows x, y, z of a matrix; of a symmetric one all that is above the diagonal, too.
template <class V>
struct Matrix3 {
    Vector3<V> x, y, z;
    HOL_FORCED Vector3<V> operator*(const Vector3<V> &a) const { return {dot(x, a), dot(y, a), dot(z, a)}; }
    // += a b^T
    HOL_FORCED void add(const Vector3<V> &a, const Vector3<V> &b) {
        x = add_times(x, a.x, b);
        y = add_times(y, a.y, b);
        z = add_times(z, a.z, b);
    }
    HOL_FORCED V trace() const { return x.x + y.y + z.z; }
    HOL_STATIC Matrix3 one() {
        const V i = Width<V>::all(1);
        return {{i, V{}, V{}}, {V{}, i, V{}}, {V{}, V{}, i}};
    }
};

// f / a
template <class V>
HOL_INLINE Matrix3<V> divided_by(const Matrix3<V> &a, V f) {
    const Vector3<V> x = cross(a.y, a.z), y = cross(a.z, a.x), z = cross(a.x, a.y);
    const V p = f / dot(a.x, x);
    return {{p * x.x, p * y.x, p * z.x}, {p * x.y, p * y.y, p * z.y}, {p * x.z, p * y.z, p * z.z}};
}

}  // namespace holonomic::HOL_ISA
