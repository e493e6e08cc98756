// Reading W segments of a long chain: bond vectors and right-hand sides. Segments lie equally far apart in each array,
// so that one address per array does for all lanes.
#ifndef HOLONOMIC_KERNELS_MEMORY_SEGMENTS_HPP
#define HOLONOMIC_KERNELS_MEMORY_SEGMENTS_HPP

#include <stdint.h>

#include "core/kernels/arithmetic/image.hpp"
#include "core/kernels/memory/cut.hpp"
#include "core/kernels/memory/packed.hpp"

namespace holonomic {
namespace HOL_ISA {

// Bond vectors and right-hand sides of W segments: in the caller's arrays, or as they were put into scratch.
struct SegmentBonds {
    Packed r, v, f;
    const vec3 *D, *low;
    const vec *B;
    vec3 next, next_low;  // the separators behind the segments
    long full;            // bonds that all lanes have, a multiple of `group`: read from the caller's arrays. Only those
                          // behind them are in D, low and B, unless `terms` is in_scratch
};

constexpr int in_scratch = -1;  // Terms: all bonds are in D, low and B
HOL_INLINE uintptr_t bytes_between(const double *from, const double *to) {
    return reinterpret_cast<uintptr_t>(to) - reinterpret_cast<uintptr_t>(from);
}

HOL_INLINE const double *shifted(const double *p, uintptr_t bytes) {
    return reinterpret_cast<const double *>(reinterpret_cast<uintptr_t>(p) + bytes);
}

// Where the segments of a block are read: all at the same distance from one another, in each array.
struct SegmentPlaces {
    const double *r;
    uintptr_t lane, v, f;  // from a segment to the next one; from r to v and f
    vec mass;
};

// Bonds k0 .. k0 + W - 1 from the caller's arrays, and their right-hand sides.
template <int terms, bool uniform>
HOL_INLINE void load_segments(const Block &block, const SegmentPlaces &at, long k0, vec3 *d3, vec *b) {
    vec *const d = &d3->x;
#pragma GCC unroll 3
    for (int j = 0; j < 3; ++j) {
        vec e[W], p[W];
#pragma GCC unroll 8
        for (int i = 0; i < W; ++i) {
            const double *const r = shifted(at.r + 3 * k0 + W * j, static_cast<uintptr_t>(i) * at.lane);
            const double *const v = shifted(r, at.v), *const f = shifted(r, at.f);
            e[i] = load(r + 3) - load(r);
            vec dv = {}, df = {};
            if (terms & (velocity_squared | rate)) dv = load(v + 3) - load(v);
            if (terms & force_difference) {
                if (uniform) {
                    df = load(f + 3) - load(f);
                } else {
                    const double *const w3 = block.w3[i] + 3 * k0 + W * j;
                    df = load(w3 + 3) * load(f + 3) - load(w3) * load(f);
                }
            }
            if (terms & rate)
                p[i] = dv * e[i];
            else if (terms == (velocity_squared | force_difference))
                p[i] = mul_add(df, e[i], (uniform ? at.mass * dv : dv) * dv);
            else if (terms & force_difference)
                p[i] = df * e[i];
            else
                p[i] = (uniform ? at.mass * dv : dv) * dv;
        }
        transpose(e);
#pragma GCC unroll 8
        for (int i = 0; i < W; ++i) d[j * W + i] = e[i];
        if (terms) transpose(p);
#pragma GCC unroll 8
        for (int i = 0; i < W; ++i) {
            const int element = j * W + i;  // of the W bonds' components, one after the other
            if (element % 3 == 0)
                b[element / 3] = terms ? p[i] : vec{};
            else if (terms)
                b[element / 3] = b[element / 3] + p[i];
        }
    }
}

// Bonds k0 .. k0 + group - 1.
template <int terms, bool uniform>
HOL_INLINE void load_group(const Block &block, const SegmentBonds &in, const SegmentPlaces &at, long k0, vec3 *d,
                           vec *b) {
    if constexpr (terms == in_scratch) {
        for (int i = 0; i < group; ++i) {
            d[i] = in.D[k0 + i];
            b[i] = in.B[k0 + i];
        }
    } else {
        for (int c = 0; c < group; c += W) load_segments<terms, uniform>(block, at, k0 + c, d + c, b + c);
    }
}

// The bonds k0 .. k0 + W - 1 where lanes may end: those past the end of a lane are inert.
template <int terms, bool uniform, bool boxed>
HOL_INLINE void load_ragged_chunk_of(const Block &block, const Box &box, const Packed &r, const Packed &v,
                                     const Packed &f, long k0, vec3 *D, vec *B) {
    double buffer[3][W][3 * W + 3];
    const double *pr[W], *pv[W], *pf[W];
    for (int i = 0; i < W; ++i) {
        pr[i] = window(r.lane[i], k0, block.len[i], false, buffer[0][i]);
        if (terms & (velocity_squared | rate)) pv[i] = window(v.lane[i], k0, block.len[i], false, buffer[1][i]);
        if (terms & force_difference) pf[i] = window(f.lane[i], k0, block.len[i], false, buffer[2][i]);
    }
    load_chunk<terms, uniform, boxed, false>(block, box, k0, pr, pv, pf, D, nullptr, B);
    for (long b = 0; b < W; ++b) {
        const mask live = less(splat(static_cast<double>(k0 + b)), block.lengths());
        D[b] = {select(live, D[b].x, splat(1.0)), keep(live, D[b].y), keep(live, D[b].z)};
        B[b] = keep(live, B[b]);
    }
}

template <int terms, bool uniform>
HOL_NOINLINE void load_tail(const Block &block, const Box &box, const Packed &r, const Packed &v, const Packed &f,
                            long k0, vec3 *D, vec *B) {
    for (; k0 < block.n; k0 += W, D += W, B += W)
        load_ragged_chunk_of<terms, uniform, false>(block, box, r, v, f, k0, D, B);
}

// Bond vectors of the separators behind the segments.
static inline void find_next(const SegmentBlock &s, const Box &box, const Packed &r, SegmentBonds &in) {
    in.next = in.next_low = vec3{};
    for (int i = 0; i < W; ++i) {
        if (i == s.last) {
            in.next.x[i] = 1;
            continue;
        }
        const double *p = r.lane[i] + 3 * s.own[i];
        Vector3<double> d, low;
        unrounded_bond(box, p, p + 3, d, low);
        in.next.x[i] = d.x;
        in.next.y[i] = d.y;
        in.next.z[i] = d.z;
        in.next_low.x[i] = low.x;
        in.next_low.y[i] = low.y;
        in.next_low.z[i] = low.z;
    }
}

}  // namespace HOL_ISA
}  // namespace holonomic
#endif
