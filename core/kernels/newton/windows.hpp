// Position level of one long chain in windows: W pieces of it with a margin on either side, solved in cache as chains
// of their own by the kernel of short ones. What happens beyond the end of a piece is felt k joints further in by no
// more than the product of their |l|, which dies within a few dozen bonds of a coil; the multipliers of the margins are
// thrown away. That the others solve the chain's equations does not rest on this: inside a piece it is what Newton's
// method has found, and where two pieces meet the lengths of the bonds are computed before anything is written. Chains
// whose ends are felt farther are left to segments.hpp.
#ifndef HOLONOMIC_KERNELS_NEWTON_WINDOWS_HPP
#define HOLONOMIC_KERNELS_NEWTON_WINDOWS_HPP

#include "core/kernels/memory/cut.hpp"
#include "core/kernels/memory/values.hpp"
#include "core/kernels/memory/virial.hpp"
#include "core/kernels/newton/attempts.hpp"
#include "core/kernels/newton/lengths.hpp"
#include "core/kernels/newton/phases.hpp"

namespace holonomic {
namespace HOL_ISA {

constexpr long shortest_piece = 256;  // with shorter ones the margins would cost too much
constexpr double negligible = 1e-19;  // of what happens beyond a margin

static inline Cut windows(int64_t n_bonds) { return Cut(n_bonds, window_bonds * W); }

// How many bonds beyond an atom of the chain, in the direction `step` (1 or -1), a piece needs there; those to the end
// of the chain if that comes first. Or -1: too many.
//
// Elimination towards the margin finds P = w q + E at a joint and E >= w' q sin'^2, where ' is the joint before, at an
// atom of inverse mass w': |l| <= |cos| / (1 + (w' / w) sin'^2), for equal lengths.
static inline long margin(const PositionsCall &call, const Lane &lane, int64_t atom, int step, Arena arena) {
    const int64_t to_end = step > 0 ? lane.n_bonds - atom : atom;
    const long most = to_end < longest_margin ? static_cast<long>(to_end) : longest_margin;
    Packed r = {};
    open_lane(call.r_ref, lane, step > 0 ? atom : atom - most, most, most, r, 0, arena.next, true);
    const double *p = r.lane[0] + (step > 0 ? 0 : 3 * most);
    Vector3<double> before = {}, unused = {};
    double q = 1, w_before = 0, sin2 = 0, left = 1;  // left: the square of what is left
    for (long k = 0; k < most; ++k, p += 3 * step) {
        const double w = relative_w(lane, atom + step * k);
        if (w == 0) return k;
        const double *const next = p + 3 * step;
        Vector3<double> d = {next[0] - p[0], next[1] - p[1], next[2] - p[2]};
        if (call.box_ref.shape != Box::none) wrap<false>(call.box_ref, d, unused);
        const double q1 = dot(d, d), g = dot(before, d), qq = q * q1, gg = g * g;
        if (k > 0) {
            const double spare = 1 + (lane.w ? w_before / w : 1.0) * sin2;
            left *= gg / (qq * (spare * spare));
            if (left < negligible * negligible) return k;
            sin2 = 1 - gg / qq;
        }
        w_before = w;
        before = d;
        q = q1;
    }
    return most == to_end ? most : -1;
}

// The pieces of a window, with the same margins but at the ends of the chain.
struct Pieces {
    Lane lane[W];
    long skip[W];  // bonds of the margin before
    bool even;     // the same in all
};

// Returns false if windows don't pay or won't do.
static inline bool cut_pieces(const PositionsCall &call, const Lane &lane, const SegmentBlock &s, Arena arena,
                              Pieces &x) {
    if (s.own_max < shortest_piece) return false;
    long before = 0, behind = 0;
    for (int i = 0; i < W; ++i) {
        const long left = margin(call, lane, s.from[i], -1, arena);
        const long right = margin(call, lane, s.from[i] + s.own[i], 1, arena);
        if (left < 0 || right < 0) return false;
        before = left > before ? left : before;
        behind = right > behind ? right : behind;
    }
    x.even = true;
    for (int i = 0; i < W; ++i) {
        const int64_t from = s.from[i] > before ? s.from[i] - before : 0;
        const int64_t end = s.from[i] + s.own[i] + behind < lane.n_bonds ? s.from[i] + s.own[i] + behind : lane.n_bonds;
        Lane &piece = x.lane[i] = lane;
        piece.n_bonds = end - from;
        piece.first_atom += from;
        piece.first_bond += from;
        if (lane.atoms) piece.atoms += from;
        if (lane.w) piece.w += from;
        if (lane.length) piece.length += from;
        x.skip[i] = static_cast<long>(s.from[i] - from);
        x.even = x.even && x.skip[i] == x.skip[0];
    }
    return true;
}

// The largest error of the pieces without their margins, if greater than the one in the tally, and the first bond that
// has it. `seams`: with the bonds on either side of the atoms where pieces meet; the multipliers here are not all
// theirs.
template <bool uniform_w, bool uniform_a>
HOL_NOINLINE void note_worst_of_pieces(const Newton &x, const SegmentBlock &s, const Pieces &pieces, const Lane &lane,
                                       bool seams, Tally &tally) {
    vec first, end, worst = {}, at = {};
    for (int i = 0; i < W; ++i) {
        const bool chain_begins = s.from[i] == 0, chain_ends = i == s.last;
        first[i] = static_cast<double>(pieces.skip[i] + (seams || chain_begins ? 0 : 1));
        end[i] = static_cast<double>(pieces.skip[i] + s.own[i] - (seams || chain_ends ? 0 : 1));
        at[i] = first[i];
    }
    Mover<uniform_w> mover(x);
    for (long k = 0; k < pieces.skip[W - 1] + s.own_max; ++k) {
        const vec number = splat(static_cast<double>(k));
        vec error = {};
        length_error<uniform_a>(x, k, false, mover.bond(x, k), error);
        error = relative_error<uniform_a>(x, error);
        const mask greater = less_equal(first, number) & less(number, end) & less(worst, error);
        worst = select(greater, error, worst);
        at = select(greater, number, at);
    }
    for (int i = 0; i < W; ++i) {
        if (!(worst[i] > tally.worst)) continue;
        tally.worst = worst[i];
        tally.worst_chain = lane.chain;
        tally.worst_bond = static_cast<int64_t>(at[i]) + pieces.lane[i].first_bond - lane.first_bond;
    }
}

template <bool uniform_w, bool uniform_a>
static inline WindowResult solve_pieces(const Block &block, const Lane *piece, const PositionsCall &call,
                                        const BondLengths &a, const SegmentBlock &s, const Pieces &pieces,
                                        const Lane &lane, Arena arena, double *tau, Tally &tally) {
    // The lengths at the ends of a piece must be within the tolerance with the multipliers of its neighbour, too.
    PositionsCall strict = call;
    strict.tolerance = call.tolerance / 8;
    strict.v = AtomArray{};
    Positions<uniform_w, uniform_a> window(block, piece, strict, a, arena, tally);
    Newton &x = window.x;
    Carried carried(block, x, call, window.r);
    const mask all = first_lanes(W);
    window.load();
    // A guess does not help: it knows of the pulls beyond the ends of a piece, which are not there.
    const Outcome out = solve_positions<uniform_w, uniform_a, false>(block, x, strict, carried, all, false);
    const bool untouched = !any(all & ~out.untouched);
    if (!untouched && (any(all & ~out.converged) || any(coarse_moves<uniform_w>(block, x, carried, all))))
        return window_failed;
    if (call.report && any(less(splat(tally.worst), out.error)))
        note_worst_of_pieces<uniform_w, uniform_a>(x, s, pieces, lane, untouched, tally);
    if (untouched) return window_untouched;
    if (out.solves > tally.iterations) tally.iterations = out.solves;
    if (pieces.even) {
        Block own = own_block(s);
        for (int i = 0; i < W; ++i) own.first_bond[i] = s.from[i];
        store_bonds(own, x.tau + pieces.skip[0], splat(1.0), all, tau);
    } else {
        for (int i = 0; i < W; ++i)
            for (long k = 0; k < s.own[i]; ++k) tau[s.from[i] + k] = x.tau[k + pieces.skip[i]][i];
    }
    return window_solved;
}

// Largest |D.D - a^2| / a^2, as moved by tau, of the bonds on either side of atom `seam`; kept in the tally if it is
// the largest so far.
static inline double seam_error(const PositionsCall &call, const Lane &lane, int64_t seam, const double *tau,
                                Arena arena, Tally &tally) {
    const int64_t from = seam - 2 > 0 ? seam - 2 : 0, end = seam + 2 < lane.n_bonds ? seam + 2 : lane.n_bonds;
    const long n = static_cast<long>(end - from);
    Packed r_ref = {}, r = {};
    open_lane(call.r_ref, lane, from, n, n, r_ref, 0, arena.doubles(staged_size(n)), true);
    open_lane(call.r, lane, from, n, n, r, 0, arena.doubles(staged_size(n)), true);
    Vector3<double> pull[6] = {}, move[5];  // pull[k + 1]: of bond from + k
    const auto bond = [](const Box &box, const double *p) {
        Vector3<double> d = {p[3] - p[0], p[4] - p[1], p[5] - p[2]}, unused = {};
        if (box.shape != Box::none) wrap<false>(box, d, unused);
        return d;
    };
    for (long k = 0; k < n; ++k) {
        const Vector3<double> b = bond(call.box_ref, r_ref.lane[0] + 3 * k);
        pull[k + 1] = {tau[from + k] * b.x, tau[from + k] * b.y, tau[from + k] * b.z};
    }
    for (long k = 0; k <= n; ++k) {
        const double w = relative_w(lane, from + k);
        move[k] = {w * (pull[k + 1].x - pull[k].x), w * (pull[k + 1].y - pull[k].y), w * (pull[k + 1].z - pull[k].z)};
    }
    double worst = 0;
    for (int64_t k = seam - 1; k <= seam; ++k) {
        const long i = static_cast<long>(k - from);
        const double a = lane.length ? lane.length[k] : lane.length_uniform;
        Vector3<double> d = bond(call.box, r.lane[0] + 3 * i);
        d = {d.x + (move[i + 1].x - move[i].x), d.y + (move[i + 1].y - move[i].y), d.z + (move[i + 1].z - move[i].z)};
        const double error = abs(mul_add(d.z, d.z, mul_add(d.y, d.y, mul_add(d.x, d.x, -(a * a))))) / (a * a);
        if (!(error <= worst)) worst = error;
        if (!(error > tally.worst)) continue;
        tally.worst = error;
        tally.worst_bond = k;
    }
    return worst;
}

// Moves the atoms 1 .. own of the pieces, and the first one of the chain.
template <bool uniform_w, bool to_r, bool to_v>
static inline void move_window(const SegmentBlock &s, int64_t j, const Newton &x, const Packed &r, const Packed &v,
                               double per_dt) {
    const vec3 first = times(x.tau[0], x.b[0]);
    const MoveSink<to_r, to_v> sink = {r, v, splat(per_dt)};
    Block own = own_block(s);
    own.n = s.block.n;  // the last atom of a lane is pulled by the bond behind it, too
    store_pulls<true, uniform_w>(own, x.b, x.tau, first_lanes(W), sink, 1, first);
    if (j == 0) store_first(times_w<uniform_w>(x, 0, first), 1, sink);
}

}  // namespace HOL_ISA
}  // namespace holonomic
#endif
