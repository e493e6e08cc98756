// Forces and velocities of long chains in segments. Arms of large molecules are done by the same two functions, so that
// they are compiled once.
#include "core/kernels/eliminate/segment.hpp"
#include "core/kernels/isa/choose.hpp"
#include "core/kernels/memory/open.hpp"
#include "core/kernels/memory/outputs.hpp"
#include "core/kernels/memory/prefetch.hpp"
#include "core/kernels/verbs/verbs.hpp"

namespace holonomic::HOL_ISA {

// Loads block j and eliminates its inner bonds. `strain` is added to rates, or nullptr.
template <int terms, bool uniform>
static inline void eliminate_loaded(const Box &box, const SegmentBlock &s, const Packed &r, const Packed &v,
                                    const Packed &f, bool careful, const SegmentStore &x, Arena arena,
                                    const double *strain) {
    const long n = s.own_max;
    SegmentBonds in = {r, v, f, nullptr, nullptr, nullptr, {}, {}, 0};
    find_next(s, box, r, in);
    const Block own = own_block(s);
    const auto vectors = [&] { return reinterpret_cast<vec3 *>(arena.vecs(3 * (n + W))); };
    vec3 *const D = vectors(), *const low = vectors();
    vec *const B = arena.vecs(n + W);
    const Source source = {&box, &in.r, nullptr, nullptr, nullptr, 0, s.block.len};
    in.D = D;
    in.low = low;
    in.B = B;
    in.full = careful ? 0 : s.own_min / group * group;
    if (careful || strain || box.shape != Box::none)
        return choose(
            [&](auto boxed, auto exactly) {
                load_bonds<terms, uniform, boxed, exactly>(own, box, r, v, f, D, low, B);
                for (long k = 0; strain && k < own.n; ++k) B[k] = B[k] + keep(joint(own, k), stretching(strain, D[k]));
                eliminate<in_scratch, uniform, exactly>(s.block, box, source, in, n, x);
            },
            box.shape != Box::none, careful);
    if (in.full < n) load_tail<terms, uniform>(own, box, r, v, f, in.full, D, B);
    eliminate<terms, uniform, false>(s.block, box, source, in, n, x);
}

void eliminate_block(int terms, const Box &box, const Cut &cut, const Lane &lane, int64_t j, const AtomArray &r,
                     const AtomArray &v, const AtomArray &f, bool careful, double *store, const Arena &memory,
                     const double *strain) {
    Arena arena = memory;
    SegmentBlock s = segment_block(cut, j, lane);
    set_masses(s.block, s.lane, arena);
    // All are in place or none is, so that the segments are equally far apart in each array.
    const Packed pr = open(r, s.block, s.lane, arena, true), pv = open(v, s.block, s.lane, arena, true);
    const Packed pf = open(f, s.block, s.lane, arena, true);
    const SegmentStore x(store, cut, j);
    const auto go = [&](auto wanted) {
        choose([&](auto uniform) { eliminate_loaded<wanted, uniform>(box, s, pr, pv, pf, careful, x, arena, strain); },
               s.block.uniform_w);
    };
    if (terms == rate)
        go(Constant<int, rate>{});
    else
        choose_terms(go, terms & velocity_squared, terms & force_difference);
    if (x.past_cache) settle_stores();
}

// Solves for the separators. `careful` says how the segments were eliminated.
JoinResult long_join(const Lane &lane, bool careful, double *store) {
    const Cut cut(lane.n_bonds);
    Summary *const all = SegmentStore(store, cut, 0).summary;
    double E = 0, y = 0;
    for (int64_t j = 0; j < cut.blocks; ++j) {
        Summary &s = all[j];
        if (j == 0) E = relative_w(lane, 0) * s.q[0];
        if (any(s.doubt)) return careful ? join_bad : join_doubtful;
        for (int i = 0; i < W; ++i) {
            const double P = E + s.c[i], yhat = (y + s.b[i]) + s.T[i], S = s.E[i] * E + s.a[i];
            if (!careful && is_doubtful_join(s, i, S)) return join_doubtful;
            s.t[i] = yhat / P;
            s.up[i] = s.f[i] / P;
            E = S / P;
            y = s.y[i] + s.up[i] * yhat;
        }
    }
    double t = 0;
    for (int64_t j = cut.blocks - 1; j >= 0; --j) {
        Summary &s = all[j];
        for (int i = W - 1; i >= 0; --i) {
            t = j == cut.blocks - 1 && i == W - 1 ? s.t[i] : s.t[i] + s.up[i] * t;
            s.t[i] = t;
            if (!(t - t == 0)) return careful ? join_bad : join_doubtful;
        }
    }
    return join_good;
}

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
    const auto substituted = [&](long k) HOL_FORCED {
        const Kept &p = x.kept[k];
        return mul_add(p.l, t, mul_add(p.fP, ts, p.u));
    };
    long k0 = (n - 1) / W * W;
    for (; k0 >= full; k0 -= W) {
        for (int b = W - 1; b >= 0; --b) {
            const long k = k0 + b;
            if (k < n) t = k == 0 ? ts : substituted(k);  // k = 0: a lane of fewer than W bonds begins in this chunk
            value[b] = k <= n ? t : vec{};
        }
        load_ragged<none_, true, boxed, false>(own, box, in.r, in.r, in.r, k0, d, nullptr, unused);
        if (n - k0 < W) d[n - k0] = in.next;  // the separators behind the segments
        store_segment_chunk<weighted, uniform, update, true>(own, out, k0, d, value, after, sum);
    }
    const EvenRows at(in.r, in.r, in.r);
    for (; k0 >= 0; k0 -= W) {
        if (s.block.ahead) fetch_before<update>(s, in, x, out, k0);
        for (int b = W - 1; b > 0; --b) value[b] = t = substituted(k0 + b);
        value[0] = t = k0 > 0 ? substituted(k0) : ts;
        load_chunk<none_, true, boxed, false>(own, box, k0, at.from(k0), d, nullptr, unused);
        store_segment_chunk<weighted, uniform, update, false>(own, out, k0, d, value, after, sum);
    }
    if (out.virial) sum.count(~none(), splat(out.virial_factor), tally);
    if (!s.begins || !out.has_pulls) return;
    if (weighted && !uniform) after = own.w[0] * after;
    store_first({after.x + 0.0, after.y + 0.0, after.z + 0.0}, 1, AtomSink<update>{out.pulls});
}

void finish_block(bool weighted, const Box &box, const AtomArray &r, const AtomArray &pulled, bool add,
                  const SegmentOutputs &outputs, const Cut &cut, const Lane &lane, int64_t j, double *store,
                  const Arena &memory, Tally &tally) {
    Arena arena = memory;
    SegmentOutputs out = outputs;
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
        [&](auto boxed, auto adds) {
            constexpr Update update = adds ? add_ : write_;
            if (!weighted)
                finish_segments<false, true, boxed, update>(s, box, in, x, next, out, tally);
            else if (s.block.uniform_w)
                finish_segments<true, true, boxed, update>(s, box, in, x, next, out, tally);
            else
                finish_segments<true, false, boxed, update>(s, box, in, x, next, out, tally);
        },
        box.shape != Box::none, in_place(pulled, lane) && add);
    if (out.has_pulls) close_segments(pulled, s, lane, out.pulls, add);
}

void long_forces_eliminate(const ForcesCall &call, const Lane &lane, int64_t j, bool careful, double *store,
                           double *scratch) {
    eliminate_block((call.v.x ? velocity_squared : 0) | (call.f.x ? force_difference : 0), call.box, Cut(lane.n_bonds),
                    lane, j, call.r, call.v, call.f, careful, store, Arena(scratch, longest_piece));
}

void long_forces_finish(const ForcesCall &call, const Lane &lane, int64_t j, double *store, double *scratch,
                        Tally &tally) {
    const SegmentOutputs out = {{}, false, call.lambda, call.tension, splat(0.5), 1.0, call.virial};
    finish_block(false, call.box, call.r, call.g, call.add, out, Cut(lane.n_bonds), lane, j, store,
                 Arena(scratch, longest_piece), tally);
}

void long_velocities_eliminate(const VelocitiesCall &call, const Lane &lane, int64_t j, bool careful, double *store,
                               double *scratch) {
    eliminate_block(rate, call.box, Cut(lane.n_bonds), lane, j, call.r, call.v, AtomArray{}, careful, store,
                    Arena(scratch, longest_piece), call.strain);
}

void long_velocities_finish(const VelocitiesCall &call, const Lane &lane, int64_t j, double *store, double *scratch,
                            Tally &tally) {
    // With equal masses, t is w times 2 lambda here.
    const double mass = 1 / unit_of(lane);
    const SegmentOutputs out = {{}, false, call.lambda, nullptr, splat(0.5 * mass), mass, call.virial};
    finish_block(true, call.box, call.r, call.v, true, out, Cut(lane.n_bonds), lane, j, store,
                 Arena(scratch, longest_piece), tally);
}

}  // namespace holonomic::HOL_ISA
