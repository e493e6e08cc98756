// Position level of one long chain, once Newton's method (segments_newton.inl) has ended: move the atoms and store.

namespace holonomic {
namespace HOL_ISA {

// Largest w |tau| a of the block: how far single pulls move an atom (see coarse_moves).
static double long_positions_pull(const Lane &lane, int64_t j, double *store) {
    const Cut cut(lane.n_bonds);
    const NewtonSegments x(store, cut.longest(), j);
    double largest = 0;
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

// Writes r, v and lambda, and adds to the sums; with `moved` false the chain was within the tolerance as it came.
static void long_positions_finish(const PositionsCall &call, const Lane &lane, int64_t j, bool moved, double *store,
                                  double *scratch, Tally &tally) {
    const Cut cut(lane.n_bonds);
    const NewtonSegments x(store, cut.longest(), j);
    SegmentBlock s = segment_block(cut, j, lane);
    Arena arena = {scratch};
    for (long k = 0; k < s.own_max; ++k)
        for (int i = 0; i < W; ++i) {
            if (k >= s.own[i]) continue;
            const double a = lane.length ? lane.length[s.from[i] + k] : lane.length_uniform;
            const double e = abs(2 * x.s[k][i]) / (a * a);
            if (tally.worst_chain >= 0 && !(e > tally.worst)) continue;
            if (tally.worst_chain >= 0 && tally.worst_chain == lane.chain && e == tally.worst) continue;
            tally.worst = e;
            tally.worst_chain = lane.chain;
            tally.worst_bond = s.from[i] + k;
        }
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
