// Chains of one bond in closed form.
#ifndef HOLONOMIC_KERNELS_NEWTON_SINGLE_BOND_HPP
#define HOLONOMIC_KERNELS_NEWTON_SINGLE_BOND_HPP

#include "core/kernels/newton/criterion.hpp"

namespace holonomic::HOL_ISA {

// A chain of one bond in closed form: with sigma = D.D - a^2, D - s b has the length a for
// s = sigma / (D.b + sqrt((D.b)^2 - b.b sigma)), and tau = s / (w_0 + w_1).
template <bool uniform_w>
HOL_INLINE Outcome solve_single_bonds(const Newton &x, Carried &carried, mask wanted) {
    Outcome out = {};
    const vec3 b = x.b[0], d = x.D[0];
    const vec w = uniform_w ? splat(2.0) : x.w[0] + x.w[1];
    const vec a2 = x.a2 ? x.a2[0] : x.a2_uniform, db = dot(d, b);
    const vec sigma = excess(d, a2);
    const vec root = sqrt(mul_add(db, db, -(dot(b, b) * sigma)));  // NaN where the length can't be reached
    const vec s = sigma / (db + select(less(db, vec{}), -root, root));
    const mask known = wanted & finite(db);
    out.untouched = known & carried.within(abs(sigma), a2);
    const mask reached = known & ~out.untouched & finite(s / w) & less(vec{}, w);
    vec step = keep(reached, s);
    vec3 moved;
    const auto excess_left = [&]() HOL_FORCED {
        moved = add_times(d, -step, b);
        return excess(moved, a2);
    };
    vec left = excess_left();
    const vec enough = 4.0 * a2 * carried.always_accepted();
    mask unsure = reached & ~less_equal(abs(left), enough);
    out.converged = reached & ~unsure;
    if (__builtin_expect(any(unsure), 0)) {
        // D much longer than a, or squares that overflow or underflow: on by Newton's method.
        for (int i = 0; i < 3; ++i) {
            step = step + keep(unsure & ~less_equal(abs(left), enough), left / (2.0 * dot(moved, b)));
            left = excess_left();
        }
        out.converged = out.converged | (unsure & finite(step / w) & carried.within(0.25 * abs(left), a2));
    }
    x.tau[0] = select(wanted, keep(out.converged, step / w), x.tau[0]);
    out.error = abs(left) * (x.a2 ? x.per_a2[0] : x.per_a2_uniform);
    out.solves = any(out.converged) ? 1 : 0;
    return out;
}

}  // namespace holonomic::HOL_ISA
#endif
