// Position level of one long chain in windows (memory/cut.hpp). The kernel of short chains solves each. The result does
// not rest on how far a margin is felt: inside a part Newton's method has tested all lengths, and where two parts
// meet they are tested here before anything is written. The bonds of the reference are needed while atoms are moved: it
// is not the array of the positions (core/positions.cpp). If windows can't do the chain, core hands it to positions()
// as a unit of one.
#include "core/kernels/memory/cut.hpp"
#include "core/kernels/memory/load.hpp"
#include "core/kernels/memory/outputs.hpp"
#include "core/kernels/newton/attempts.hpp"
#include "core/kernels/newton/seams.hpp"
#include "core/kernels/tally.hpp"
#include "core/kernels/verbs/verbs.hpp"

namespace holonomic::HOL_ISA {

// Notes the largest error of the parts without their margins, and the first bond that has it, if it exceeds that of
// the tally. `seams`: the bonds on either side of a seam count, too. They can't while a neighbour has multipliers that
// this window does not know.
static void note_worst_of_windows(const Newton &x, const Window &window, const Lane &lane, bool seams, Tally &tally) {
    const SegmentBlock &s = window.own;
    vec first = {}, end = {};
    for (int i = 0; i < W; ++i) {
        first[i] = static_cast<double>(window.skip[i] + (seams || s.from[i] == 0 ? 0 : 1));
        end[i] = static_cast<double>(window.skip[i] + s.own[i] - (seams || i == s.last ? 0 : 1));
    }
    const WorstBonds worst = find_worst(x, window.skip[W - 1] + s.own_max, first, end);
    for (int i = 0; i < W; ++i) {
        if (!(worst.error[i] > tally.worst)) continue;
        tally.worst = worst.error[i];
        tally.worst_chain = lane.chain;
        tally.worst_bond = static_cast<int64_t>(worst.bond[i]) + window.lane[i].first_bond - lane.first_bond;
    }
}

// Finds the multipliers of the parts and puts them into tau[n_bonds] of the chain.
static WindowResult solve_window(const PositionsCall &call, const Lane &lane, int64_t j, double *tau, Arena arena,
                                 Tally &tally) {
    Window window;
    if (!open_window(call.r_ref, call.box_ref, lane, j, 0, arena, window)) return window_failed;
    const Block &block = window.block;
    const BondLengths a = bond_lengths(block, window.lane, arena);
    const SegmentBlock &s = window.own;
    const PositionsCall strict = call_for_parts(call);
    Positions positions(block, window.lane, strict, a, arena, tally);
    Newton &x = positions.x;
    const Source source = {&call.box, &positions.r};
    Carried carried(block, x, call, source);
    const mask all = first_lanes(W);
    positions.load();
    // A guess does not help: it knows of the pulls beyond the ends of a part, which are not there.
    const NewtonOutcome out = solve_positions(block, x, strict, carried, all, false);
    const bool untouched = !any(all & ~out.untouched);
    if (!untouched && (any(all & ~out.converged) || any(coarse_moves(block, x, carried, all)))) return window_failed;
    if (call.report && any(less(splat(tally.worst), out.error)))
        note_worst_of_windows(x, window, lane, untouched, tally);
    if (untouched) return window_untouched;
    if (out.solves > tally.iterations) tally.iterations = out.solves;
    if (window.even) {
        Block own = own_block(s);
        for (int i = 0; i < W; ++i) own.first_bond[i] = s.from[i];
        store_bonds(own, x.tau + window.skip[0], splat(1.0), all, tau);
    } else {
        for (int i = 0; i < W; ++i)
            for (long k = 0; k < s.own[i]; ++k) tau[s.from[i] + k] = x.tau[k + window.skip[i]][i];
    }
    return window_solved;
}

// Whether the multipliers of the parts fit together.
static inline bool windows_fit(const PositionsCall &call, const Lane &lane, const double *tau, Arena arena,
                               Tally &tally) {
    const Cut cut = windows(lane.n_bonds);
    for (int64_t i = 1; i < cut.blocks * W; ++i)
        if (!(seam_error(call, lane, cut.first(i), tau, arena, tally) <= enough_at_seams(call))) return false;
    return true;
}

int64_t long_positions_bytes(int64_t n_bonds) { return n_bonds * static_cast<int64_t>(sizeof(double)); }

// Writes the multipliers of window j, and moves its atoms. `moved` is false if the chain came within the tolerance.
static void finish_window(const PositionsCall &call, const Lane &lane, int64_t j, bool moved, const double *tau,
                          double *scratch, Tally &tally) {
    SegmentBlock s = segment_block(windows(lane.n_bonds), j, lane);
    const int64_t from = s.from[0], end = s.from[W - 1] + s.own[W - 1];
    const double factor = 0.5 / (call.dt * call.dt) / unit_of(lane);
    if (call.lambda)
        for (int64_t k = from; k < end; ++k)
            call.lambda[lane.first_bond + k] = moved ? mul_add(factor, tau[k], 0.0) : 0.0;  // zeros as +0
    if (!moved) return;
    Arena arena(scratch, longest_cut);
    set_masses(s.block, s.lane, arena);
    Newton x(s.block, BondLengths{}, arena);
    load_bond_vectors(s.block, call.box_ref, open(call.r_ref, s.block, s.lane, arena, true), x.b);
    const double *own_tau[W];
    for (int i = 0; i < W; ++i) own_tau[i] = tau + s.from[i];
    interleave(own_tau, s.block.len, 0, s.block.n, x.tau,
               [&](int i, long k) HOL_FORCED { return k < s.block.len[i] ? own_tau[i][k] : 0.0; });
    // Stages only the atoms that are written here. Other threads may be writing the others.
    const auto open_own = [&](const AtomArray &array) {
        const Packed packed = open(array, s.block, s.lane, arena, false);
        for (int i = 0; i < W && array.x && !in_place(array, lane); ++i) {
            const long first = j == 0 && i == 0 ? 0 : 1;
            stage(array, lane, s.from[i] + first, s.own[i] - first, packed.lane[i] + 3 * first);
        }
        return packed;
    };
    const Packed r = open_own(call.r), v = open_own(call.v);
    const mask all = first_lanes(W);
    Block moved_atoms = own_block(s);  // atoms 1 .. own of the parts, and the first one of the chain
    moved_atoms.n = s.block.n;         // the last atom of a lane is pulled by the bond behind it, too
    move_atoms(moved_atoms, x, all, r, v, 1 / call.dt, 1, x.tau[0] * x.b[0]);
    if (j == 0) move_first(x, 1, r, v, 1 / call.dt);
    close_segments(call.r, s, lane, r, false);
    if (call.v.x) close_segments(call.v, s, lane, v, false);
    if (call.virial) add_virial(own_block(s), x, all, call.dt, tally);
}

bool long_positions(const PositionsCall &call, const Lane &lane, const LongTeam &team, double *tau, Tally &tally) {
    const int64_t n = windows(lane.n_bonds).blocks;
    bool seen[3] = {};  // of each WindowResult
    SharedLargest worst;
    Tally sum = empty_tally();
    for_each_window(team, n, sum, [&](int64_t j, double *scratch, Tally &part) {
        if (__atomic_load_n(&seen[window_failed], __ATOMIC_RELAXED)) return;
        // A window looks for the bond with its largest error only if no other window is known to have a larger one.
        const WindowResult result = worst.look(
            lane.chain, part, [&] { return solve_window(call, lane, j, tau, Arena(scratch, longest_cut), part); });
        __atomic_store_n(&seen[result], true, __ATOMIC_RELAXED);
    });
    const bool solved = seen[window_solved];
    if (seen[window_failed] || (solved && seen[window_untouched])) return false;
    bool fit = true;
    Tally unused = empty_tally();
    const auto test = [&](int64_t, double *scratch, Tally &) {
        fit = windows_fit(call, lane, tau, Arena(scratch, longest_cut), sum);
    };
    if (solved) for_each_window(team, 1, unused, test);
    if (!fit) return false;
    for_each_window(team, n, sum, [&](int64_t j, double *scratch, Tally &part) {
        finish_window(call, lane, j, solved, tau, scratch, part);
    });
    sum.n_corrected = solved;
    add(tally, sum);
    return true;
}

}  // namespace holonomic::HOL_ISA
