// Position level of one long chain in segments: the elimination of eliminate/segment.hpp with the unsymmetric Jacobian
// of sweeps.hpp. f splits into the coupling of the rows to the separator (down) and of the separator to them (up).
//
// An iteration with the factors at hand goes through the blocks once, in any order: `step_segments` substitutes
// backward, moves the bonds and substitutes forward what that leaves of their lengths. In between the separators are
// joined. `factorize_segments` eliminates anew.
#ifndef HOLONOMIC_KERNELS_NEWTON_SEGMENTS_HPP
#define HOLONOMIC_KERNELS_NEWTON_SEGMENTS_HPP

#include "core/kernels/eliminate/remainder.hpp"
#include "core/kernels/memory/cut.hpp"
#include "core/kernels/memory/packed.hpp"
#include "core/kernels/newton/decisions.hpp"

namespace holonomic {
namespace HOL_ISA {

struct NewtonSummary {
    vec E, a, c, down, up;         // what the elimination leaves; `up` starts from
    vec first_up;                  // the coupling of the separator to its neighbour
    vec s, y, T;                   // and the forward substitution; s: right-hand side of the separator
    vec last_u, last_fP, last_up;  // of each segment's last bond
    vec3 last_b;
    vec P, join_down, join_up;  // pivots and multipliers of the separators
    vec t;                      // their corrections
    vec3 last;                  // correction times b of each segment's last bond
    vec error;                  // largest |D.D - a^2| / a^2 of the segment
};

struct NewtonSegments {
    vec3 *b, *D;
    vec *rP, *down, *up, *fP, *s, *tau;
    NewtonSummary *summary;
    static constexpr int64_t head = static_cast<int64_t>(sizeof(NewtonSummary) / sizeof(vec));
    static int64_t vectors(int64_t longest) { return 12 * (longest + 1) + head; }
    NewtonSegments(double *store, int64_t longest, int64_t block) {
        const int64_t n = longest + 1;
        vec *p = reinterpret_cast<vec *>(store) + block * vectors(longest);
        summary = reinterpret_cast<NewtonSummary *>(p);
        p += head;
        b = reinterpret_cast<vec3 *>(p);
        D = reinterpret_cast<vec3 *>(p + 3 * n);
        rP = p + 6 * n;
        down = rP + n;
        up = down + n;
        fP = up + n;
        s = fP + n;
        tau = s + n;
    }
};

HOL_INLINE vec a2_of(const SegmentBlock &s, const Lane &lane, long k) {
    if (!lane.length) return splat(lane.length_uniform * lane.length_uniform);
    vec a2;
    for (int i = 0; i < W; ++i) {
        const double a = k < s.own[i] ? lane.length[s.from[i] + k] : 1.0;
        a2[i] = a * a;
    }
    return a2;
}

HOL_INLINE mask owned(const SegmentBlock &s, long k) {
    mask m;
    for (int i = 0; i < W; ++i) m[i] = k < s.own[i] ? -1 : 0;
    return m;
}

HOL_INLINE vec half_excess(const vec3 &d, vec a2) {
    return 0.5 * mul_add(d.z, d.z, mul_add(d.y, d.y, mul_add(d.x, d.x, -a2)));
}

// The largest error of each segment, as the bonds are loaded.
static inline void segment_errors(const SegmentBlock &s, const Lane &lane, const NewtonSegments &x) {
    vec worst = {}, poison = {};
    for (long k = 0; k < s.own_max; ++k) {
        const vec a2 = a2_of(s, lane, k);
        vec sigma = half_excess(x.D[k], a2);
        if (k >= s.own_min) sigma = keep(owned(s, k), sigma);
        if (k == 0) x.summary->s = sigma;
        worst = max(lane.length ? abs(sigma) / a2 : abs(sigma), worst);
        poison = mul_add(sigma + dot(x.D[k], x.b[k]), vec{}, poison);  // reference positions are bad data, too
    }
    x.summary->error = 2.0 * (lane.length ? worst : worst / a2_of(s, lane, 0)) + poison;
    for (int i = 0; i < W; ++i) {
        const long k = s.own[i] - 1;
        x.summary->last_b.x[i] = x.b[k].x[i];
        x.summary->last_b.y[i] = x.b[k].y[i];
        x.summary->last_b.z[i] = x.b[k].z[i];
    }
}

// The value of the next segment's first bond for each lane, from arrays [first bond] of this and the next block.
static inline vec next_of(const vec here, bool has_next, double beyond) {
    vec next;
    for (int i = 0; i + 1 < W; ++i) next[i] = here[i + 1];
    next[W - 1] = has_next ? beyond : 0.0;
    return next;
}

template <bool uniform>
HOL_NOINLINE void eliminate_segments(const SegmentBlock &s, const NewtonSegments &x, bool careful) {
    const Block &block = s.block;
    NewtonSummary sum = *x.summary;
    vec w = w_at<uniform>(block, 1), q = dot(x.D[1], x.b[1]);
    Column e = {w * q, splat(1.0)};
    Column ac = {(w * w) * dot(cross(x.D[0], x.D[1]), cross(x.b[0], x.b[1])), w * dot(x.D[0], x.b[0])};
    vec f_down = w * dot(x.D[1], x.b[0]), f_up = w * dot(x.D[0], x.b[1]);
    sum.first_up = f_up;
    for (long k = 1; k < s.own_max; ++k) {
        w = w_at<uniform>(block, k + 1);
        const vec wq = w * q, F1 = e.next(wq), c1 = ac.next(wq), rF = splat(1.0) / F1, rP = e.F * rF;
        x.rP[k] = rP;
        x.fP[k] = f_down * rP;
        if (k + 1 < block.n) {
            const vec q1 = dot(x.D[k + 1], x.b[k + 1]);
            vec lower = dot(x.D[k + 1], x.b[k]), upper = dot(x.D[k], x.b[k + 1]);
            // Where the cross products are needed, the first attempt does not converge as it should.
            vec X =
                careful ? dot(cross(x.D[k], x.D[k + 1]), cross(x.b[k], x.b[k + 1])) : mul_add(q, q1, -(lower * upper));
            if (k + 1 >= block.n_min) {
                const mask m = joint(block, k + 1);
                lower = keep(m, lower);
                upper = keep(m, upper);
                X = keep(m, X);
            }
            const vec wP = w * rP, wwX = w * (w * X), wq1 = w * q1;
            x.down[k] = wP * lower;
            x.up[k] = wP * upper;
            f_down = x.down[k] * f_down;
            f_up = x.up[k] * f_up;
            e.pass(F1, wwX, wq1);
            ac.pass(c1, wwX, wq1);
            q = q1;
        } else {
            e = {vec{}, F1};
            ac = {vec{}, c1};
        }
        if (k + 1 >= s.own_min) {
            const mask m = ends_at(s, k + 1);
            sum.E = select(m, e.A * rF, sum.E);
            sum.a = select(m, ac.A * rF, sum.a);
            sum.c = select(m, ac.F * rF, sum.c);
            sum.down = select(m, f_down, sum.down);
            sum.up = select(m, f_up, sum.up);
        }
        if (careful || (k & 3) == 0) {
            e = {e.A * rF, splat(1.0)};
            ac = {ac.A * rF, ac.F * rF};
        }
    }
    *x.summary = sum;
}

// One bond on the way up: u = y / P in place of the right-hand side.
struct Ascent {
    vec y, T, f;
    HOL_FORCED void bond(const SegmentBlock &s, const NewtonSegments &x, long k, vec sigma, bool ragged) {
        y = y + sigma;
        const vec u = y * x.rP[k];
        x.s[k] = u;
        T = mul_add(f, u, T);
        y = x.down[k] * y;
        f = x.up[k] * f;
        if (!ragged) return;
        const mask m = ends_at(s, k + 1);
        NewtonSummary &sum = *x.summary;
        sum.y = select(m, y, sum.y);
        sum.T = select(m, T, sum.T);
        sum.last_u = select(m, u, sum.last_u);
        sum.last_fP = select(m, x.fP[k], sum.last_fP);
        sum.last_up = select(m, x.up[k], sum.last_up);
    }
};

}  // namespace HOL_ISA
}  // namespace holonomic
#endif
