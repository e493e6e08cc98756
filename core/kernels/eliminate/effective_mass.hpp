// E, the effective inverse mass: its recursion, how far it may be trusted, and products of nearly orthogonal bonds.
#pragma once

#include "core/kernels/arithmetic/image.hpp"
#include "core/kernels/arithmetic/thresholds.hpp"
#include "core/kernels/arithmetic/vector3.hpp"
#include "core/kernels/memory/block.hpp"

namespace holonomic::HOL_ISA {

// The sign bit is set if |cos| is below that; X = q q' (1 - cos^2).
HOL_INLINE vec not_orthogonal(vec g2, vec X, double cosine = small_cosine) {
    return mul_sub(splat(1 / (cosine * cosine)), g2, X);
}

HOL_INLINE mask nearly_orthogonal(vec g, vec X, double cosine = small_cosine) {
    return less(not_orthogonal(g * g, X, cosine), vec{});
}

// g of joint k in one lane, with compensated products of unrounded differences. Where: a Source, or what has the same
// members.
#if HOL_LANES != 4 && !HOL_FOURS
template <class Where>
HOL_NOINLINE double exact_dot(const Where &source, int lane, long k) {
    Vector3<double> d[2], low[2];
    for (int b = 0; b < 2; ++b)
        unrounded_bond(*source.box, source.atom(lane, k - 1 + b), source.atom(lane, k + b), d[b], low[b]);
    const Pair<double> x = two_product(d[0].x, d[1].x), y = two_product(d[0].y, d[1].y),
                       z = two_product(d[0].z, d[1].z);
    const double hi[3] = {x.hi, y.hi, z.hi};
    const double lo[3] = {mul_add(d[0].x, low[1].x, mul_add(low[0].x, d[1].x, x.lo)),
                          mul_add(d[0].y, low[1].y, mul_add(low[0].y, d[1].y, y.lo)),
                          mul_add(d[0].z, low[1].z, mul_add(low[0].z, d[1].z, z.lo))};
    return sum_compensated(hi, lo);
}

#else
template <class Where>
HOL_INLINE double exact_dot(const Where &source, int lane, long k) {
    const auto at = [&](long atom) HOL_FORCED {
        const auto p = source.atom(lane, atom);
        return components{p[0], p[1], p[2], 0};
    };
    const components r0 = at(k - 1), r1 = at(k), r2 = at(k + 1);
    const Pair<components> a = unrounded_bond(*source.box, r0, r1), b = unrounded_bond(*source.box, r1, r2),
                           hi = two_product<components>(a.hi, b.hi);
    return sum_compensated(hi.hi, mul_add(a.hi, b.lo, mul_add(a.lo, b.hi, hi.lo)));
}
#endif

// The lanes in `which` of g, for joint k.
template <class Where>
HOL_NOINLINE vec exact_dots(const Where &source, long k, mask which, vec g) {
    for (unsigned left = bits(which); left; left &= left - 1) {
        const int i = __builtin_ctz(left);
        if (source.len && k >= source.len[i]) continue;
        g[i] = exact_dot(source, i, k);
    }
    return g;
}

// A solution of the recursion E' = w (q' E + w X) / (w q + E), as the fraction E = A / F:
//     F' = w q F + A,   A' = w q' A + w^2 X F
// Both may be scaled by one factor at any time, so no division has to wait for another. A chain has one column. A
// segment has two with the same coefficients: its own, and that of its separator, (a, c). Newton's matrix is not
// symmetric; there q and X are products of old and new bonds.
struct Fraction {
    vec A, F;
    HOL_FORCED vec next(vec wq) const { return mul_add(wq, F, A); }  // F'; the pivot P is F' / F
    HOL_FORCED void pass(vec F1, vec wwX, vec wq1) {
        A = mul_add(wwX, F, wq1 * A);
        F = F1;
    }
};

// The cheap tests of doubt look at this: it is negative where E < P / (1 + times). P = F' / F.
HOL_INLINE vec spare(const Fraction &e, vec F1, double times) { return mul_sub(splat(1 + times), e.A, F1); }

// How X = |d x d'|^2 is found. It enters E' = w (q' E + w X) / P, and E decides how much its error harms E'. With
// e = E / (w q),
//  - q q' - g^2 has an error of a few roundings of q q', and E' gets a few / (e + sin^2). That is harmless in ordinary
//    chains, where e >= least_effective_mass but in a row of nearly parallel bonds;
//  - the cross product has a relative error of about 2 eps |d| |d'| / sqrt X from the rounding of d and d', which is
//    harmless where w sqrt(X q q') <= c (q' E + w X), c = joint_tolerance. This holds for every X if e >= 1 / (4 c^2);
//  - else the chain needs compensated products of the unrounded bond vectors.
// Each test is tried only if the cheaper one before it fails: a multiply-add, one more, then the exact form below
// (docs/development/measurements.md).

// Exact form of the test, for the joints between the n + 1 bonds from D on. Joint i is at atom first + i; E is the
// E before D[0].
template <bool uniform>
HOL_NOINLINE mask flagged_joints(const Block &block, const vec3 *D, long first, long n, vec E) {
    mask flag = none();
    for (long i = 0; i < n; ++i) {
        const vec w = w_at<uniform>(block, first + i), q = dot(D[i], D[i]), q1 = dot(D[i + 1], D[i + 1]);
        const vec3 c = cross(D[i], D[i + 1]);
        const vec X = dot(c, c), qq = q * q1, S = mul_add(q1, E, w * X);
        const double eps2 = 4.9e-32;  // (2^-52)^2: an X that vanished by rounding
        const vec left = (w * w) * ((X + eps2 * qq) * qq), right = (joint_tolerance * joint_tolerance) * (S * S);
        flag = flag | (~less_equal(left, right) & joint(block, first + i));
        E = w * S / mul_add(w, q, E);
    }
    return flag;
}

// If |u|, q, 1 / P and w are below this, nothing overflows after the forward sweep, and no product of pivots in it has
// lost digits by underflow.
constexpr double largest_calm = 1e60;

// Lanes with extreme pivots. Right-hand sides don't count: the arithmetic must not depend on their unit.
template <bool uniform>
HOL_NOINLINE mask extreme_pivots(const Block &block, const vec3 *D) {
    vec q = dot(D[0], D[0]), E = w_at<uniform>(block, 0) * q, size = {};
    for (long k = 0; k < block.n; ++k) {
        const vec w = w_at<uniform>(block, k + 1), P = mul_add(w, q, E);
        size = size + ((q + splat(1.0) / P) + w);
        if (k + 1 == block.n) break;
        const vec3 c = cross(D[k], D[k + 1]);
        q = dot(D[k + 1], D[k + 1]);
        E = w * mul_add(q, E, w * keep(joint(block, k + 1), dot(c, c))) / P;
    }
    return ~less(size, splat(largest_calm));
}

}  // namespace holonomic::HOL_ISA
