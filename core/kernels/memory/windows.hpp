// A long chain in windows: W pieces of it with a margin on either side, worked on in cache as chains of their own. What
// happens beyond the end of a piece is felt k joints further in by no more than the product of their |l|, which dies
// within a few dozen bonds of a coil; what is found for the margins is thrown away. A chain whose ends are felt farther
// is worked on in a lane of its own.
#ifndef HOLONOMIC_KERNELS_MEMORY_WINDOWS_HPP
#define HOLONOMIC_KERNELS_MEMORY_WINDOWS_HPP

#include "core/kernels/arithmetic/image.hpp"
#include "core/kernels/memory/cut.hpp"

namespace holonomic::HOL_ISA {

constexpr long shortest_piece = 96;   // with shorter ones the margins would cost too much
constexpr double negligible = 1e-19;  // of what happens beyond a margin

static inline Cut windows(int64_t n_bonds) { return Cut(n_bonds, window_bonds * W); }

// How many bonds beyond an atom of the chain, in the direction `step` (1 or -1), a piece needs there; those to the end
// of the chain if that comes first. Or -1: too many.
//
// Elimination towards the margin finds P = w q + E at a joint and E >= w' q sin'^2, where ' is the joint before, at an
// atom of inverse mass w': |l| <= |cos| / (1 + (w' / w) sin'^2), for equal lengths.
static inline long margin(const AtomArray &array, const Box &box, const Lane &lane, int64_t atom, int step,
                          Arena arena) {
    const int64_t to_end = step > 0 ? lane.n_bonds - atom : atom;
    const long most = to_end < longest_margin ? static_cast<long>(to_end) : longest_margin;
    Packed r = {};
    open_lane(array, lane, step > 0 ? atom : atom - most, most, most, r, 0, arena.next, true);
    const double *p = r.lane[0] + (step > 0 ? 0 : 3 * most);
    Vector3<double> before = {};
    double q = 1, w_before = 0, sin2 = 0, left = 1;  // left: the square of what is left
    for (long k = 0; k < most; ++k, p += 3 * step) {
        const double w = relative_w(lane, atom + step * k);
        if (w == 0) return k;
        const Vector3<double> d = bond_vector(box, p, p + 3 * step);
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

struct Window {
    SegmentBlock own;  // the pieces without their margins
    Lane lane[W];      // with them: the same margins for all, but at the ends of the chain
    Block block;       // of these
    long skip[W];      // bonds of the margin before
    bool even;         // the same in all
};

// Window j of a chain, whose bonds are those of `r`. Returns false if windows don't pay or won't do.
static inline bool open_window(const AtomArray &r, const Box &box, const Lane &chain, int64_t j, Arena &arena,
                               Window &x) {
    x.own = segment_block(windows(chain.n_bonds), j, chain);
    const SegmentBlock &s = x.own;
    if (s.own_max < shortest_piece) return false;
    long before = 0, behind = 0;
    for (int i = 0; i < W; ++i) {
        const long left = margin(r, box, chain, s.from[i], -1, arena);
        const long right = margin(r, box, chain, s.from[i] + s.own[i], 1, arena);
        if (left < 0 || right < 0) return false;
        before = left > before ? left : before;
        behind = right > behind ? right : behind;
    }
    Lane piece[W];
    x.even = true;
    for (int i = 0; i < W; ++i) {
        const int64_t from = s.from[i] > before ? s.from[i] - before : 0, end = s.from[i] + s.own[i] + behind;
        piece[i] = part_of(chain, from, (end < chain.n_bonds ? end : chain.n_bonds) - from);
        x.skip[i] = static_cast<long>(s.from[i] - from);
        x.even = x.even && x.skip[i] == x.skip[0];
    }
    open_block(Unit{piece, W, false, false}, 0, x.block, x.lane);
    set_masses(x.block, x.lane, arena);
    return true;
}

// Calls body(j, scratch, part) for the windows j = 0 .. n-1.
template <class Body>
static void for_each_window(const LongTeam &team, int64_t n, Tally &total, const Body &body) {
    const auto call = [](const void *b, int64_t j, double *scratch, Tally &part) {
        (*static_cast<const Body *>(b))(j, scratch, part);
    };
    team.run(team.threads, n, total, call, &body);
}

}  // namespace holonomic::HOL_ISA
#endif
