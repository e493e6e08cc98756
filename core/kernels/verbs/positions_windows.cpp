// Position level of one long chain in windows: the phases.
#include "core/kernels/eliminate/segment_substitute.hpp"
#include "core/kernels/newton/phases.hpp"
#include "core/kernels/newton/windows.hpp"

namespace holonomic {
namespace HOL_ISA {

int64_t count_windows(int64_t n_bonds) { return windows(n_bonds).blocks; }

// Finds the multipliers of window j, tau[n_bonds] in the store.
WindowResult solve_window(const PositionsCall &call, const Lane &lane, int64_t j, double *tau, double *scratch,
                          Tally &tally) {
    const SegmentBlock s = segment_block(windows(lane.n_bonds), j, lane);
    Pieces pieces;
    if (!cut_pieces(call, lane, s, Arena(scratch, longest_piece), pieces)) return window_failed;
    Arena arena(scratch, longest_piece);
    Block block;
    Lane piece[W];
    open_block(Unit{pieces.lane, W, false, false}, 0, block, piece);
    set_masses(block, piece, arena);
    const BondLengths a = bond_lengths(block, piece, arena);
    if (block.uniform_w)
        return a.a2 ? solve_pieces<true, false>(block, piece, call, a, s, pieces, lane, arena, tau, tally)
                    : solve_pieces<true, true>(block, piece, call, a, s, pieces, lane, arena, tau, tally);
    return a.a2 ? solve_pieces<false, false>(block, piece, call, a, s, pieces, lane, arena, tau, tally)
                : solve_pieces<false, true>(block, piece, call, a, s, pieces, lane, arena, tau, tally);
}

// Whether the multipliers of the pieces fit together.
bool windows_fit(const PositionsCall &call, const Lane &lane, const double *tau, double *scratch, Tally &tally) {
    const Cut cut = windows(lane.n_bonds);
    const double enough = call.tolerance > floor_error ? call.tolerance : floor_error;
    for (int64_t i = 1; i < cut.blocks * W; ++i)
        if (!(seam_error(call, lane, cut.first(i), tau, Arena(scratch, longest_piece), tally) <= enough)) return false;
    return true;
}

// Writes what the multipliers of window j do; with `moved` false the chain was within the tolerance as it came.
void finish_window(const PositionsCall &call, const Lane &lane, int64_t j, bool moved, const double *tau,
                   double *scratch, Tally &tally) {
    SegmentBlock s = segment_block(windows(lane.n_bonds), j, lane);
    const int64_t from = s.from[0], end = s.from[W - 1] + s.own[W - 1];
    const double factor = 0.5 / (call.dt * call.dt) / unit_of(lane);
    if (call.lambda)
        for (int64_t k = from; k < end; ++k)
            call.lambda[lane.first_bond + k] = moved ? mul_add(factor, tau[k], 0.0) : 0.0;  // zeros as +0
    if (!moved) return;
    Arena arena(scratch, longest_piece);
    set_segment_masses(s, lane, arena);
    Newton x(s.block, BondLengths{}, arena);
    load_bond_vectors(s.block, call.box_ref, open_segments(call.r_ref, s, lane, arena, true), x.b);
    const double *own_tau[W];
    for (int i = 0; i < W; ++i) own_tau[i] = tau + s.from[i];
    interleave(own_tau, s.block.len, 0, s.block.n, x.tau,
               [&](int i, long k) HOL_FORCED { return k < s.block.len[i] ? own_tau[i][k] : 0.0; });
    // Of what is staged, only the atoms that are written here: others may be being written by other threads.
    const auto open = [&](const AtomArray &array) {
        const Packed packed = open_segments(array, s, lane, arena, false);
        for (int i = 0; i < W && array.x && !in_place(array, lane); ++i) {
            const long first = j == 0 && i == 0 ? 0 : 1;
            stage(array, lane, s.from[i] + first, s.own[i] - first, packed.lane[i] + 3 * first);
        }
        return packed;
    };
    const Packed r = open(call.r), v = open(call.v);
    const double per_dt = 1 / call.dt;
    if (s.block.uniform_w)
        call.v.x ? move_window<true, true, true>(s, j, x, r, v, per_dt)
                 : move_window<true, true, false>(s, j, x, r, v, per_dt);
    else
        call.v.x ? move_window<false, true, true>(s, j, x, r, v, per_dt)
                 : move_window<false, true, false>(s, j, x, r, v, per_dt);
    close_segments(call.r, s, j, lane, r, false);
    if (call.v.x) close_segments(call.v, s, j, lane, v, false);
    if (call.virial) add_virial(own_block(s), x, first_lanes(W), call.dt, tally);
}

}  // namespace HOL_ISA
}  // namespace holonomic
