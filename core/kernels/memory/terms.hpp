// Right-hand sides of the equations for the multipliers.
#ifndef HOLONOMIC_KERNELS_MEMORY_TERMS_HPP
#define HOLONOMIC_KERNELS_MEMORY_TERMS_HPP

#include "core/kernels/arithmetic/vector3.hpp"

namespace holonomic {
namespace HOL_ISA {

// What the right-hand side of a bond is made of.
enum Terms { none_ = 0, velocity_squared = 1, force_difference = 2, rate = 4, unit_mass = 8 };

// The right-hand side of a bond as load_chunk() finds it, from differences already in lanes: dv of the velocities, df
// of the forces times their inverse masses. `waited`: for images of bonds.
template <int terms>
HOL_INLINE vec right_hand_side(bool waited, vec mass, const vec3 &d, const vec3 &dv, const vec3 &df) {
    if (terms & rate) return dot(d, dv);
    const vec3 vv = {(mass * dv.x) * dv.x, (mass * dv.y) * dv.y, (mass * dv.z) * dv.z};
    if (waited) {
        vec sum = {};
        if (terms & force_difference) sum = dot(d, df);
        return terms & velocity_squared ? sum + ((vv.x + vv.y) + vv.z) : sum;
    }
    if (!(terms & force_difference)) return (vv.x + vv.y) + vv.z;
    if (!(terms & velocity_squared)) return (df.x * d.x + df.y * d.y) + df.z * d.z;
    return (mul_add(df.x, d.x, vv.x) + mul_add(df.y, d.y, vv.y)) + mul_add(df.z, d.z, vv.z);
}

}  // namespace HOL_ISA
}  // namespace holonomic
#endif
