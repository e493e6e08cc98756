// Position level of one long chain, once Newton's method (segments_newton.inl) has ended: move the atoms and store.
#ifndef HOLONOMIC_KERNELS_NEWTON_SEGMENT_OUTPUTS_HPP
#define HOLONOMIC_KERNELS_NEWTON_SEGMENT_OUTPUTS_HPP

#include "core/kernels/eliminate/segment_substitute.hpp"
#include "core/kernels/memory/pulls.hpp"
#include "core/kernels/newton/segments.hpp"

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

}  // namespace HOL_ISA
}  // namespace holonomic
#endif
