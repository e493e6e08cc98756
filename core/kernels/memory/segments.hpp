// Reads bond vectors and right-hand sides of W segments of a long chain.
#ifndef HOLONOMIC_KERNELS_MEMORY_SEGMENTS_HPP
#define HOLONOMIC_KERNELS_MEMORY_SEGMENTS_HPP

#include <stdint.h>

#include "core/kernels/arithmetic/image.hpp"
#include "core/kernels/memory/cut.hpp"
#include "core/kernels/memory/packed.hpp"

namespace holonomic::HOL_ISA {

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

// Bonds k0 .. k0 + group - 1.
template <int terms, bool uniform>
HOL_INLINE void load_group(const Block &block, const Box &box, const SegmentBonds &in, const EvenRows &rows, long k0,
                           vec3 *d, vec *b) {
    if constexpr (terms == in_scratch) {
        for (int i = 0; i < group; ++i) {
            d[i] = in.D[k0 + i];
            b[i] = in.B[k0 + i];
        }
    } else {
        constexpr int all = uniform ? terms : terms | unit_mass;
        for (int c = 0; c < group; c += W)
            load_chunk<all, uniform, false, false>(block, box, k0 + c, rows.from(k0 + c), d + c, nullptr, b + c);
    }
}

template <int terms, bool uniform>
HOL_NOINLINE void load_tail(const Block &block, const Box &box, const Packed &r, const Packed &v, const Packed &f,
                            long k0, vec3 *D, vec *B) {
    for (; k0 < block.n; k0 += W, D += W, B += W)
        load_ragged<terms, uniform, false, false>(block, box, r, v, f, k0, D, nullptr, B);
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

}  // namespace holonomic::HOL_ISA
#endif
