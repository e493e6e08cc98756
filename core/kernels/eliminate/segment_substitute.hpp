// Acceleration and velocity level of one long chain, once its separators are solved for: substitute inside the segments
// from their ends to their beginnings, and store what comes out.
#ifndef HOLONOMIC_KERNELS_ELIMINATE_SEGMENT_SUBSTITUTE_HPP
#define HOLONOMIC_KERNELS_ELIMINATE_SEGMENT_SUBSTITUTE_HPP

#include "core/kernels/eliminate/segment.hpp"
#include "core/kernels/memory/prefetch.hpp"
#include "core/kernels/memory/pulls.hpp"

namespace holonomic::HOL_ISA {

// Copies staged segments back: the atoms that the lane wrote.
static inline void close_segments(const AtomArray &array, const SegmentBlock &s, const Lane &lane, const Packed &packed,
                                  bool add) {
    if (in_place(array, lane)) return;
    for (int i = 0; i < W; ++i) {
        const long first = s.begins && i == 0 ? 0 : 1;
        unstage(array, lane, s.from[i] + first, s.own[i] - first, packed.lane[i] + 3 * first, add);
    }
}

// What is to be written of W segments.
struct SegmentOutputs {
    Packed pulls;  // per atom
    bool has_pulls;
    double *lambda, *tension;
    vec lambda_factor;
    double virial_factor;
    bool virial;
};

// The bonds k0 .. k0 + W - 1 with their t, once those behind them are done; `after` is t d of bond k0 + W, then of k0.
template <bool weighted, bool uniform, Update update, bool ragged>
HOL_INLINE void store_segment_chunk(const Block &own, const SegmentOutputs &out, long k0, const vec3 *d, const vec *t,
                                    vec3 &after, VirialSum &sum) {
    const vec zero = {};  // added to products: a zero is +0, and so are differences of such
    if (out.lambda) {
        vec value[W];
        for (int b = 0; b < W; ++b) value[b] = mul_add(out.lambda_factor, t[b], zero);
        store_values<ragged>(own, k0, value, all_lanes, out.lambda);
    }
    if (out.tension) {
        vec value[W];
        for (int b = 0; b < W; ++b) value[b] = mul_add(t[b], sqrt(dot(d[b], d[b])), zero);
        store_values<ragged>(own, k0, value, all_lanes, out.tension);
    }
    if (!out.has_pulls && !out.virial) return;
    vec value[3 * W];
    for (int b = W - 1; b >= 0; --b) {
        const vec3 p = {mul_add(t[b], d[b].x, zero), mul_add(t[b], d[b].y, zero), mul_add(t[b], d[b].z, zero)};
        vec3 g = after - p;
        if (weighted && !uniform) g = (ragged && k0 + b + 1 > own.n ? vec{} : own.w[k0 + b + 1]) * g;
        value[3 * b] = g.x;
        value[3 * b + 1] = g.y;
        value[3 * b + 2] = g.z;
        if (out.virial && !(ragged && k0 + b >= own.n)) sum.add(d[b], p);
        after = p;
    }
    if (!out.has_pulls) return;
    const AtomSink<update> sink = {out.pulls};
    if (ragged)
        store_ragged(own, k0 + 1, value, all_lanes, sink);
    else
        store_chunk(k0 + 1, value, sink);
}

// Blocks are substituted in from the last to the first, so that those which were eliminated last are still in cache.
// What the others need takes twice as long to read unless it is fetched early: so in chains of more bonds than these.
constexpr int64_t long_in_cache = 65536;

// Distances from a block to the one before it, in vectors per atom and in what is kept of the bonds.
static inline void find_block_before(const Cut &cut, int64_t j, SegmentBlock &s) {
    static_assert(sizeof(Kept) == 3 * sizeof(vec), "as far apart as vectors of W atoms");
    if (j == 0) {
        s.block.ahead = cut.to_atoms_before;
        s.kept_ahead = cut.to_kept_before;
    } else if (cut.n_bonds > long_in_cache) {
        s.block.ahead = s.kept_ahead = -3 * W * cut.rows(j - 1);
    }
}

// Fetches what the block before this one needs, when this one is at bond k0.
template <Update update>
HOL_INLINE void fetch_before(const SegmentBlock &s, const SegmentBonds &in, const SegmentStore &x,
                             const SegmentOutputs &out, long k0) {
    fetch_ahead(in.r.lane[0], k0, s.block.ahead);
    fetch_ahead(reinterpret_cast<const double *>(x.kept), k0, s.kept_ahead);
    if (update == add_ && out.has_pulls) fetch_ahead(out.pulls.lane[0], k0, s.block.ahead);
}

// Atoms 1 .. own of each segment, and atom 0 of a chain that begins here.
template <bool weighted, bool uniform, bool boxed, Update update>
HOL_NOINLINE void finish_segments(const SegmentBlock &s, const Box &box, const SegmentBonds &in, const SegmentStore &x,
                                  vec next, const SegmentOutputs &out, Tally &tally) {
    const Block own = own_block(s);
    const long n = s.own_max, full = s.own_min / W * W;
    const vec ts = x.summary->t;
    vec t = next, value[W], unused[W];
    vec3 after = next * in.next, d[W];
    VirialSum sum;
    long k0 = (n - 1) / W * W;
    for (; k0 >= full; k0 -= W) {
        for (int b = W - 1; b >= 0; --b) {
            const long k = k0 + b;
            if (k == 0)  // a lane of fewer than W bonds: its separator is in this chunk
                t = ts;
            else if (k < n)
                t = mul_add(x.kept[k].l, t, mul_add(x.kept[k].fP, ts, x.kept[k].u));
            value[b] = k <= n ? t : vec{};
        }
        load_ragged<none_, true, boxed, false>(own, box, in.r, in.r, in.r, k0, d, nullptr, unused);
        if (n - k0 < W) d[n - k0] = in.next;  // the separators behind the segments
        store_segment_chunk<weighted, uniform, update, true>(own, out, k0, d, value, after, sum);
    }
    const EvenRows at(in.r, in.r, in.r);
    for (; k0 >= 0; k0 -= W) {
        if (s.block.ahead) fetch_before<update>(s, in, x, out, k0);
        for (int b = W - 1; b > 0; --b) {
            const Kept &p = x.kept[k0 + b];
            t = mul_add(p.l, t, mul_add(p.fP, ts, p.u));
            value[b] = t;
        }
        if (k0 > 0)
            t = mul_add(x.kept[k0].l, t, mul_add(x.kept[k0].fP, ts, x.kept[k0].u));
        else
            t = ts;
        value[0] = t;
        load_chunk<none_, true, boxed, false>(own, box, k0, at.from(k0), d, nullptr, unused);
        store_segment_chunk<weighted, uniform, update, false>(own, out, k0, d, value, after, sum);
    }
    if (out.virial) sum.count(~none(), splat(out.virial_factor), tally);
    if (!s.begins || !out.has_pulls) return;
    if (weighted && !uniform) after = own.w[0] * after;
    store_first({after.x + 0.0, after.y + 0.0, after.z + 0.0}, 1, AtomSink<update>{out.pulls});
}

// Substitutes in block j and writes; `pulled` gets what its atoms are pulled with.
template <bool weighted>
static inline void finish_block(const Box &box, const AtomArray &r, const AtomArray &pulled, bool add,
                                SegmentOutputs out, const Cut &cut, const Lane &lane, int64_t j, double *store,
                                Arena arena, Tally &tally) {
    SegmentBlock s = segment_block(cut, j, lane);
    if (weighted) set_masses(s.block, s.lane, arena);
    if (in_place(r, lane)) find_block_before(cut, j, s);
    SegmentBonds in = {};
    in.r = open(r, s.block, s.lane, arena, true);
    find_next(s, box, in.r, in);
    const SegmentStore x(store, cut, j);
    vec next;
    for (int i = 0; i + 1 < W; ++i) next[i] = x.summary->t[i + 1];
    next[W - 1] = s.last < 0 ? x.summary[1].t[0] : 0.0;
    out.has_pulls = pulled.x != nullptr;
    out.pulls = open(pulled, s.block, s.lane, arena, false);
    choose(
        [&](auto uniform, auto boxed, auto adds) {
            finish_segments<weighted, !weighted || uniform, boxed, adds ? add_ : write_>(s, box, in, x, next, out,
                                                                                         tally);
        },
        !weighted || s.block.uniform_w, box.shape != Box::none, in_place(pulled, lane) && add);
    if (out.has_pulls) close_segments(pulled, s, lane, out.pulls, add);
}

}  // namespace holonomic::HOL_ISA
#endif
