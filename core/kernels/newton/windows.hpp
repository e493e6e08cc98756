// Position level of one long chain in windows. The kernel of short chains solves each. The result does not rest on how
// far a margin is felt: inside a piece Newton's method has tested all lengths, and where two pieces meet they are
// tested here before anything is written.
#ifndef HOLONOMIC_KERNELS_NEWTON_WINDOWS_HPP
#define HOLONOMIC_KERNELS_NEWTON_WINDOWS_HPP

#include "core/kernels/isa/choose.hpp"
#include "core/kernels/memory/pulls.hpp"
#include "core/kernels/memory/windows.hpp"
#include "core/kernels/newton/attempts.hpp"

namespace holonomic::HOL_ISA {

// Notes the largest error of the pieces without their margins, and the first bond that has it, if it exceeds that of
// the tally. `seams`: the bonds on either side of a seam count, too. They can't while a neighbour has multipliers that
// this window does not know.
template <bool uniform_w, bool uniform_a>
HOL_NOINLINE void note_worst_of_pieces(const Newton &x, const Window &window, const Lane &lane, bool seams,
                                       Tally &tally) {
    const SegmentBlock &s = window.own;
    vec first = {}, end = {};
    for (int i = 0; i < W; ++i) {
        first[i] = static_cast<double>(window.skip[i] + (seams || s.from[i] == 0 ? 0 : 1));
        end[i] = static_cast<double>(window.skip[i] + s.own[i] - (seams || i == s.last ? 0 : 1));
    }
    const WorstBonds worst = find_worst<uniform_w, uniform_a>(x, window.skip[W - 1] + s.own_max, first, end);
    for (int i = 0; i < W; ++i) {
        if (!(worst.error[i] > tally.worst)) continue;
        tally.worst = worst.error[i];
        tally.worst_chain = lane.chain;
        tally.worst_bond = static_cast<int64_t>(worst.bond[i]) + window.lane[i].first_bond - lane.first_bond;
    }
}

enum WindowResult { window_failed, window_untouched, window_solved };

// Finds the multipliers of the pieces and puts them into tau[n_bonds] of the chain.
template <bool uniform_w, bool uniform_a>
static inline WindowResult solve_window(const Window &window, const PositionsCall &call, const BondLengths &a,
                                        const Lane &lane, Arena arena, double *tau, Tally &tally) {
    const Block &block = window.block;
    const SegmentBlock &s = window.own;
    // The lengths at the ends of a piece must be within the tolerance with the multipliers of its neighbour, too.
    PositionsCall strict = call;
    strict.tolerance = call.tolerance / 8;
    strict.v = AtomArray{};
    Positions<uniform_w, uniform_a> positions(block, window.lane, strict, a, arena, tally);
    Newton &x = positions.x;
    Carried carried(block, x, call, positions.r);
    const mask all = first_lanes(W);
    positions.load();
    // A guess does not help: it knows of the pulls beyond the ends of a piece, which are not there.
    const Outcome out = solve_positions<uniform_w, uniform_a, false>(block, x, strict, carried, all, false);
    const bool untouched = !any(all & ~out.untouched);
    if (!untouched && (any(all & ~out.converged) || any(coarse_moves<uniform_w>(block, x, carried, all))))
        return window_failed;
    if (call.report && any(less(splat(tally.worst), out.error)))
        note_worst_of_pieces<uniform_w, uniform_a>(x, window, lane, untouched, tally);
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

static inline WindowResult solve_window(const PositionsCall &call, const Lane &lane, int64_t j, double *tau,
                                        Arena arena, Tally &tally) {
    Window window;
    if (!open_window(call.r_ref, call.box_ref, lane, j, arena, window)) return window_failed;
    const BondLengths a = bond_lengths(window.block, window.lane, arena);
    return choose(
        [&](auto uniform_w, auto uniform_a) {
            return solve_window<uniform_w, uniform_a>(window, call, a, lane, arena, tau, tally);
        },
        window.block.uniform_w, !a.a2);
}

// Returns the largest |D.D - a^2| / a^2 of the bonds on either side of atom `seam`, moved by tau; notes it if it is the
// largest so far.
static inline double seam_error(const PositionsCall &call, const Lane &lane, int64_t seam, const double *tau,
                                Arena arena, Tally &tally) {
    const int64_t from = seam - 2 > 0 ? seam - 2 : 0, end = seam + 2 < lane.n_bonds ? seam + 2 : lane.n_bonds;
    const long n = static_cast<long>(end - from);
    Packed r_ref = {}, r = {};
    open_lane(call.r_ref, lane, from, n, n, r_ref, 0, arena.doubles(staged_size(n)), true);
    open_lane(call.r, lane, from, n, n, r, 0, arena.doubles(staged_size(n)), true);
    Vector3<double> pull[6] = {}, move[5];  // pull[k + 1]: of bond from + k
    const auto bond = [](const Box &box, const double *p) { return bond_vector(box, p, p + 3); };
    for (long k = 0; k < n; ++k) pull[k + 1] = tau[from + k] * bond(call.box_ref, r_ref.lane[0] + 3 * k);
    for (long k = 0; k <= n; ++k) move[k] = relative_w(lane, from + k) * (pull[k + 1] - pull[k]);
    double worst = 0;
    for (int64_t k = seam - 1; k <= seam; ++k) {
        const long i = static_cast<long>(k - from);
        const double a = lane.length ? lane.length[k] : lane.length_uniform;
        const Vector3<double> d = bond(call.box, r.lane[0] + 3 * i) + (move[i + 1] - move[i]);
        const double error = abs(excess(d, a * a)) / (a * a);
        if (!(error <= worst)) worst = error;
        if (!(error > tally.worst)) continue;
        tally.worst = error;
        tally.worst_bond = k;
    }
    return worst;
}

// Whether the multipliers of the pieces fit together.
static inline bool windows_fit(const PositionsCall &call, const Lane &lane, const double *tau, Arena arena,
                               Tally &tally) {
    const Cut cut = windows(lane.n_bonds);
    const double enough = call.tolerance > floor_error ? call.tolerance : floor_error;
    for (int64_t i = 1; i < cut.blocks * W; ++i)
        if (!(seam_error(call, lane, cut.first(i), tau, arena, tally) <= enough)) return false;
    return true;
}

}  // namespace holonomic::HOL_ISA
#endif
