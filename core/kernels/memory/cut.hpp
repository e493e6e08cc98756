// How a long chain is cut into segments, W of them at a time, and where they stand in the caller's arrays.
#pragma once

#include <stdint.h>

#include "core/kernels/arithmetic/image.hpp"
#include "core/kernels/memory/open.hpp"

namespace holonomic::HOL_ISA {

// segment_bonds: bonds of a block of segments, in all lanes. So many stay in cache, and no segment is long enough to
// lose digits in taut chains. With one lane a block is a single segment; 256 keeps it below half of the chain.
// window_bonds: bonds of a lane's window without its margins. So many stay in the second-level cache.
constexpr int64_t segment_bonds = W < 2 ? 256 : 1024, window_bonds = 512, longest_margin = 96;

// Bonds of a lane in the longest block of a long chain. Rounding up and neighbours add at most 12.
constexpr int64_t longest_segment = segment_bonds / W + 12, longest_window = window_bonds + 12 + 2 * longest_margin;
constexpr int64_t longest_cut = longest_segment > longest_window ? longest_segment : longest_window;

// How a chain is cut. The W segments of a block have the same number of bonds, a multiple of `step`; only the last one
// of the chain may be shorter. The cut depends on nothing but the chain's length, so results depend on neither threads
// nor other chains. A chain inside a molecule goes on at both ends: the bond behind its last segment is a separator,
// too. It has a multiple of W bonds, so that all segments of a block are equally long.
struct Cut {
    static constexpr int64_t longest_step = W <= 8 ? 4 : 1;
    int64_t n_bonds, step, blocks, base,
        extra;  // the first `extra` blocks have step W bonds more than the others, step W base
    bool inside;
    int64_t bonds_behind = 0;                      // inside a molecule: bonds of chains that are eliminated later
    long to_atoms_before = 0, to_kept_before = 0;  // and distances to the chain before it, see find_block_before()
    // bonds_per_block: of all lanes.
    explicit Cut(int64_t n, int64_t bonds_per_block = segment_bonds, bool within = false)
        : n_bonds(n), step(within ? 1 : longest_step), inside(within) {
        const int64_t steps = (n + step * W - 1) / (step * W);
        blocks = (n + bonds_per_block - 1) / bonds_per_block;
        base = steps / blocks;
        extra = steps % blocks;
    }
    int64_t rows(int64_t block) const { return step * (base + (block < extra ? 1 : 0)); }  // bonds of each lane
    int64_t first_row(int64_t block) const { return step * (block * base + (block < extra ? block : extra)); }
    int64_t first(int64_t s) const { return first_row(s / W) * W + s % W * rows(s / W); }
    int64_t length(int64_t s) const { return s == blocks * W - 1 ? n_bonds - first(s) : rows(s / W); }
    int64_t longest() const { return rows(0); }
};

// The elimination starts from a separator and the bond behind it, so a segment needs two bonds. The shortest segment of
// all is the last one of the shortest chain that is cut.
constexpr int64_t steps_of_shortest = (longest_lane + Cut::longest_step * W) / (Cut::longest_step * W);
static_assert(longest_lane + 1 - (W - 1) * Cut::longest_step * steps_of_shortest >= 2,
              "a segment of fewer than two bonds");

// The lanes of block j as chains. Each includes the separator behind its segment.
struct SegmentBlock {
    Block block;
    Lane lane[W];
    long own[W], own_min, own_max;  // bonds of each segment
    int64_t from[W];                // its first bond in the chain
    int last;                       // lane of the segment that the chain ends with, or -1
    bool begins;                    // whether the chain begins with lane 0
    long kept_ahead;                // as block.ahead, of what is kept of the bonds
};

static inline SegmentBlock segment_block(const Cut &cut, int64_t j, const Lane &chain) {
    SegmentBlock s;
    Lane part[W];
    s.own_min = cut.longest() + 1;
    s.own_max = 0;
    s.kept_ahead = 0;
    s.last = j == cut.blocks - 1 && !cut.inside ? W - 1 : -1;
    s.begins = j == 0 && !cut.inside;
    for (int i = 0; i < W; ++i) {
        s.from[i] = cut.first(j * W + i);
        s.own[i] = cut.length(j * W + i);
        part[i] = part_of(chain, s.from[i], s.own[i] + (i == s.last ? 0 : 1));
        s.own_min = s.own[i] < s.own_min ? s.own[i] : s.own_min;
        s.own_max = s.own[i] > s.own_max ? s.own[i] : s.own_max;
    }
    open_block(Unit{part, W, false, false}, 0, s.block, s.lane);
    return s;
}

// The segments without the separators that follow them.
static inline Block own_block(const SegmentBlock &s) {
    Block block = s.block;
    block.n = s.own_max;
    block.n_min = s.own_min;
    for (int i = 0; i < W; ++i) block.len[i] = s.own[i];
    return block;
}

// Copies staged segments back: the atoms that the lane wrote.
static inline void close_segments(const AtomArray &array, const SegmentBlock &s, const Lane &lane, const Packed &packed,
                                  bool add) {
    if (in_place(array, lane)) return;
    for (int i = 0; i < W; ++i) {
        const long first = s.begins && i == 0 ? 0 : 1;
        unstage(array, lane, s.from[i] + first, s.own[i] - first, packed.lane[i] + 3 * first, add);
    }
}

// Bond vectors of the separators behind W segments.
struct SeparatorsBehind {
    vec3 d = {}, low = {};
    SeparatorsBehind(const SegmentBlock &s, const Box &box, const Packed &r) {
        for (int i = 0; i < W; ++i) {
            if (i == s.last) {
                d.x[i] = 1;
                continue;
            }
            const double *p = r.lane[i] + 3 * s.own[i];
            Vector3<double> one, one_low;
            unrounded_bond(box, p, p + 3, one, one_low);
            d.x[i] = one.x;
            d.y[i] = one.y;
            d.z[i] = one.z;
            low.x[i] = one_low.x;
            low.y[i] = one_low.y;
            low.z[i] = one_low.z;
        }
    }
};

// A long chain in windows: W parts of it with a margin on either side, worked on in cache as chains of their own. What
// happens beyond the end of a part is felt k joints further in by no more than the product of their |l|, which dies
// within a few dozen bonds of a coil; what is found for the margins is thrown away. A chain whose ends are felt farther
// is worked on in a lane of its own.

constexpr long shortest_window = 96;  // with shorter ones the margins would cost too much
constexpr double negligible = 1e-19;  // of what happens beyond a margin

static inline Cut windows(int64_t n_bonds) { return Cut(n_bonds, window_bonds * W); }

// How many bonds beyond an atom of the chain, in the direction `step` (1 or -1), a part needs there; those to the end
// of the chain if that comes first. Or -1: too many.
//
// Elimination towards the margin finds P = w q + E at a joint and E >= w' q sin'^2, where ' is the joint before, at an
// atom of inverse mass w': |l| <= |cos| / (1 + (w' / w) sin'^2), for equal lengths.
//
// `beyond`: so many of the bonds there must be right, too, and it counts from behind them.
static inline long margin(const AtomArray &array, const Box &box, const Lane &lane, int64_t atom, int step, long beyond,
                          Arena arena) {
    const int64_t to_end = step > 0 ? lane.n_bonds - atom : atom;
    const long most = to_end < longest_margin ? static_cast<long>(to_end) : longest_margin;
    Packed r = {};
    open_lane(array, lane, step > 0 ? atom : atom - most, most, most, r, 0, arena.next, true);
    const double *p = r.lane[0] + (step > 0 ? 0 : 3 * most) + 3 * step * beyond;
    Vector3<double> before = {};
    double q = 1, w_before = 0, sin2 = 0, left = 1;  // left: the square of what is left
    for (long k = beyond; k < most; ++k, p += 3 * step) {
        const double w = relative_w(lane, atom + step * k);
        if (w == 0) return k;
        const Vector3<double> d = bond_vector(box, p, p + 3 * step);
        const double q1 = dot(d, d), g = dot(before, d), qq = q * q1, gg = g * g;
        if (k > beyond) {
            const double spare = 1 + (lane.w ? w_before / w : 1.0) * sin2;
            left *= gg / (qq * (spare * spare));
            if (left < negligible * negligible) return k;
            sin2 = 1 - gg / qq - 0x1p-48;  // less its rounding, which w' / w might blow up
            if (sin2 < 0) sin2 = 0;
        }
        w_before = w;
        before = d;
        q = q1;
    }
    return most == to_end ? most : -1;
}

struct Window {
    SegmentBlock own;  // the parts without their margins
    Lane lane[W];      // with them: the same margins for all, but at the ends of the chain
    Block block;       // of these
    long skip[W];      // bonds of the margin before
    bool even;         // the same in all
};

// Window j of a chain, whose bonds are those of `r`. `beyond`: bonds behind a part whose pull it needs to write its
// last atom. Returns false if windows don't pay or won't do.
static inline bool open_window(const AtomArray &r, const Box &box, const Lane &chain, int64_t j, long beyond,
                               Arena &arena, Window &x) {
    x.own = segment_block(windows(chain.n_bonds), j, chain);
    const SegmentBlock &s = x.own;
    if (s.own_max < shortest_window) return false;
    long before = 0, behind = 0;
    for (int i = 0; i < W; ++i) {
        const long left = margin(r, box, chain, s.from[i], -1, 0, arena);
        const long right = margin(r, box, chain, s.from[i] + s.own[i], 1, beyond, arena);
        if (left < 0 || right < 0) return false;
        before = left > before ? left : before;
        behind = right > behind ? right : behind;
    }
    Lane part[W];
    x.even = true;
    for (int i = 0; i < W; ++i) {
        const int64_t from = s.from[i] > before ? s.from[i] - before : 0, end = s.from[i] + s.own[i] + behind;
        part[i] = part_of(chain, from, (end < chain.n_bonds ? end : chain.n_bonds) - from);
        x.skip[i] = static_cast<long>(s.from[i] - from);
        x.even = x.even && x.skip[i] == x.skip[0];
    }
    open_block(Unit{part, W, false, false}, 0, x.block, x.lane);
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
