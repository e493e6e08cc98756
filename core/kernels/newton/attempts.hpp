// What Newton's method takes from the caller, a guess, and what it writes: multipliers, the worst bond, the virial; and
// the two attempts at the positions of a block of chains.
#ifndef HOLONOMIC_KERNELS_NEWTON_ATTEMPTS_HPP
#define HOLONOMIC_KERNELS_NEWTON_ATTEMPTS_HPP

#include "core/kernels/careful/chain.hpp"
#include "core/kernels/memory/open.hpp"
#include "core/kernels/memory/outputs.hpp"
#include "core/kernels/memory/packed.hpp"
#include "core/kernels/newton/criterion.hpp"
#include "core/kernels/newton/iterate.hpp"
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
// `part`: of the coordinates, which pulls exceed.
constexpr double coarse_part = 0.25, turning_part = 0x1p14;
template <bool uniform_w, int fixed = 0>
HOL_INLINE mask coarse_moves(const Block &block, const Newton &x, Carried &carried, mask which,
                             double part = coarse_part) {
    vec pull = {};
    go_up<fixed>(block, [&](long k, bool) HOL_FORCED {
        const vec tau = abs(x.tau[k]);
        pull = max(uniform_w ? tau : max(x.w[k], x.w[k + 1]) * tau, pull);
    });
    pull = pull * x.a_max;
    if (!any(which & less(part * x.a_min, pull))) return none();
    return which & less(part * (carried.largest_coordinate() + x.a_min), pull);
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

template <bool uniform_w, bool uniform_a>
struct Positions {
    const Block &block;
    const Lane *const lane;
    const PositionsCall &call;
    Arena arena;
    Tally &tally;
    Packed r_ref, r, v;
    Newton x;
    mask careful_lanes = {};  // done by the careful solver

    Positions(const Block &b, const Lane *l, const PositionsCall &c, const BondLengths &a, Arena memory, Tally &t)
        : block(b), lane(l), call(c), arena(memory), tally(t), r_ref(open(c.r_ref, b, l, arena, true)),
          r(open(c.r, b, l, arena, true)), v(open(c.v, b, l, arena, true)), x(b, a, arena) {}

    template <bool to_r, bool to_v>
    void move(mask which) const {
        store_pulls<true, uniform_w>(block, x.b, x.tau, which, MoveSink<to_r, to_v>{r, v, 1 / call.dt});
    }

    // Goes on after a coarse move, from the coordinates as they are rounded. The moves that remain are small, and so
    // are their roundings. Puts back the lanes in which this fails, and returns them.
    mask settle(mask coarse, Carried &carried, Outcome &out) {
        Arena rest = arena;
        double *saved[W] = {};
        for (int i = 0; i < block.lanes; ++i) {
            saved[i] = rest.doubles(3 * (block.len[i] + 1));
            for (long e = 0; e < 3 * (block.len[i] + 1); ++e) saved[i][e] = r.lane[i][e];
        }
        vec *const total = rest.vecs(block.n);
        carried.largest_coordinate();  // of the coordinates as they came
        move<true, false>(out.converged);
        mask wanted = coarse;
        for (int pass = 0; pass < 5 && any(wanted); ++pass) {
            for (long k = 0; k < block.n; ++k) {
                total[k] = x.tau[k];
                x.correction[k] = vec{};
            }
            load_bond_vectors(block, call.box, r, x.D);
            x.step = x.correction;
            const vec error = residuals<uniform_w, uniform_a>(block, x);
            out.error = select(coarse, error, out.error);
            wanted = wanted & ~less_equal(error, carried.accepted());
            if (!any(wanted)) break;
            const Outcome again = solve_positions<uniform_w, uniform_a, true>(block, x, call, carried, wanted, false);
            const mask moved = again.converged & wanted;
            move<true, false>(moved);
            for (long k = 0; k < block.n; ++k) x.tau[k] = total[k] + keep(moved, x.tau[k]);
        }
        const unsigned back = bits(wanted);
        for (int i = 0; i < block.lanes; ++i)
            if (back >> i & 1)
                for (long e = 0; e < 3 * (block.len[i] + 1); ++e) r.lane[i][e] = saved[i][e];
        return wanted;
    }

    // Does the lanes in which multipliers depend on the last digits of the reference's bonds: such pulls, of atoms some
    // 1e5 times lighter than their neighbours, turn with them. There the bonds must not be rounded. Returns the lanes
    // that are done; the others are settled.
    __attribute__((noinline)) mask solve_carefully(mask coarse, Carried &carried) {
        mask done = {};
        const unsigned chosen = bits(coarse_moves<uniform_w>(block, x, carried, coarse, turning_part));
        for (int i = 0; i < block.lanes; ++i)
            if (chosen >> i & 1 && careful::chain_positions(call, lane[i], const_cast<double *>(arena.end), tally))
                done[i] = -1;
        return done;
    }

    // Moves the atoms of the lanes that have converged, and writes their other outputs. `moved`: D has been moved by
    // all corrections, some of them larger than what they add up to, and has their roundings: so look at the bonds.
    void finish(Outcome &out, Carried &carried, bool moved) {
        mask coarse = moved ? out.converged : coarse_moves<uniform_w>(block, x, carried, out.converged);
        if (__builtin_expect(any(coarse), 0)) {
            careful_lanes = careful_lanes | solve_carefully(coarse, carried);
            out.converged = out.converged & ~careful_lanes;
            coarse = coarse & ~careful_lanes;
        }
        const bool settled = __builtin_expect(any(coarse), 0);
        note_worst<uniform_w, uniform_a>(block, x, call, (out.converged | out.untouched) & ~coarse, out.error, tally);
        if (settled) out.converged = out.converged & ~settle(coarse, carried, out);
        if (any(out.converged)) {
            if (settled) {
                note_worst<uniform_w, uniform_a>(block, x, call, out.converged & coarse, out.error, tally);
                if (call.v.x) move<false, true>(out.converged);
            } else if (call.v.x) {
                move<true, true>(out.converged);
            } else {
                move<true, false>(out.converged);
            }
            close(call.r, block, lane, out.converged, r, false);
            if (call.v.x) close(call.v, block, lane, out.converged, v, false);
            if (call.virial) add_virial(block, x, out.converged, call.dt, tally);
        }
        note_solved(block, x, call, out, tally);
    }

    void load() const {
        load_bond_vectors(block, call.box_ref, r_ref, x.b);
        load_bond_vectors(block, call.box, r, x.D);
    }

    void solve() {
        const mask all = block.in_use();
        load();
        if (block.ahead) {
            x.next[0] = r_ref.lane[0];
            x.next[1] = r.lane[0];
            x.next[2] = v.lane[0];
        }
        if (call.guess) load_guess(block, call, x);
        const Source source = {&call.box, &r};
        Carried carried(block, x, call, source);
        Outcome out = solve_positions<uniform_w, uniform_a, false>(block, x, call, carried, all, call.guess);
        finish(out, carried, false);
        mask rest = all & ~(out.converged | out.untouched | careful_lanes);
        if (__builtin_expect(!any(rest), 1)) return;
        // Once more from the start, with new factors at every step and nothing that can overflow on the way.
        load();
        out = solve_positions<uniform_w, uniform_a, true>(block, x, call, carried, rest, false);
        finish(out, carried, true);
        rest = rest & ~(out.converged | out.untouched | careful_lanes);
        if (any(rest)) note_bad(block, rest, tally);
    }
};

}  // namespace holonomic::HOL_ISA
#endif
