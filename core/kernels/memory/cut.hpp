// How a long chain is cut into segments, W of them at a time, and where they stand in the caller's arrays.
#ifndef HOLONOMIC_KERNELS_MEMORY_CUT_HPP
#define HOLONOMIC_KERNELS_MEMORY_CUT_HPP

#include "core/kernels/memory/masses.hpp"
#include "core/kernels/memory/stage.hpp"

namespace holonomic {
namespace HOL_ISA {

// Bonds of a block of segments, all lanes: so that what is kept of it stays in cache, and no segment is so long that it
// loses digits in taut chains; nor half of the chain, as a single lane's would be. Of a lane's window without its
// margins: so much stays in the second-level cache.
constexpr int64_t segment_bonds = W < 2 ? 256 : 1024, window_bonds = 512, longest_margin = 96;

// Bonds of a lane in the longest block that a long chain is cut into; rounding up and neighbours are at most 12 more.
constexpr int64_t longest_segment = segment_bonds / W + 12, longest_window = window_bonds + 12 + 2 * longest_margin;
constexpr int64_t longest_piece = longest_segment > longest_window ? longest_segment : longest_window;

// How a chain is cut: blocks of W segments of the same number of bonds, a multiple of `step`; the chain's last segment
// may be shorter. Depends on the chain's length alone, so that results depend on neither threads nor other chains.
struct Cut {
    static constexpr int64_t step = W <= 8 ? 4 : 1;
    int64_t n_bonds, blocks, base,
        extra;  // the first `extra` blocks have step W bonds more than the others, step W base
    // bonds_per_block: of all lanes; so that what is kept of a block stays in cache.
    explicit Cut(int64_t n, int64_t bonds_per_block = segment_bonds) : n_bonds(n) {
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

// The last segment of the shortest chain that is cut is the shortest of all. The elimination starts from its separator
// and the bond behind that.
constexpr int64_t steps_of_shortest = (longest_lane + Cut::step * W) / (Cut::step * W);
static_assert(longest_lane + 1 - (W - 1) * Cut::step * steps_of_shortest >= 2, "a segment of fewer than two bonds");

// The lanes of block j as chains of their own: len counts the bonds of the segment and the separator that follows.
struct SegmentBlock {
    Block block;
    long own[W], own_min, own_max;  // bonds of each segment
    int64_t from[W];                // its first bond in the chain
    int last;                       // lane of the chain's last segment, or -1
};

static inline SegmentBlock segment_block(const Cut &cut, int64_t j, const Lane &lane) {
    SegmentBlock s;
    s.block.lanes = W;
    s.block.roomy = false;
    s.block.ahead = s.block.list_ahead = 0;
    s.block.n = 0;
    s.block.n_min = s.own_min = cut.longest() + 1;
    s.own_max = 0;
    s.last = j == cut.blocks - 1 ? W - 1 : -1;
    for (int i = 0; i < W; ++i) {
        const int64_t segment = j * W + i;
        s.from[i] = cut.first(segment);
        s.own[i] = cut.length(segment);
        s.block.len[i] = s.own[i] + (i == s.last ? 0 : 1);
        s.block.first_bond[i] = lane.first_bond + s.from[i];
        s.block.chain[i] = lane.chain;
        s.own_min = s.own[i] < s.own_min ? s.own[i] : s.own_min;
        s.own_max = s.own[i] > s.own_max ? s.own[i] : s.own_max;
        s.block.n_min = s.block.len[i] < s.block.n_min ? s.block.len[i] : s.block.n_min;
        s.block.n = s.block.len[i] > s.block.n ? s.block.len[i] : s.block.n;
    }
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

static inline void set_segment_masses(SegmentBlock &s, const Lane &lane, Arena &arena) {
    const double *tables[W];
    double uniform[W];
    for (int i = 0; i < W; ++i) {
        tables[i] = lane.w ? lane.w + s.from[i] : nullptr;
        uniform[i] = lane.w_uniform;
    }
    set_masses(s.block, tables, uniform, arena);
}

// Where the segments are found, in the caller's array or in staging buffers.
static inline Packed open_segments(const AtomArray &array, const SegmentBlock &s, const Lane &lane, Arena &arena,
                                   bool read) {
    Packed packed = {};
    if (!array.x) return packed;
    double *staging = nullptr;
    if (!in_place(array, lane)) staging = arena.doubles(W * staged_size(s.block.n));
    for (int i = 0; i < W; ++i) open_lane(array, lane, s.from[i], s.block.len[i], s.block.n, packed, i, staging, read);
    return packed;
}

HOL_INLINE mask ends_at(const SegmentBlock &s, long k) {
    mask m;
    for (int i = 0; i < W; ++i) m[i] = s.own[i] == k ? -1 : 0;
    return m;
}

}  // namespace HOL_ISA
}  // namespace holonomic
#endif
