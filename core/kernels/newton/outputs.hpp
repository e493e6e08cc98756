// What Newton's method has found, to and from the caller's arrays: a guess, moves, multipliers, the worst bond, the
// virial.
#ifndef HOLONOMIC_KERNELS_NEWTON_OUTPUTS_HPP
#define HOLONOMIC_KERNELS_NEWTON_OUTPUTS_HPP

#include "core/kernels/memory/virial.hpp"
#include "core/kernels/newton/sweeps.hpp"
#include "core/kernels/tally.hpp"

namespace holonomic {
namespace HOL_ISA {

static inline void load_guess(const Block &block, const PositionsCall &call, const Newton &x) {
    const vec factor = (2 * call.dt * call.dt) * block.unit;
    for (int i = 0; i < W; ++i) {
        const int lane = i < block.lanes ? i : 0;
        for (long k = 0; k < block.n; ++k)
            x.tau[k][i] = k < block.len[i] ? factor[i] * call.lambda[block.first_bond[lane] + k] : 0.0;
    }
}

// The first bond of a lane with this error.
template <bool uniform_w, bool uniform_a>
HOL_NOINLINE long worst_bond(const Block &block, const Newton &x, int lane, double error) {
    Mover<uniform_w> mover(x);
    long k = 0;
    for (vec worst = {}; k < block.len[lane]; ++k) {
        length_error<uniform_a>(x, k, false, mover.bond(x, k), worst);
        if (relative_error<uniform_a>(x, worst)[lane] >= error) break;
    }
    return k < block.len[lane] ? k : 0;
}

template <bool uniform_w, bool uniform_a>
static inline void note_worst(const Block &block, const Newton &x, const PositionsCall &call, mask which, vec error,
                              Tally &tally) {
    if (!call.report) return;
    const unsigned chosen = bits(which & block.in_use());
    int worst = -1;
    for (int i = 0; i < block.lanes; ++i) {
        if (!(chosen >> i & 1)) continue;
        if (!is_worse(tally, error[i], block.chain[i])) continue;
        tally.worst = error[i];
        tally.worst_chain = block.chain[i];
        worst = i;
    }
    if (worst >= 0) tally.worst_bond = worst_bond<uniform_w, uniform_a>(block, x, worst, tally.worst);
}

// The virial of the moves, - sum tau b (x) b / dt^2.
static inline void add_virial(const Block &block, const Newton &x, mask which, double dt, Tally &tally) {
    add_virial(block.n, x.b, x.tau, which & block.in_use(), splat(1 / (dt * dt)) / block.unit, tally);
}

}  // namespace HOL_ISA
}  // namespace holonomic
#endif
