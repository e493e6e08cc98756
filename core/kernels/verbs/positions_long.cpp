// Position level of one long chain in windows (newton/windows.hpp). If they can't do the chain, core hands it to
// positions() as a unit of one.
#include "core/kernels/eliminate/segment_substitute.hpp"
#include "core/kernels/isa/choose.hpp"
#include "core/kernels/newton/windows.hpp"
#include "core/kernels/tally.hpp"
#include "core/kernels/verbs/verbs.hpp"

namespace holonomic::HOL_ISA {

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
