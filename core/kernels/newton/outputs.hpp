// What Newton's method takes from the caller, a guess, and what it writes: multipliers, the worst bond, the virial.
#ifndef HOLONOMIC_KERNELS_NEWTON_OUTPUTS_HPP
#define HOLONOMIC_KERNELS_NEWTON_OUTPUTS_HPP

#include "core/kernels/memory/pulls.hpp"
#include "core/kernels/newton/criterion.hpp"
#include "core/kernels/newton/sweeps.hpp"
#include "core/kernels/tally.hpp"

namespace holonomic::HOL_ISA {

static inline void load_guess(const Block &block, const PositionsCall &call, const Newton &x) {
    const vec factor = (2 * call.dt * call.dt) * block.unit;
    for (int i = 0; i < W; ++i) {
        const int lane = i < block.lanes ? i : 0;
        for (long k = 0; k < block.n; ++k)
            x.tau[k][i] = k < block.len[i] ? factor[i] * call.lambda[block.first_bond[lane] + k] : 0.0;
    }
}

// The largest errors among the bonds first .. end-1 of each lane, all of them < n, and the first bonds that have them.
struct WorstBonds {
    vec error, bond;
};

template <bool uniform_w, bool uniform_a>
HOL_NOINLINE WorstBonds find_worst(const Newton &x, long n, vec first, vec end) {
    WorstBonds worst = {vec{}, first};
    Mover<uniform_w> mover(x);
    for (long k = 0; k < n; ++k) {
        const vec number = splat(static_cast<double>(k));
        vec error = {};
        length_error<uniform_a>(x, k, false, mover.bond(x, k), error);
        error = relative_error<uniform_a>(x, error);
        const mask greater = less_equal(first, number) & less(number, end) & less(worst.error, error);
        worst = {select(greater, error, worst.error), select(greater, number, worst.bond)};
    }
    return worst;
}

template <bool uniform_w, bool uniform_a>
static inline void note_worst(const Block &block, const Newton &x, const PositionsCall &call, mask which, vec error,
                              Tally &tally) {
    if (!call.report || (tally.worst_chain >= 0 && !any(which & ~less(error, splat(tally.worst))))) return;
    const unsigned chosen = bits(which & block.in_use());
    int worst = -1;
    for (int i = 0; i < block.lanes; ++i) {
        if (!(chosen >> i & 1) || !is_worse(tally, error[i], block.chain[i])) continue;
        tally.worst = error[i];
        tally.worst_chain = block.chain[i];
        worst = i;
    }
    if (worst < 0) return;
    const vec bond = find_worst<uniform_w, uniform_a>(x, block.n, vec{}, block.lengths()).bond;
    tally.worst_bond = static_cast<int64_t>(bond[worst]);
}

// The virial of the moves, - sum tau b (x) b / dt^2.
static inline void add_virial(const Block &block, const Newton &x, mask which, double dt, Tally &tally) {
    add_virial(block.n, x.b, x.tau, which & block.in_use(), splat(1 / (dt * dt)) / block.unit, tally);
}

// Lanes in which the pulls on an atom are so large that their rounding exceeds that of the coordinates. This happens to
// light atoms between heavy ones in a taut chain. In all other lanes the move costs one rounding of the coordinates.
template <bool uniform_w, int fixed = 0>
HOL_INLINE mask coarse_moves(const Block &block, const Newton &x, Carried &carried, mask which) {
    vec pull = {};
    go_up<fixed>(block, [&](long k, bool) HOL_FORCED {
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

}  // namespace holonomic::HOL_ISA
#endif
