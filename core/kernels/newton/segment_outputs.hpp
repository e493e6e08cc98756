// Position level of one long chain, once Newton's method (segments.hpp) has ended: move the atoms and store.
#ifndef HOLONOMIC_KERNELS_NEWTON_SEGMENT_OUTPUTS_HPP
#define HOLONOMIC_KERNELS_NEWTON_SEGMENT_OUTPUTS_HPP

#include "core/kernels/eliminate/segment_substitute.hpp"
#include "core/kernels/memory/pulls.hpp"
#include "core/kernels/memory/virial.hpp"
#include "core/kernels/newton/segments.hpp"

namespace holonomic {
namespace HOL_ISA {

// Moves the atoms 1 .. own of each segment, and atom 0 of the chain, by t b in place of tau b.
template <bool uniform, class Sink>
static void move_segment_atoms(const SegmentBlock &s, int64_t j, const NewtonSegments &x, const vec *t,
                               const Sink &sink) {
    Block block = own_block(s);
    block.n = s.block.n;  // the last atom of a lane is pulled by the bond behind it, too
    const vec3 first = times(t[0], x.b[0]);
    store_pulls<true, uniform>(block, x.b, t, first_lanes(W), sink, 1, first);
    if (j == 0) store_first(uniform ? first : times(block.w[0], first), 1, sink);
}

// The bond behind a segment is counted with the next one.
static inline void add_segment_virial(const SegmentBlock &s, const NewtonSegments &x, vec factor, Tally &tally) {
    VirialSum sum;
    for (long k = 0; k < s.own_max; ++k) sum.add(x.b[k], times(keep(owned(s, k), x.tau[k]), x.b[k]));
    sum.count(~none(), factor, tally);
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
