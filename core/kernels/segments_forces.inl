// Acceleration and velocity level of one long chain, once its separators are solved for: substitute inside the segments
// and store.

namespace holonomic {
namespace HOL_ISA {

// t of all bonds of block j; t[own] of a lane is the next separator's.
static inline void substitute_block(const Cut &cut, const SegmentBlock &s, int64_t j, const Segments &x,
                                    double *store) {
    const vec ts = x.summary->t;
    vec next;
    for (int i = 0; i + 1 < W; ++i) next[i] = ts[i + 1];
    next[W - 1] = j + 1 < cut.blocks ? Segments(store, cut.longest(), j + 1).summary->t[0] : 0.0;
    if (s.own_max < s.block.n) x.t[s.own_max] = keep(ends_at(s, s.own_max), next);
    vec t = next;
    for (long k = s.own_max - 1; k >= 1; --k) {
        t = mul_add(x.fP[k], ts, mul_add(x.L[k], t, x.t[k]));
        if (k >= s.own_min) t = select(ends_at(s, k), next, t);
        x.t[k] = t;
    }
    x.t[0] = ts;
    if (s.last < 0) return;
    for (long k = s.own[s.last]; k < s.block.n; ++k) x.t[k][s.last] = 0;  // no bond follows the last segment
}

// The segments without the separators that follow them.
static inline Block own_block(const SegmentBlock &s) {
    Block block = s.block;
    block.n = s.own_max;
    block.n_min = s.own_min;
    for (int i = 0; i < W; ++i) block.len[i] = s.own[i];
    return block;
}

// Values per atom of the lanes: atoms 1 .. own of each segment, and atom 0 of the chain.
template <bool weighted, bool uniform>
static void store_segment_pulls(const SegmentBlock &s, int64_t j, const Segments &x, Update update, const Packed &out) {
    Block block = own_block(s);
    block.n = s.block.n;  // the last atom of a lane is pulled by the bond behind it, too
    const vec3 first = {x.t[0] * x.D[0].x, x.t[0] * x.D[0].y, x.t[0] * x.D[0].z};
    if (update == add_)
        store_pulls_from<weighted, uniform, add_>(block, 1, first, x.D, x.t, first_lanes(W), out);
    else
        store_pulls_from<weighted, uniform, write_>(block, 1, first, x.D, x.t, first_lanes(W), out);
    if (j > 0) return;
    const double w = weighted ? w_at<uniform>(block, 0)[0] : 1.0;
    const double pull[3] = {w * first.x[0], w * first.y[0], w * first.z[0]};
    for (int c = 0; c < 3; ++c) out.lane[0][c] = update == add_ ? out.lane[0][c] + pull[c] : pull[c];
}

// Copies staged segments back: the atoms that the lane wrote.
static inline void close_segments(const AtomArray &array, const SegmentBlock &s, int64_t j, const Lane &lane,
                                  const Packed &packed, bool add) {
    if (in_place(array, lane)) return;
    for (int i = 0; i < W; ++i) {
        const long first = j == 0 && i == 0 ? 0 : 1;
        unstage(array, lane, s.from[i] + first, s.own[i] - first, packed.lane[i] + 3 * first, add);
    }
}

static inline void add_segment_virial(const SegmentBlock &s, const Segments &x, Tally &tally) {
    Tally part = {};
    // The bond that follows a segment is counted with the next one.
    vec own[W];
    for (int i = 0; i < W; ++i) own[i] = vec{};
    for (int i = 0; i < W; ++i)
        if (s.own[i] < s.block.n) {
            own[i][0] = x.t[s.own[i]][i];
            x.t[s.own[i]][i] = 0;
        }
    add_virial(s.own_max < s.block.n ? s.own_max + 1 : s.block.n, x.D, x.t, first_lanes(W), splat(1.0), part);
    for (int i = 0; i < W; ++i)
        if (s.own[i] < s.block.n) x.t[s.own[i]][i] = own[i][0];
    for (int c = 0; c < 6; ++c) tally.virial[c] += part.virial[c];
}

static void long_forces_finish(const ForcesCall &call, const Lane &lane, int64_t j, double *store, double *scratch,
                               Tally &tally) {
    const Cut cut(lane.n_bonds);
    const Segments x(store, cut.longest(), j);
    const SegmentBlock s = segment_block(cut, j, lane);
    Arena arena = {scratch};
    substitute_block(cut, s, j, x, store);
    const Block own = own_block(s);
    if (call.lambda) store_bonds(own, x.t, splat(0.5), first_lanes(W), call.lambda);
    if (call.tension) {
        vec *value = arena.vecs(s.own_max);
        for (long k = 0; k < s.own_max; ++k) value[k] = x.t[k] * sqrt(dot(x.D[k], x.D[k]));
        store_bonds(own, value, splat(1.0), first_lanes(W), call.tension);
    }
    if (call.g.x) {
        const bool direct = in_place(call.g, lane);
        const Packed g = open_segments(call.g, s, lane, arena, false);
        store_segment_pulls<false, true>(s, j, x, direct && call.add ? add_ : write_, g);
        close_segments(call.g, s, j, lane, g, call.add);
    }
    if (call.virial) add_segment_virial(s, x, tally);
}

static void long_velocities_finish(const VelocitiesCall &call, const Lane &lane, int64_t j, double *store,
                                   double *scratch, Tally &tally) {
    const Cut cut(lane.n_bonds);
    const Segments x(store, cut.longest(), j);
    SegmentBlock s = segment_block(cut, j, lane);
    Arena arena = {scratch};
    set_segment_masses(s, lane, arena);
    substitute_block(cut, s, j, x, store);
    const Packed v = open_segments(call.v, s, lane, arena, false);
    const Update update = in_place(call.v, lane) ? add_ : write_;
    if (s.block.uniform_w)
        store_segment_pulls<true, true>(s, j, x, update, v);
    else
        store_segment_pulls<true, false>(s, j, x, update, v);
    close_segments(call.v, s, j, lane, v, true);
    if (call.lambda) store_bonds(own_block(s), x.t, 0.5 * s.block.mass, first_lanes(W), call.lambda);
    if (!call.virial) return;
    Tally part = {};
    add_segment_virial(s, x, part);
    for (int c = 0; c < 6; ++c) tally.virial[c] += part.virial[c] / unit_of(lane);
}

}  // namespace HOL_ISA
}  // namespace holonomic
