// Where the vectors per atom of a block go. A sink takes what is found for a lane as it stands in memory, from
// component e of the lane's atoms on: a row of W, two, or a single one. Chunks are transposed here, and cut where lanes
// end. Sinks hold what they need by value: for all that the compiler knows, a store to the caller's arrays changes what
// is behind a reference, which took 4 more instructions a bond of positions.
#ifndef HOLONOMIC_KERNELS_MEMORY_SINK_HPP
#define HOLONOMIC_KERNELS_MEMORY_SINK_HPP

#include "core/kernels/arithmetic/vector3.hpp"
#include "core/kernels/memory/block.hpp"

namespace holonomic::HOL_ISA {

enum Update { write_, add_ };

// Lanes that are equally far apart, as the compiler knows: in place of Packed.
template <long distance>
struct EvenLanes {
    struct {
        double *first;
        HOL_FORCED double *operator[](int i) const { return first + distance * i; }
    } lane;
};

// An array per atom that is written, or added to.
template <Update update, class Lanes = Packed>
struct AtomSink {
    Lanes out;
    template <class V>
    HOL_FORCED void put(int lane, long e, V x) const {
        double *const p = out.lane[lane] + e;
        store_any(p, update == add_ ? load_any<V>(p) + x : x);
    }
};

// Moves of atoms: added to r, and as a rate to v; either, or both.
template <bool to_r, bool to_v, class Lanes = Packed>
struct MoveSink {
    Lanes r, v;
    double per_dt;
    template <class V>
    HOL_FORCED void put(int lane, long e, V x) const {
        if (to_r) store_any(r.lane[lane] + e, load_any<V>(r.lane[lane] + e) + x);
        if (to_v) store_any(v.lane[lane] + e, mul_add(x, V{} + per_dt, load_any<V>(v.lane[lane] + e)));
    }
};

// Gives the sink W consecutive atoms of all lanes, from atom k0 on: value[3 W], component by component, transposed in
// place.
template <class Sink>
HOL_INLINE void store_chunk(long k0, vec *value, const Sink &sink) {
    HOL_UNROLL
    for (int j = 0; j < 3; ++j) {
        transpose(value + j * W);
        for (int i = 0; i < W; ++i) sink.put(i, 3 * k0 + j * W, value[j * W + i]);
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
                sink.put(i, e, x);
            else
                for (long c = 0; c < left; ++c) sink.put(i, e + c, x[c]);
        }
    }
}

// Atom 0 of the chosen lanes.
template <class Sink>
HOL_INLINE void store_first(const vec3 &a, unsigned chosen, const Sink &sink) {
    for (int i = 0; i < W; ++i) {
        if (!(chosen >> i & 1)) continue;
        sink.put(i, 0, a.x[i]);
        sink.put(i, 1, a.y[i]);
        sink.put(i, 2, a.z[i]);
    }
}

}  // namespace holonomic::HOL_ISA
#endif
