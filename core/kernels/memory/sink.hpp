// Where the vectors per atom of a block go. A sink takes what is found for a lane as it stands in memory, W components
// from component e of the lane's atoms on or a single one; chunks are transposed here, and cut where lanes end. Sinks
// hold what they need by value: for all that the compiler knows, a store to the caller's arrays changes what is behind
// a reference, which took 4 more instructions a bond of positions.
#ifndef HOLONOMIC_KERNELS_MEMORY_SINK_HPP
#define HOLONOMIC_KERNELS_MEMORY_SINK_HPP

#include "core/kernels/arithmetic/vector3.hpp"
#include "core/kernels/memory/block.hpp"

namespace holonomic::HOL_ISA {

enum Update { write_, add_ };

// An array per atom that is written, or added to.
template <Update update>
struct AtomSink {
    Packed out;
    HOL_FORCED void row(int lane, long e, vec x) const {
        double *const p = out.lane[lane] + e;
        store(p, update == add_ ? load(p) + x : x);
    }
    HOL_FORCED void component(int lane, long e, double x) const {
        double &p = out.lane[lane][e];
        p = update == add_ ? p + x : x;
    }
};

// Moves of atoms: added to r, and as a rate to v; either, or both.
template <bool to_r, bool to_v>
struct MoveSink {
    Packed r, v;
    vec per_dt;
    HOL_FORCED void row(int lane, long e, vec x) const {
        if (to_r) store(r.lane[lane] + e, load(r.lane[lane] + e) + x);
        if (to_v) store(v.lane[lane] + e, mul_add(x, per_dt, load(v.lane[lane] + e)));
    }
    HOL_FORCED void component(int lane, long e, double x) const {
        if (to_r) r.lane[lane][e] = r.lane[lane][e] + x;
        if (to_v) v.lane[lane][e] = mul_add(x, per_dt[0], v.lane[lane][e]);
    }
};

// Gives the sink W consecutive atoms of all lanes, from atom k0 on: value[3 W], component by component, transposed in
// place.
template <class Sink>
HOL_INLINE void store_chunk(long k0, vec *value, const Sink &sink) {
    HOL_UNROLL
    for (int j = 0; j < 3; ++j) {
        transpose(value + j * W);
        for (int i = 0; i < W; ++i) sink.row(i, 3 * k0 + j * W, value[j * W + i]);
    }
}

// The same where lanes may end, or be left out.
template <class Sink>
HOL_INLINE void store_ragged(const Block &block, long k0, vec *value, unsigned chosen, const Sink &sink) {
    for (int j = 0; j < 3; ++j) transpose(value + j * W);
    for (int i = 0; i < block.lanes; ++i) {
        if (!(chosen >> i & 1)) continue;
        long e = 3 * k0, left = 3 * (block.len[i] + 1 - k0);
        for (int j = 0; j < 3 && left > 0; ++j, left -= W, e += W) {
            const vec x = value[j * W + i];
            if (left >= W)
                sink.row(i, e, x);
            else
                for (long c = 0; c < left; ++c) sink.component(i, e + c, x[c]);
        }
    }
}

// Atom 0 of the chosen lanes.
template <class Sink>
HOL_INLINE void store_first(const vec3 &a, unsigned chosen, const Sink &sink) {
    for (int i = 0; i < W; ++i) {
        if (!(chosen >> i & 1)) continue;
        sink.component(i, 0, a.x[i]);
        sink.component(i, 1, a.y[i]);
        sink.component(i, 2, a.z[i]);
    }
}

}  // namespace holonomic::HOL_ISA
#endif
