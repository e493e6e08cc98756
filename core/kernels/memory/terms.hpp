// Right-hand sides of the equations for the multipliers. They are computed while a block is read, from components as
// they stand in memory or from vectors in lanes. Each product stands here once.
#ifndef HOLONOMIC_KERNELS_MEMORY_TERMS_HPP
#define HOLONOMIC_KERNELS_MEMORY_TERMS_HPP

#include "core/kernels/arithmetic/vector3.hpp"
#include "core/kernels/isa/choose.hpp"

namespace holonomic::HOL_ISA {

// With d the bond vector, dv the difference of velocities, df that of forces times inverse masses:
//   velocity_squared: dv.dv / unit,  force_difference: d.df,  rate: d.dv
// unit_mass: velocities need no factor. bonds_alone: no right-hand side, not even zero.
enum Terms {
    none_ = 0,
    velocity_squared = 1,
    force_difference = 2,
    rate = 4,
    unit_mass = 8,
    bonds_alone = 16,
    products = velocity_squared | force_difference | rate
};

// Calls body(terms), where terms is a constant: that of velocities, of forces, of both or of neither.
template <class Body>
HOL_INLINE auto choose_terms(const Body &body, bool velocities, bool forces) {
    return choose(
        [&](auto v, auto f)
            HOL_FORCED { return body(Constant<int, (v ? velocity_squared : 0) | (f ? force_difference : 0)>{}); },
        velocities, forces);
}

// A component of velocity_squared.
template <int terms>
HOL_INLINE vec square(vec mass, vec dv) {
    return (terms & unit_mass ? dv : mass * dv) * dv;
}

// A component of the right-hand side; vv is that of square().
template <int terms>
HOL_INLINE vec product(vec d, vec dv, vec df, vec vv) {
    if (terms & rate) return dv * d;
    if (!(terms & force_difference)) return vv;
    return terms & velocity_squared ? mul_add(df, d, vv) : df * d;
}

// The right-hand side of a bond from differences that are in lanes already, rounded as if they had been read from rows.
// `waited`: rounded as products that wait for the images of bonds.
template <int terms>
HOL_INLINE vec right_hand_side(bool waited, vec mass, const vec3 &d, const vec3 &dv, const vec3 &df) {
    if (terms & rate) return dot(d, dv);
    const vec3 vv = {square<terms>(mass, dv.x), square<terms>(mass, dv.y), square<terms>(mass, dv.z)};
    if (waited) {
        vec sum = {};
        if (terms & force_difference) sum = dot(d, df);
        return terms & velocity_squared ? sum + ((vv.x + vv.y) + vv.z) : sum;
    }
    return (product<terms>(d.x, dv.x, df.x, vv.x) + product<terms>(d.y, dv.y, df.y, vv.y)) +
           product<terms>(d.z, dv.z, df.z, vv.z);
}

}  // namespace holonomic::HOL_ISA
#endif
