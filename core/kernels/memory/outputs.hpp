// Where the results of a block go: vectors per atom to sinks, values per bond, and the virial.
//
// A sink takes what is found for a lane as it stands in memory, from component e of the lane's atoms on: a row of W,
// two, or a single one. Chunks are transposed here, and cut where lanes end. Sinks hold what they need by value: for
// all that the compiler knows, a store to the caller's arrays changes what is behind a reference, which took 4 more
// instructions a bond of positions.
#pragma once

#include "core/kernels/arithmetic/vector3.hpp"
#include "core/kernels/arithmetic/virial.hpp"
#include "core/kernels/call.hpp"
#include "core/kernels/memory/block.hpp"
#include "core/kernels/memory/fours.hpp"

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

// Writes the values of the bonds k0 .. k0 + W - 1 of the chosen lanes; value[W] is transposed in place. ragged: lanes
// may end there.
template <bool ragged>
HOL_INLINE void store_values(const Block &block, long k0, vec *value, unsigned chosen, double *out) {
    transpose(value);
    for (int i = 0; i < (ragged ? block.lanes : W); ++i) {
        double *const p = out + block.first_bond[i] + k0;
        if (ragged && !(chosen >> i & 1)) continue;
        if (!ragged || k0 + W <= block.len[i])
            store(p, value[i]);
        else
            for (long k = k0; k < block.len[i]; ++k) p[k - k0] = value[i][k - k0];
    }
}

// Writes factor times a value per bond, for the bonds first .. n - 1 of the lanes in `which`; zeros as +0.
void store_bonds(const Block &, const vec *value, vec factor, mask which, double *out, long first = 0);

// Gives the sink the pulls on the atoms first .. n of the lanes in `which`, times w_i if there are `w`. `before` is t d
// of the bond before atom `first`.
template <class Sink>
static void store_pulls(const Block &block, const vec *w, const vec3 *d, const vec *t, mask which, const Sink sink,
                        long first = 0, vec3 before = vec3{}) {
    const unsigned chosen = bits(which & block.in_use());
    const auto pull = [&](long k, bool weigh, const vec3 &after, vec *value) HOL_FORCED {
        vec3 g = after - before;
        if (weigh) g = w[k] * g;
        value[0] = g.x;
        value[1] = g.y;
        value[2] = g.z;
        before = after;
    };
    long k0 = first;
    const auto whole_chunks = [&](bool weigh) HOL_FORCED {
        for (; k0 + W <= block.n_min; k0 += W) {
            vec value[3 * W];
            for (int a = 0; a < W; ++a) pull(k0 + a, weigh, t[k0 + a] * d[k0 + a], value + 3 * a);
            store_chunk(k0, value, sink);
        }
    };
#if HOL_FOURS
    if (chosen == all_lanes && first + 4 < block.n) {
        vec value[3];
        pull(first, w != nullptr, t[first] * d[first], value);
        store_chunk(first, value, sink);
        k0 = pulls_in_fours(first + 1, block.n, d, t, [&](long k, auto j, four g) HOL_FORCED {
            sink.put(0, 3 * k + 4 * j, w ? spread<j>(load_four(w + k)) * g : g);
        });
        before = t[k0 - 1] * d[k0 - 1];
    }
#endif
    if (chosen == all_lanes) w ? whole_chunks(true) : whole_chunks(false);
    for (; k0 <= block.n; k0 += W) {
        vec value[3 * W] = {};
        for (int a = 0; a < W && k0 + a <= block.n; ++a)
            pull(k0 + a, w != nullptr, k0 + a < block.n ? t[k0 + a] * d[k0 + a] : vec3{}, value + 3 * a);
        store_ragged(block, k0, value, chosen, sink);
    }
}

// To an array per atom.
void store_pulls(const Block &, const vec3 *d, const vec *t, mask which, Update, const Packed &out);

// Of W lanes.
struct VirialSum : BondTensors<vec> {
    // Counts factor times that of the lanes in `which`.
    void count(mask which, vec factor, Tally &tally) const {
        for (int c = 0; c < 6; ++c) tally.virial[c] -= sum_lanes(keep(which, factor * sum[c]));
    }
};

void add_virial(long n, const vec3 *d, const vec *t, mask which, vec factor, Tally &);

}  // namespace holonomic::HOL_ISA
