// Metric determinant and Fixman force of a block of chains, theory (24)-(31): elimination on unit bonds. It carries the
// deficits e and f, which the bonds on either side leave of a row, instead of the diagonal. So it subtracts nothing.
// Products are always compensated, because determinants and the inverse have no componentwise scale that would forgive
// their rounding.
#pragma once

#include "core/kernels/arithmetic/log_sum.hpp"
#include "core/kernels/eliminate/measure_one_lane.hpp"
#include "core/kernels/memory/arena.hpp"
#include "core/kernels/memory/block.hpp"

namespace holonomic::HOL_ISA {

// Per bond k of a block; joint k lies between bonds k-1 and k.
struct Geometry {
    vec3 *u, *low;             // bond vector, then unit vector, then Fixman's phi; low words of the bond vector
    vec3 *normal;              // u_{k-1} x u_k, then h_k times it
    vec *cosine, *complement;  // of joint k: c and 1 - |c|
    vec *reciprocal;           // 1 / |d|
    vec *square;               // d.d over `scale` squared
    vec *f;                    // deficits from behind, where they are kept
    vec *scale;                // a power of two
    vec *p, *delta;            // coupling of bonds k-1 and k; what row k has beyond its neighbours
    vec *e, *t;
    Geometry(long n, Arena &arena)
        : u(vectors(n + W, arena)), low(vectors(n + W, arena)), normal(vectors(n + 1, arena)),
          cosine(arena.vecs(n + 1)), complement(arena.vecs(n + 1)), reciprocal(arena.vecs(n)), square(arena.vecs(n)),
          scale(arena.vecs(n)), p(arena.vecs(n + 1)), delta(arena.vecs(n)), e(arena.vecs(n)), t(arena.vecs(n + W)) {
        f = t;  // until t is needed
    }
    static vec3 *vectors(long n, Arena &arena) { return reinterpret_cast<vec3 *>(arena.vecs(3 * n)); }
};

// The reciprocal of the power of two just below the largest component.
HOL_INLINE vec reciprocal_scale(const vec3 &d) {
    const vec largest = max(max(abs(d.x), abs(d.y)), abs(d.z));
    return as_vec((mask{} + 2 * exponent_of_one) - (as_mask(largest) & (mask{} + exponent_bits)));
}

// Bonds, the joints between them, and what couples these.
#if HOL_FOURS
template <bool uniform>
static inline void measure_joints(const Block &block, const Geometry &x) {
    measure_in_fours(block.n, x);
    for (long k = 1; k < block.n; ++k) x.p[k] = w_at<uniform>(block, k) * abs(x.cosine[k]);
}
#else
template <bool uniform>
static inline void measure_joints(const Block &block, const Geometry &x) {
    vec3 d0 = {}, low0 = {};
    vec r0 = {};
    for (long k = 0; k < block.n; ++k) {
        const vec s = reciprocal_scale(x.u[k]);
        const vec3 d = s * x.u[k], low = s * x.low[k];
        const vec q = dot_compensated(d, low, d, low), r = splat(1.0) / sqrt(q);
        x.u[k] = r * d;
        x.square[k] = q;
        x.scale[k] = s;
        x.reciprocal[k] = r * s;
        if (k > 0) {
            const vec f = r0 * r;
            vec c = dot_compensated(d0, low0, d, low) * f;
            vec3 normal = f * cross_compensated(d0, low0, d, low);
            const vec size = abs(c);
            vec complement = select(less(size, splat(0.5)), 1.0 - size, dot(normal, normal) / (1.0 + size));
            if (k >= block.n_min) {
                const mask m = joint(block, k);
                c = keep(m, c);
                normal = {keep(m, normal.x), keep(m, normal.y), keep(m, normal.z)};
                complement = select(m, complement, splat(1.0));
            }
            x.cosine[k] = c;
            x.complement[k] = complement;
            x.normal[k] = normal;
            x.p[k] = w_at<uniform>(block, k) * abs(c);
        }
        d0 = d;
        low0 = low;
        r0 = r;
    }
}
#endif

template <bool uniform>
static inline void measure(const Block &block, const Geometry &x) {
    x.p[0] = x.p[block.n] = x.cosine[0] = x.cosine[block.n] = vec{};
    x.complement[0] = x.complement[block.n] = splat(1.0);
    x.normal[0] = x.normal[block.n] = vec3{};
    measure_joints<uniform>(block, x);
    for (long k = 0; k < block.n; ++k)
        x.delta[k] = w_at<uniform>(block, k) * x.complement[k] + w_at<uniform>(block, k + 1) * x.complement[k + 1];
}

HOL_INLINE mask between(long k, vec first, vec end) {
    const vec v = splat(static_cast<double>(k));
    return less_equal(first, v) & less(v, end);
}

struct MetricSums {
    vec log_det, log_det_z;
};

// Less what a coupling p passes on of a deficit e: - p e / P, P = e + p. Along a rod e is the same at each joint, so
// that the factor p / P would be rounded the same way each time, which adds up as the number of joints. What the
// smaller one of both loses is never more than half of it.
HOL_INLINE vec less_passed_on(vec e, vec p, vec P) {
    const vec s = min(e, p);
    return mul_sub(s, s / P, s);
}

// Goes from left to right, from e of bond 0. Finds e of all bonds, and the logarithms over the bonds first .. end-1 of
// each lane; all lanes have the first `whole`, and count them. Takes lanes with a pivot that is not positive out of
// `good`. beside(k) is called for all bonds, for what waits as long and for something else.
template <bool uniform, class Beside>
static inline MetricSums eliminate_metric(const Block &block, const Geometry &x, vec e, vec first, vec end, long whole,
                                          const MetricCall &call, mask &good, const Beside &beside) {
    const bool logs = call.log_det || call.sum;
    const vec headroom = splat(call.force.x ? call.kT * 0x1p300 : 0.0);  // no force overflows
    LogSum<vec> det;
    LogSumWide<vec> det_z;
    vec removed = {};  // p l
    for (long k = 0; k < block.n; ++k) {
        const vec P = e + x.p[k + 1], M = w_at<uniform>(block, k) + w_at<uniform>(block, k + 1);
        x.e[k] = e;
        good = good & less(vec{}, P) & finite(x.reciprocal[k] + headroom * x.reciprocal[k]);
        if (logs || call.log_det_z) {
            const vec inverse = splat(1.0) / M;
            vec factor = P * inverse, less_one = removed * inverse;
            mask counted = ~none();
            if (k >= whole) {
                counted = between(k, first, end);
                factor = select(counted, factor, splat(1.0));
                less_one = keep(counted, less_one);
            }
            det.multiply(factor, less_one);
            if (call.log_det_z)
                det_z.multiply(select(counted, 4.0 * (block.unit * M) * x.square[k], splat(1.0)),
                               select(counted, x.scale[k], splat(1.0)));
        }
        beside(k);
        if (k + 1 == block.n) break;
        removed = x.p[k + 1] * (x.p[k + 1] / P);
        e = x.delta[k + 1] - less_passed_on(e, x.p[k + 1], P);
    }
    det.flush();
    MetricSums sums = {det.sum, vec{}};
    if (call.log_det_z) sums.log_det_z = det.sum + det_z.total();
    return sums;
}

// From the joint's two sides: h_k = w_k (M^-1)_{k-1,k}, and h_k n_k in place of n_k. f belongs to bond k.
template <bool uniform>
HOL_INLINE void weigh_normal(const Block &block, const Geometry &x, long k, vec f) {
    const mask coupled = less(vec{}, x.p[k]);
    const vec e = x.e[k - 1], p = select(coupled, x.p[k], splat(1.0));  // the caller may trap divisions by zero
    const vec size = w_at<uniform>(block, k) / (e + f + (e / p) * f);
    const mask sign = mask{} + (-0x7fffffffffffffffLL - 1);
    const vec h = as_vec(as_mask(size) | (as_mask(x.cosine[k]) & sign));
    x.normal[k] = keep(coupled, h) * x.normal[k];
}

// What the bonds to the right of joint k leave of row k-1.
HOL_INLINE vec next_deficit(const Geometry &x, long k, vec f) {
    const mask coupled = less(vec{}, x.p[k]);
    const vec p = select(coupled, x.p[k], splat(1.0));
    return x.delta[k - 1] - less_passed_on(f, x.p[k], f + p);  // P = 0 would be a division by it
}

// Writes phi of bond k as t times a vector: the force on atom k is the pull t_k phi_k - t_{k-1} phi_{k-1}. Zeros are
// +0, so that those of a chain's last atom don't depend on whether inert bonds follow.
HOL_INLINE void turn(const Geometry &x, long k, double kT) {
    const vec3 a = x.normal[k], b = x.normal[k + 1];
    const vec3 v = cross(x.u[k], vec3{b.x - a.x, b.y - a.y, b.z - a.z});
    x.u[k] = {v.x + 0.0, v.y + 0.0, v.z + 0.0};
    x.t[k] = kT * x.reciprocal[k];
}

}  // namespace holonomic::HOL_ISA
