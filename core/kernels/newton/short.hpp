// Chains of one bond in closed form, and of two bonds by products alone.
#pragma once

#include "core/kernels/newton/criterion.hpp"
#include "core/kernels/newton/multipliers.hpp"
#include "core/kernels/newton/sweeps.hpp"

namespace holonomic::HOL_ISA {

// A chain of one bond in closed form: with sigma = D.D - a^2, D - s b has the length a for
// s = sigma / (D.b + sqrt((D.b)^2 - b.b sigma)), and tau = s / (w_0 + w_1).
template <Same masses>
HOL_INLINE NewtonOutcome solve_single_bonds(const Newton &x, Carried &carried, mask wanted) {
    NewtonOutcome out = {};
    const vec3 b = x.b[0], d = x.D[0];
    const vec w = times_w<masses>(x, 0, splat(1.0)) + times_w<masses>(x, 1, splat(1.0));
    const vec a2 = x.a2 ? x.a2[0] : x.a2_uniform, db = dot(d, b);
    const vec sigma = excess(d, a2);
    const vec root = sqrt(mul_add(db, db, -(dot(b, b) * sigma)));  // NaN where the length can't be reached
    const vec s = sigma / (db + select(less(db, vec{}), -root, root));
    const mask known = wanted & finite(db);
    out.untouched = known & carried.within(abs(sigma), a2);
    const mask reached = known & ~out.untouched & carried.not_too_far(sigma, a2) & finite(s / w) & less(vec{}, w);
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

// Two bonds, for multipliers.hpp:
//     P_0 = - (w_0 + w_1) tau_0 b_0 + w_1 tau_1 b_1,   P_1 = - (w_1 + w_2) tau_1 b_1 + w_1 tau_0 b_0:
// nothing but products of bond vectors is needed to get there.

// Least part of m00 m11 that must be left in the determinant of M, so that enough digits are.
constexpr double two_bonds_part = 1.0 / 64;

// Products of bonds b_k . b_l and D_k . b_l; sums of inverse masses at the bonds, and the one between them.
struct TwoBonds {
    static constexpr int unknowns = 2;
    vec b00, b01, b11, g00, g01, g10, g11, s0, s1, w;
    vec sigma[2], per_a2[2];

    // P_k . b_l and q_k.
    struct Change {
        vec p00, p01, p10, p11, q[2];
    };
    HOL_FORCED Change change(const vec *tau) const {
        const vec x0 = s0 * tau[0], y0 = w * tau[1], x1 = s1 * tau[1], y1 = w * tau[0];
        Change c;
        c.p00 = mul_add(y0, b01, -(x0 * b00));
        c.p01 = mul_add(y0, b11, -(x0 * b01));
        c.p11 = mul_add(y1, b01, -(x1 * b11));
        c.p10 = mul_add(y1, b00, -(x1 * b01));
        c.q[0] = mul_add(y0, c.p01, -(x0 * c.p00));
        c.q[1] = mul_add(y1, c.p10, -(x1 * c.p11));
        return c;
    }
    // M and 1 / (2 det).
    struct TwoBondFactors {
        vec m00, m01, m10, m11, r, whole;
        HOL_FORCED vec part() const { return mul_add(m00, m11, -(m01 * m10)); }
    };
    HOL_STATIC void solve(const TwoBondFactors &f, const vec *y, vec *tau) {
        const vec y0 = y[0], y1 = y[1];
        tau[0] = f.r * mul_add(f.m11, y0, -(f.m01 * y1));
        tau[1] = f.r * mul_add(f.m00, y1, -(f.m10 * y0));
    }
    HOL_FORCED TwoBondFactors factors(vec h00, vec h01, vec h10, vec h11) const {
        TwoBondFactors f;
        f.m00 = s0 * h00;
        f.m11 = s1 * h11;
        f.m01 = -(w * h01);
        f.m10 = -(w * h10);
        f.whole = f.m00 * f.m11;
        f.r = splat(0.5) / f.part();
        return f;
    }
    HOL_FORCED TwoBondFactors inverse() const { return factors(g00, g01, g10, g11); }
    HOL_FORCED TwoBondFactors inverse(const Change &c) const {
        return factors(g00 + c.p00, g01 + c.p01, g10 + c.p10, g11 + c.p11);
    }
};

// The lanes in `wanted`, into tau, by no more than `most` solves; `fewest`: by the fewest, of which there are that
// many. Those that are neither converged nor untouched need more, or iterate().
template <Same masses, Same a, bool fewest>
HOL_INLINE NewtonOutcome solve_two_bonds(Newton &x, Carried &carried, mask wanted, int most) {
    const vec3 b0 = x.b[0], b1 = x.b[1], D0 = x.D[0], D1 = x.D[1];
    const vec one = splat(1.0), w = times_w<masses>(x, 1, one);
    TwoBonds m;
    m.b00 = dot(b0, b0), m.b01 = dot(b0, b1), m.b11 = dot(b1, b1);
    m.g00 = dot(D0, b0), m.g01 = dot(D0, b1), m.g10 = dot(D1, b0), m.g11 = dot(D1, b1);
    m.s0 = times_w<masses>(x, 0, one) + w, m.s1 = w + times_w<masses>(x, 2, one), m.w = w;
    vec worst = {};
    for (int k = 0; k < 2; ++k) {
        m.sigma[k] = length_error<a>(x, k, false, x.D[k], worst);
        m.per_a2[k] = a == same || (a == either && !x.a2) ? x.per_a2_uniform : x.per_a2[k];
    }
    NewtonOutcome out = {};
    // As in the elimination, the error is NaN if a reference is.
    const vec before = largest_error<a>(x, worst, (m.sigma[0] + m.sigma[1]) + (m.g00 + m.g11));
    out.untouched = wanted & carried.within(before, one);
    const TwoBonds::TwoBondFactors f = m.inverse();
    const mask open = less(two_bonds_part * f.whole, f.part());
    mask unsure = wanted & open;
    vec tau[2];
    int64_t solves = fewest_solves;
    if constexpr (fewest)
        unsure = ~less(fewest_for_multipliers<2>(m, tau), splat(small_enough));
    else
        solves = solve_for_multipliers<2>(m, tau, unsure, most);
    const mask near = wanted & ~out.untouched & open & ~unsure & carried.not_too_far(before, one);
    x.tau[0] = keep(near, tau[0]);
    x.tau[1] = keep(near, tau[1]);
    // As Mover has it, where the bond behind the last one is none.
    const vec3 p0 = x.tau[0] * b0, p1 = x.tau[1] * b1, middle = times_w<masses>(x, 1, p1 - p0),
               d0 = D0 + (middle - times_w<masses>(x, 0, p0)), d1 = D1 + (times_w<masses>(x, 2, vec3{} - p1) - middle);
    worst = vec{};
    const vec after0 = length_error<a>(x, 0, false, d0, worst), after1 = length_error<a>(x, 1, false, d1, worst);
    out.error = largest_error<a>(x, worst, after0 + after1);
    out.converged = near & less_equal(out.error, carried.always_accepted());
    x.tau[0] = keep(out.converged, x.tau[0]);
    x.tau[1] = keep(out.converged, x.tau[1]);
    out.solves = any(out.converged) ? solves : 0;
    return out;
}

}  // namespace holonomic::HOL_ISA
