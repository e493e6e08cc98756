// Products of the bonds of a joint, for segments.
#pragma once

#include "core/kernels/eliminate/effective_mass.hpp"

namespace holonomic::HOL_ISA {

// Products of the bond vectors of a joint and of the bond behind it.
struct JointProducts {
    vec g, X, q;
};

HOL_INLINE JointProducts plain_joint(const vec3 &d, const vec3 &d1) {
    const vec3 c = cross(d, d1);
    return {dot(d, d1), dot(c, c), dot(d1, d1)};
}

HOL_INLINE JointProducts extended_joint(const vec3 &d, const vec3 &low, const vec3 &d1, const vec3 &low1) {
    const vec3 c = cross_compensated(d, low, d1, low1);
    return {dot_compensated(d, low, d1, low1), dot(c, c), dot(d1, d1)};
}

// Computes g anew where bonds are nearly orthogonal: of n joints, the first of which is that of bonds k and k + 1.
HOL_NOINLINE void refine_joints(const Source &source, long k, JointProducts *j, long n) {
    for (long i = 0; i < n; ++i) {
        const mask orthogonal = nearly_orthogonal(j[i].g, j[i].X, segment_cosine);
        if (any(orthogonal)) j[i].g = exact_dots(source, k + i + 1, orthogonal, j[i].g);
    }
}

// The joints between n + 1 bonds from d on, the first of which is bond k.
template <int n>
HOL_INLINE void plain_joints(const Source &source, long k, const vec3 *d, JointProducts *j) {
    vec least = {};
#pragma GCC unroll 8
    for (int i = 0; i < n; ++i) {
        j[i] = plain_joint(d[i], d[i + 1]);
        least = min(least, not_orthogonal(j[i].g * j[i].g, j[i].X, segment_cosine));
    }
    if (any(less(least, vec{}))) refine_joints(source, k, j, n);
}

}  // namespace holonomic::HOL_ISA
