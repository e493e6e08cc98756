// Steps of Newton's method on one long chain with the factors at hand (segments.hpp): the separators are joined,
// and each block substitutes backward, moves its bonds and substitutes forward what that leaves of their lengths.
#ifndef HOLONOMIC_KERNELS_NEWTON_SEGMENT_STEPS_HPP
#define HOLONOMIC_KERNELS_NEWTON_SEGMENT_STEPS_HPP

#include "core/kernels/newton/segments.hpp"

namespace holonomic {
namespace HOL_ISA {

// Backward substitution: s becomes the correction of tau.
static inline void descend(const SegmentBlock &s, const NewtonSegments &x, vec next) {
    const vec ts = x.summary->t;
    if (s.own_max < s.block.n) x.s[s.own_max] = keep(ends_at(s, s.own_max), next);
    vec t = next;
    long k = s.own_max - 1;
    for (; k >= s.own_min; --k) {
        t = mul_add(x.fP[k], ts, mul_add(x.up[k], t, x.s[k]));
        t = select(ends_at(s, k), next, t);
        x.s[k] = t;
    }
    for (; k >= 1; --k) {
        t = mul_add(x.fP[k], ts, mul_add(x.up[k], t, x.s[k]));
        x.s[k] = t;
    }
    x.s[0] = ts;
    if (s.last >= 0)
        for (long i = s.own[s.last]; i < s.block.n; ++i) x.s[i][s.last] = 0;
}

// Moves the bonds by the corrections in s, finds what is left of D.D - a^2 and, with `ascend`, substitutes that
// forward. Returns the largest error of each lane.
template <bool uniform_w, bool uniform_a, bool ascend>
HOL_NOINLINE vec move_segments(const SegmentBlock &s, const Lane &lane, const NewtonSegments &x, const vec3 &previous) {
    const vec a2_uniform = splat(lane.length_uniform * lane.length_uniform);
    vec c = x.s[0], w = w_at<uniform_w>(s.block, 0), worst = {}, poison = {};
    vec3 p = {c * x.b[0].x, c * x.b[0].y, c * x.b[0].z};
    vec3 left = {w * (p.x - previous.x), w * (p.y - previous.y), w * (p.z - previous.z)};
    const auto moved = [&](long k, bool ragged) HOL_FORCED {
        x.tau[k] = x.tau[k] + c;
        w = w_at<uniform_w>(s.block, k + 1);
        vec3 p1 = {};
        if (!ragged || k + 1 < s.block.n) {
            c = x.s[k + 1];
            p1 = {c * x.b[k + 1].x, c * x.b[k + 1].y, c * x.b[k + 1].z};
        }
        const vec3 right = {w * (p1.x - p.x), w * (p1.y - p.y), w * (p1.z - p.z)};
        vec3 &d = x.D[k];
        d = {d.x + (right.x - left.x), d.y + (right.y - left.y), d.z + (right.z - left.z)};
        p = p1;
        left = right;
        const vec a2 = uniform_a ? a2_uniform : a2_of(s, lane, k);
        vec sigma = half_excess(d, a2);
        if (ragged && k >= s.own_min) sigma = keep(owned(s, k), sigma);
        worst = max(uniform_a ? abs(sigma) : abs(sigma) / a2, worst);
        return sigma;
    };
    Ascent a = {vec{}, vec{}, x.summary->first_up};
    x.summary->s = moved(0, false);
    long k = 1;
    for (; k + 1 < s.own_min; ++k) {
        const vec sigma = moved(k, false);
        if (ascend)
            a.bond(s, x, k, sigma, false);
        else
            poison = mul_add(sigma, vec{}, poison);
    }
    for (; k < s.own_max; ++k) {
        const vec sigma = moved(k, true);
        if (ascend)
            a.bond(s, x, k, sigma, true);
        else
            poison = mul_add(sigma, vec{}, poison);
    }
    if (s.own_max < s.block.n) x.tau[s.own_max] = x.tau[s.own_max] + c;
    if (ascend) poison = x.summary->y + x.summary->T;  // max() may lose a NaN, sums keep it
    return mul_add(poison + x.summary->s, vec{}, 2.0 * (uniform_a ? worst / a2_uniform : worst));
}

template <bool ascend>
static inline vec move_segments(const SegmentBlock &s, const Lane &lane, const NewtonSegments &x,
                                const vec3 &previous) {
    if (s.block.uniform_w)
        return lane.length ? move_segments<true, false, ascend>(s, lane, x, previous)
                           : move_segments<true, true, ascend>(s, lane, x, previous);
    return lane.length ? move_segments<false, false, ascend>(s, lane, x, previous)
                       : move_segments<false, true, ascend>(s, lane, x, previous);
}

}  // namespace HOL_ISA
}  // namespace holonomic
#endif
