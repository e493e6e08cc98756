// Position level of one long chain in windows (memory/cut.hpp). The kernel of short chains solves each. The result does
// not rest on how far a margin is felt: inside a piece Newton's method has tested all lengths, and where two pieces
// meet they are tested here before anything is written. If windows can't do the chain, core hands it to positions() as
// a unit of one.
#include "core/kernels/isa/choose.hpp"
#include "core/kernels/memory/cut.hpp"
#include "core/kernels/memory/outputs.hpp"
#include "core/kernels/newton/attempts.hpp"
#include "core/kernels/tally.hpp"
#include "core/kernels/verbs/verbs.hpp"

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
    const Source source = {&call.box, &positions.r};
    Carried carried(block, x, call, source);
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

int64_t long_positions_bytes(int64_t n_bonds) { return n_bonds * static_cast<int64_t>(sizeof(double)); }

// Moves the atoms 1 .. own of the pieces, and the first one of the chain.
template <bool uniform_w, bool to_v>
static void move_window(const SegmentBlock &s, int64_t j, const Newton &x, const Packed &r, const Packed &v,
                        double per_dt) {
    const vec3 first = x.tau[0] * x.b[0];
    const MoveSink<true, to_v> sink = {r, v, per_dt};
    Block own = own_block(s);
    own.n = s.block.n;  // the last atom of a lane is pulled by the bond behind it, too
    store_pulls<true, uniform_w>(own, x.b, x.tau, first_lanes(W), sink, 1, first);
    if (j == 0) store_first(times_w<uniform_w>(x, 0, first), 1, sink);
}

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
    Arena arena(scratch, longest_piece);
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
    choose([&](auto uniform_w, auto to_v) { move_window<uniform_w, to_v>(s, j, x, r, v, 1 / call.dt); },
           s.block.uniform_w, call.v.x != nullptr);
    close_segments(call.r, s, lane, r, false);
    if (call.v.x) close_segments(call.v, s, lane, v, false);
    if (call.virial) add_virial(own_block(s), x, first_lanes(W), call.dt, tally);
}

// A largest number that threads share.
struct SharedLargest {
    double value = 0;
    double seen() const {
        double a;
        __atomic_load(&value, &a, __ATOMIC_RELAXED);
        return a;
    }
    void raise(double to) {
        double a = seen();
        while (to > a && !__atomic_compare_exchange(&value, &a, &to, true, __ATOMIC_RELAXED, __ATOMIC_RELAXED)) {
        }
    }
};

bool long_positions(const PositionsCall &call, const Lane &lane, const LongTeam &team, double *tau, Tally &tally) {
    if (call.r_ref.x == call.r.x) return false;  // the bonds of the reference are needed while atoms are moved
    const int64_t n = windows(lane.n_bonds).blocks;
    bool seen[3] = {};  // of each WindowResult
    SharedLargest worst;
    Tally sum = empty_tally();
    for_each_window(team, n, sum, [&](int64_t j, double *scratch, Tally &part) {
        if (__atomic_load_n(&seen[window_failed], __ATOMIC_RELAXED)) return;
        // A window looks for the bond with its largest error only if no other window is known to have a larger one.
        const double most = worst.seen(), known = most > 0 ? most * (1 - epsilon) : -4.9e-324;
        part.worst = known;
        part.worst_chain = lane.chain;
        const WindowResult result = solve_window(call, lane, j, tau, Arena(scratch, longest_piece), part);
        if (part.worst == known)
            part.worst_chain = -1;
        else
            worst.raise(part.worst);
        __atomic_store_n(&seen[result], true, __ATOMIC_RELAXED);
    });
    const bool solved = seen[window_solved];
    if (seen[window_failed] || (solved && seen[window_untouched])) return false;
    bool fit = true;
    Tally unused = empty_tally();
    const auto test = [&](int64_t, double *scratch, Tally &) {
        fit = windows_fit(call, lane, tau, Arena(scratch, longest_piece), sum);
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
