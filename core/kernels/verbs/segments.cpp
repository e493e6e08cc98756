// Forces and velocities of long chains in segments. Arms of large molecules are done by the same two functions, so that
// they are compiled once.
#include "core/kernels/eliminate/segment.hpp"
#include "core/kernels/isa/choose.hpp"
#include "core/kernels/memory/open.hpp"
#include "core/kernels/memory/outputs.hpp"
#include "core/kernels/memory/prefetch.hpp"
#include "core/kernels/verbs/verbs.hpp"

namespace holonomic::HOL_ISA {

// In chains of more bonds than these, what the next block needs is fetched early.
constexpr int64_t long_in_cache = 65536;

void eliminate_block(int terms, const Box &box, const Cut &cut, const Lane &lane, int64_t j, const AtomArray &r,
                     const AtomArray &v, const AtomArray &f, bool extended, double *store, const Arena &memory,
                     const double *strain) {
    Arena arena = memory;
    SegmentBlock s = segment_block(cut, j, lane);
    set_masses(s.block, s.lane, arena);
    repeat_masses(s.block, s.lane, arena);
    // All are in place or none is, so that the segments are equally far apart in each array.
    const Packed pr = open(r, s.block, s.lane, arena, true), pv = open(v, s.block, s.lane, arena, true);
    const Packed pf = open(f, s.block, s.lane, arena, true);
    const SegmentStore x(store, cut, j);
    const Block own = own_block(s);
    Reader in(own, box, terms == rate ? rate : terms & (velocity_squared | force_difference), pr, pv, pf, extended);
    in.strain = strain;
    if (cut.n_bonds > long_in_cache && j + 1 < cut.blocks && in_place(r, lane)) in.ahead = 3 * W * cut.rows(j);
    const SeparatorsBehind behind(s, box, pr);
    choose([&](auto uniform, auto exactly) { eliminate<uniform, exactly>(s, in, behind, x); }, s.block.uniform_w,
           extended);
    if (x.past_cache) settle_stores();
}

// Whether the units of a chain, as it is in these blocks, are not ordinary ones, or its bonds no lengths.
bool are_extreme(const Summary *all, int64_t blocks) {
    vec q = {}, w = {};
    for (int64_t j = 0; j < blocks; ++j) {
        q = max(q, all[j].q_max);
        w = max(w, all[j].w_max);
    }
    double most_q = 0, most_w = 0;
    for (int i = 0; i < W; ++i) {
        most_q = q[i] > most_q ? q[i] : most_q;
        most_w = w[i] > most_w ? w[i] : most_w;
    }
    constexpr double length = int64_t{1} << most_ordinary_length, mass = 0x1p92;
    static_assert(most_ordinary_mass == 92);
    const auto ordinary = [](double x, double most) { return x * most >= 1 && x <= most; };
    return !(ordinary(most_q, length * length) && ordinary(most_w, mass) && ordinary(most_q * most_w, mass));
}

// Solves for the separators of the first blocks. `extended` says how the segments were eliminated.
JoinResult long_join(const Lane &lane, int64_t blocks, bool extended, double *store) {
    const Cut cut(lane.n_bonds);
    Summary *const all = SegmentStore(store, cut, 0).summary;
    const auto flag = [&] { return extended ? join_bad : are_extreme(all, blocks) ? join_extreme : join_flagged; };
    double E = 0, y = 0;
    for (int64_t j = 0; j < blocks; ++j) {
        Summary &s = all[j];
        if (j == 0) E = relative_w(lane, 0) * s.q[0];
        if (any(s.flag)) return flag();
        for (int i = 0; i < W; ++i) {
            const double P = E + s.c[i], yhat = (y + s.b[i]) + s.T[i], S = s.E[i] * E + s.a[i];
            if (!extended && is_flagged_join(s, i, S, P, 1.0)) return flag();
            if (!(P - P == 0)) return flag();  // what is over it would be zero
            s.t[i] = yhat / P;
            s.up[i] = s.f[i] / P;
            E = S / P;
            y = s.y[i] + s.up[i] * yhat;
        }
    }
    double t = 0;
    for (int64_t j = blocks - 1; j >= 0; --j) {
        Summary &s = all[j];
        for (int i = W - 1; i >= 0; --i) {
            t = j == blocks - 1 && i == W - 1 ? s.t[i] : s.t[i] + s.up[i] * t;
            s.t[i] = t;
            if (!(t - t == 0)) return flag();
        }
    }
    return join_good;
}

// The bonds k0 .. k0 + W - 1 with their t, once those behind them are done; `after` is t d of bond k0 + W, then of k0.
// `w`: pulls are multiplied with these if they are `weighted`. ragged: lanes may end there.
template <Update update, bool weighted>
HOL_INLINE void store_segment_chunk(const Block &own, const SegmentOutputs &out, const vec *w, bool ragged, long k0,
                                    const vec3 *d, const vec *t, vec3 &after, VirialSum &sum) {
    const vec zero = {};  // added to products: a zero is +0, and so are differences of such
    vec value[3 * W];
    const auto store_each = [&](double *to) HOL_FORCED {
        ragged ? store_values<true>(own, k0, value, all_lanes, to) : store_values<false>(own, k0, value, all_lanes, to);
    };
    if (out.lambda) {
        for (int b = 0; b < W; ++b) value[b] = mul_add(out.lambda_factor, t[b], zero);
        store_each(out.lambda);
    }
    if (out.tension) {
        for (int b = 0; b < W; ++b) value[b] = mul_add(t[b], sqrt(dot(d[b], d[b])), zero);
        store_each(out.tension);
    }
    if (!out.has_pulls && !out.virial) return;
    HOL_UNROLL
    for (int b = W - 1; b >= 0; --b) {
        const vec3 p = {mul_add(t[b], d[b].x, zero), mul_add(t[b], d[b].y, zero), mul_add(t[b], d[b].z, zero)};
        vec3 g = after - p;
        if (weighted) g = (ragged && k0 + b + 1 > own.n ? vec{} : w[k0 + b + 1]) * g;
        value[3 * b] = g.x;
        value[3 * b + 1] = g.y;
        value[3 * b + 2] = g.z;
        if (out.virial && !(ragged && k0 + b >= own.n)) sum.add(d[b], p);
        after = p;
    }
    if (!out.has_pulls) return;
    const AtomSink<update> sink = {out.pulls};
    ragged ? store_ragged(own, k0 + 1, value, all_lanes, sink) : store_chunk(k0 + 1, value, sink);
}

// Blocks are substituted in from the last to the first, so that those which were eliminated last are still in cache.
// Distances from a block to the one before it, in vectors per atom and in what is kept of the bonds.
static inline void find_block_before(const Cut &cut, int64_t j, SegmentBlock &s) {
    static_assert(sizeof(SegmentBond) == 3 * sizeof(vec), "as far apart as vectors of W atoms");
    if (j == 0) {
        s.block.ahead = cut.to_atoms_before;
        s.kept_ahead = cut.to_kept_before;
    } else if (cut.n_bonds > long_in_cache) {
        s.block.ahead = s.kept_ahead = -3 * W * cut.rows(j - 1);
    }
}

// Fetches what the block before this one needs and writes to, when this one is at bond k0.
HOL_INLINE void fetch_before(const SegmentBlock &s, const Reader &in, const SegmentStore &x, const SegmentOutputs &out,
                             long k0) {
    fetch_ahead(in.r->lane[0], k0, s.block.ahead);
    fetch_ahead(reinterpret_cast<const double *>(x.kept), k0, s.kept_ahead);
    if (out.has_pulls) fetch_ahead(out.pulls.lane[0], k0, s.block.ahead);
}

// Atoms 1 .. own of each segment, and atom 0 of a chain that begins here. `next`: t of the separators behind them.
template <Update update, bool weighted>
static void finish_segments(const SegmentBlock &s, const Reader &in, const SeparatorsBehind &behind,
                            const SegmentStore &x, vec next, const SegmentOutputs &out, const vec *w, Tally &tally) {
    const Block &own = in.block;
    const long n = s.own_max, full = s.own_min / W * W;
    const vec ts = x.summary->t;
    vec t = next, value[W];
    vec3 after = next * behind.d, D[stage_bonds + 1 + W];
    VirialSum sum;
    const auto substituted = [&](long k) HOL_FORCED {
        const SegmentBond &p = x.kept[k];
        return mul_add(p.l, t, mul_add(p.fP, ts, p.u));
    };
    const auto chunk = [&](long k0, const vec3 *d, bool ragged) HOL_FORCED {
        HOL_UNROLL
        for (int b = W - 1; b >= 0; --b) {
            const long k = k0 + b;  // 0: a lane begins in this chunk
            if (!ragged || k < n) t = b == 0 && k == 0 ? ts : substituted(k);
            value[b] = !ragged || k <= n ? t : vec{};
        }
        store_segment_chunk<update, weighted>(own, out, w, ragged, k0, d, value, after, sum);
    };
    // Without a box bonds are found chunk by chunk, in registers: 5 % fewer instructions of forces.
    const bool plain = in.box.lattice == Box::none;
    const RowsOfLanes rows(*in.r);
    for (long from = (n - 1) / stage_bonds * stage_bonds; from >= 0; from -= stage_bonds) {
        const long end = from + stage_bonds < n ? from + stage_bonds : n, ended = plain && full > from ? full : from;
        if (ended < end) in.load(ended, end, D + (ended - from), nullptr, nullptr);
        if (end == n) {
            D[n - from] = behind.d;
            for (long i = n - from + 1; i % W != 0; ++i) D[i] = vec3{};
        }
        long k0 = from + (end - from - 1) / W * W;
        for (; k0 >= from && k0 >= full; k0 -= W) chunk(k0, D + (k0 - from), true);
        for (; k0 >= from; k0 -= W) {
            if (s.block.ahead) fetch_before(s, in, x, out, k0);
            vec3 d[W];
            if (plain)
                subtract_chunk<false>(rows, k0, d, nullptr);
            else
                for (int b = 0; b < W; ++b) d[b] = D[k0 - from + b];
            chunk(k0, d, false);
        }
    }
    if (out.virial) sum.count(~none(), splat(out.virial_factor), tally);
    if (!s.begins || !out.has_pulls) return;
    if (weighted) after = w[0] * after;
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
    const Packed pr = open(r, s.block, s.lane, arena, true);
    const Block own = own_block(s);
    Reader in(own, box, none_, pr, pr, pr);
    in.ahead = 0;
    const SegmentStore x(store, cut, j);
    vec next;
    for (int i = 0; i + 1 < W; ++i) next[i] = x.summary->t[i + 1];
    next[W - 1] = s.last < 0 ? x.summary[1].t[0] : 0.0;
    out.has_pulls = pulled.x != nullptr;
    out.pulls = open(pulled, s.block, s.lane, arena, false);
    const SeparatorsBehind behind(s, box, pr);
    const vec *const w = weighted && !s.block.uniform_w ? own.w : nullptr;
    choose([&](auto adds,
               auto weigh) { finish_segments<adds ? add_ : write_, weigh>(s, in, behind, x, next, out, w, tally); },
           add && in_place(pulled, lane), w != nullptr);
    if (out.has_pulls) close_segments(pulled, s, lane, out.pulls, add);
}

void long_forces_eliminate(const ForcesCall &call, const Lane &lane, int64_t j, bool extended, double *store,
                           double *scratch) {
    eliminate_block((call.v.x ? velocity_squared : 0) | (call.f.x ? force_difference : 0), call.box, Cut(lane.n_bonds),
                    lane, j, call.r, call.v, call.f, extended, store, Arena(scratch, longest_cut));
}

void long_forces_finish(const ForcesCall &call, const Lane &lane, int64_t j, double *store, double *scratch,
                        Tally &tally) {
    const SegmentOutputs out = {{}, false, call.lambda, call.tension, splat(0.5), 1.0, call.virial};
    finish_block(false, call.box, call.r, call.g, call.add, out, Cut(lane.n_bonds), lane, j, store,
                 Arena(scratch, longest_cut), tally);
}

void long_velocities_eliminate(const VelocitiesCall &call, const Lane &lane, int64_t j, bool extended, double *store,
                               double *scratch) {
    eliminate_block(rate, call.box, Cut(lane.n_bonds), lane, j, call.r, call.v, AtomArray{}, extended, store,
                    Arena(scratch, longest_cut), call.strain);
}

void long_velocities_finish(const VelocitiesCall &call, const Lane &lane, int64_t j, double *store, double *scratch,
                            Tally &tally) {
    // With equal masses, t is w times 2 lambda here.
    const double mass = 1 / unit_of(lane);
    const SegmentOutputs out = {{}, false, call.lambda, nullptr, splat(0.5 * mass), mass, call.virial};
    finish_block(true, call.box, call.r, call.v, true, out, Cut(lane.n_bonds), lane, j, store,
                 Arena(scratch, longest_cut), tally);
}

}  // namespace holonomic::HOL_ISA
