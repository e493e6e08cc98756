// Newton's method on a block that has been loaded, chains of one bond and longer ones, and what is done with its result
// however the atoms are stored.
#ifndef HOLONOMIC_KERNELS_NEWTON_SOLVE_HPP
#define HOLONOMIC_KERNELS_NEWTON_SOLVE_HPP

#include "core/kernels/memory/values.hpp"
#include "core/kernels/memory/virial.hpp"
#include "core/kernels/newton/iterate.hpp"
#include "core/kernels/newton/outputs.hpp"
#include "core/kernels/newton/single_bond.hpp"

namespace holonomic {
namespace HOL_ISA {

template <bool uniform_w, bool uniform_a, bool careful>
HOL_NOINLINE Outcome solve_positions(const Block &block, Newton &x, const PositionsCall &call, Carried &carried,
                                     mask wanted, bool guess) {
    const mask single = wanted & less(x.lengths, splat(1.5)), longer = wanted & ~single;
    Outcome out = {};
    if (any(longer))
        out = iterate<uniform_w, uniform_a, careful>(block, x, call, carried, longer, guess);
    else
        for (long k = 0; k < block.n; ++k) x.tau[k] = vec{};
    if (careful) {  // D has been moved by all corrections
        x.step = x.correction;
        for (long k = 0; k < block.n; ++k) x.correction[k] = vec{};
    }
    if (!any(single)) return out;
    x.step = x.tau;
    const Outcome one = solve_single_bonds<uniform_w>(x, carried, single);
    out.untouched = out.untouched | one.untouched;
    out.converged = out.converged | one.converged;
    out.error = select(single, one.error, out.error);
    out.solves = one.solves > out.solves ? one.solves : out.solves;
    return out;
}

// Lanes in which an atom's displacement is the difference of pulls so large that their rounding is more than the
// coordinates': light atoms between heavy ones in a taut chain. Elsewhere moving the atoms costs one rounding of them.
template <bool uniform_w>
static inline mask coarse_moves(const Block &block, const Newton &x, Carried &carried, mask which) {
    vec pull = {};
    go_up<0>(block, [&](long k, bool) HOL_FORCED {
        const vec tau = abs(x.tau[k]);
        pull = max(uniform_w ? tau : max(x.w[k], x.w[k + 1]) * tau, pull);
    });
    pull = pull * x.a_max;
    if (!any(which & less(0.25 * x.a_min, pull))) return none();
    return which & less(0.25 * (carried.largest_coordinate() + x.a_min), pull);
}

// Multipliers and counts of the lanes that are good.
static inline void note_solved(const Block &block, const Newton &x, const PositionsCall &call, const Outcome &out,
                               Tally &tally) {
    if (call.lambda) {
        const vec factor = splat(0.5 / (call.dt * call.dt)) / block.unit;
        store_bonds(block, x.tau, factor, out.converged | out.untouched, call.lambda);
    }
    tally.n_corrected += __builtin_popcount(bits(out.converged));
    if (out.solves > tally.iterations) tally.iterations = out.solves;
}

}  // namespace HOL_ISA
}  // namespace holonomic
#endif
