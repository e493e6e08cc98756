// Right-hand sides: what they are made of. Each product stands here once, for components as they stand in memory or for
// vectors in lanes.
#pragma once

#include "core/kernels/arithmetic/vector3.hpp"

namespace holonomic::HOL_ISA {

// With d the bond vector, dv the difference of velocities, df that of forces times inverse masses:
//   velocity_squared: dv.dv / unit,  force_difference: d.df,  rate: d.dv
// unit_mass: velocities need no factor. kept_rate: rates, found in lanes from velocities that are kept there. given:
// half of the caller's value of the bond; of molecules that are no chains.
enum Terms {
    none_ = 0,
    velocity_squared = 1,
    force_difference = 2,
    rate = 4,
    unit_mass = 8,
    kept_rate = 16,
    given = 32,
    products = velocity_squared | force_difference | rate,
    of_velocities = velocity_squared | rate | kept_rate
};

HOL_INLINE int terms_of(bool velocities, bool forces) {
    return (velocities ? velocity_squared : 0) | (forces ? force_difference : 0);
}

// A component of velocity_squared.
template <class V>
HOL_INLINE V square(int terms, V mass, V dv) {
    return (terms & unit_mass ? dv : mass * dv) * dv;
}

// A component of the right-hand side; vv is that of square().
template <class V>
HOL_INLINE V product(int terms, V d, V dv, V df, V vv) {
    if (terms & rate) return dv * d;
    if (!(terms & force_difference)) return vv;
    return terms & velocity_squared ? mul_add(df, d, vv) : df * d;
}

// The right-hand side of a bond from differences that are in lanes already, rounded as if they had been read from rows.
HOL_INLINE vec right_hand_side(int terms, vec mass, const vec3 &d, const vec3 &dv, const vec3 &df) {
    vec3 vv = {};
    if (terms & velocity_squared)
        vv = {square(terms, mass, dv.x), square(terms, mass, dv.y), square(terms, mass, dv.z)};
    return (product(terms, d.x, dv.x, df.x, vv.x) + product(terms, d.y, dv.y, df.y, vv.y)) +
           product(terms, d.z, dv.z, df.z, vv.z);
}

// d . (v_{k+1} - v_k)
HOL_INLINE vec rate_of(const vec3 &d, const vec3 &v0, const vec3 &v1) { return dot(d, v1 - v0); }

}  // namespace holonomic::HOL_ISA
