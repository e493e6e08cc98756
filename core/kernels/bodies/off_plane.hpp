// Massless sites off the plane of W bodies' masses, at heights along the normal n = a_1 x a_2
// (core/rigid/off_plane.cpp). All other bodies have none.
#pragma once

#include "core/kernels/bodies/frame.hpp"

namespace holonomic::HOL_ISA {

template <int R>
HOL_INLINE bool has_off_plane(const BodyKind &kind) {
    return R == 2 && __builtin_expect(kind.height != nullptr, 0);
}

HOL_INLINE vec3 normal_of(const Frame<2> &a) { return cross(a[1], a[2]); }

// n', relative to what flows with the box at L [9], or null.
HOL_INLINE vec3 normal_rate(const Frame<2> &a, const Frame<2> &rate, const double *L) {
    if (!L) return cross(rate[1], a[2]) + cross(a[1], rate[2]);
    const auto flow = [&](const vec3 &x) HOL_FORCED {
        vec to[3];
        for (int i = 0; i < 3; ++i)
            to[i] = mul_add(splat(L[3 * i + 2]), x.z, mul_add(splat(L[3 * i + 1]), x.y, splat(L[3 * i]) * x.x));
        return vec3{to[0], to[1], to[2]};
    };
    return cross(rate[1] + flow(a[1]), a[2]) + cross(a[1], rate[2] + flow(a[2])) - flow(normal_of(a));
}

// The sum of heights times forces.
HOL_INLINE vec3 lifted_force(const BodyKind &kind, const vec3 *f) {
    vec3 sum = {};
    for (long a = 0; a < kind.n_atoms; ++a)
        if (kind.height[a] != 0) sum = add_times(sum, splat(kind.height[a]), f[a]);
    return sum;
}

// To forces on the axes, per moment.
HOL_NOINLINE void carry_to_axes(const BodyKind &kind, const Frame<2> &a, const vec3 *f, Frame<2> &z) {
    const vec3 lifted = lifted_force(kind, f);
    put(z[1], add_times(z[1], splat(kind.per_moment[1]), cross(a[2], lifted)));
    put(z[2], add_times(z[2], splat(kind.per_moment[2]), cross(lifted, a[1])));
}

// What carrying the forces adds to the virial.
HOL_NOINLINE void add_virial_of_sites(const BodyKind &kind, const Frame<2> &a, const vec3 *f, int count,
                                      BodyResult *results) {
    const vec3 lifted = lifted_force(kind, f), normal = vec3{} - normal_of(a);
    const vec3 arm[3] = {a[1], a[2], normal}, force[3] = {cross(a[2], lifted), cross(lifted, a[1]), lifted};
    int i = 0;
    for (int x = 0; x < 3; ++x)
        for (int y = x; y < 3; ++y, ++i) {
            vec sum = {};
            for (int k = 0; k < 3; ++k) sum = mul_add((&arm[k].x)[x], (&force[k].x)[y], sum);
            for (int l = 0; l < count; ++l) results[l].virial[i] += sum[l];
        }
}

}  // namespace holonomic::HOL_ISA
