// Position level of one long chain, once Newton's method (segments_newton.inl) has ended: move the atoms and store.

namespace holonomic {
namespace HOL_ISA {

// Bond vectors and multipliers of W segments and of the separators behind them.
struct Segments {
    vec3 *D;
    vec *t;
};

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

// Largest w |tau| a of the block: how far single pulls move an atom (see coarse_moves).
static double long_positions_pull(const Lane &lane, int64_t j, double *store) {
    const Cut cut(lane.n_bonds);
    const NewtonSegments x(store, cut.longest(), j);
    double largest = 0;
    if (!lane.w && !lane.length) {
        const SegmentBlock s = segment_block(cut, j, lane);
        vec most = {};
        for (long k = 0; k < s.own_max; ++k) most = max(most, abs(x.tau[k]));
        for (int i = 0; i < W; ++i) largest = most[i] > largest ? most[i] : largest;
        return largest * relative_w(lane, 0) * lane.length_uniform;
    }
    for (int i = 0; i < W; ++i) {
        const int64_t first = cut.first(j * W + i), n = cut.length(j * W + i);
        for (int64_t k = 0; k < n; ++k) {
            const double w0 = relative_w(lane, first + k);
            const double w1 = relative_w(lane, first + k + 1);
            const double a = lane.length ? lane.length[first + k] : lane.length_uniform;
            const double pull = (w0 > w1 ? w0 : w1) * abs(x.tau[k][i]) * a;
            largest = pull > largest ? pull : largest;
        }
    }
    return largest;
}

// The block's largest error and the first bond that has it.
static inline void note_worst_bond(const SegmentBlock &s, const Lane &lane, const NewtonSegments &x, Tally &tally) {
    const vec error = x.summary->error;
    double worst = error[0];
    for (int i = 1; i < W; ++i) worst = error[i] > worst ? error[i] : worst;
    tally.worst = worst;
    tally.worst_chain = lane.chain;
    tally.worst_bond = -1;
    for (int i = 0; i < W && tally.worst_bond < 0; ++i) {
        if (error[i] < worst) continue;
        for (long k = 0; k < s.own[i] && tally.worst_bond < 0; ++k) {
            const double a = lane.length ? lane.length[s.from[i] + k] : lane.length_uniform, a2 = a * a;
            const double dx = x.D[k].x[i], dy = x.D[k].y[i], dz = x.D[k].z[i];
            const double sigma = 0.5 * mul_add(dz, dz, mul_add(dy, dy, mul_add(dx, dx, -a2)));
            if (2 * (abs(sigma) / a2) >= worst) tally.worst_bond = s.from[i] + k;
        }
        if (tally.worst_bond < 0) tally.worst_bond = s.from[i];
    }
}

// Writes r, v and lambda, and adds to the sums; with `moved` false the chain was within the tolerance as it came.
static void long_positions_finish(const PositionsCall &call, const Lane &lane, int64_t j, bool moved, double *store,
                                  double *scratch, Tally &tally) {
    const Cut cut(lane.n_bonds);
    const NewtonSegments x(store, cut.longest(), j);
    SegmentBlock s = segment_block(cut, j, lane);
    Arena arena = {scratch};
    note_worst_bond(s, lane, x, tally);
    if (moved) {
        set_segment_masses(s, lane, arena);
        const auto move = [&](const AtomArray &array, vec *t) {
            if (!array.x) return;
            Arena staging = arena;
            const Packed out = open_segments(array, s, lane, staging, false);
            const Update update = in_place(array, lane) ? add_ : write_;
            Segments view{x.b, t};
            if (s.block.uniform_w)
                store_segment_pulls<true, true>(s, j, view, update, out);
            else
                store_segment_pulls<true, false>(s, j, view, update, out);
            close_segments(array, s, j, lane, out, true);
        };
        move(call.r, x.tau);
        if (call.v.x) {
            for (long k = 0; k < s.block.n; ++k) x.up[k] = (1 / call.dt) * x.tau[k];
            move(call.v, x.up);
        }
        if (call.virial) {
            Tally part = {};
            add_segment_virial(s, Segments{x.b, x.tau}, part);
            for (int c = 0; c < 6; ++c) tally.virial[c] += part.virial[c] / (unit_of(lane) * call.dt * call.dt);
        }
    }
    if (!call.lambda) return;
    if (!moved)
        for (long k = 0; k < s.own_max; ++k) x.tau[k] = vec{};
    store_bonds(own_block(s), x.tau, splat(0.5 / (call.dt * call.dt) / unit_of(lane)), first_lanes(W), call.lambda);
}

}  // namespace HOL_ISA
}  // namespace holonomic
