// Blocks of a unit: what is in their lanes, and where; their inverse masses.
#ifndef HOLONOMIC_KERNELS_MEMORY_OPEN_HPP
#define HOLONOMIC_KERNELS_MEMORY_OPEN_HPP

#include "core/kernels/memory/arena.hpp"
#include "core/kernels/memory/block.hpp"
#include "core/kernels/memory/stage.hpp"
#include "core/kernels/tally.hpp"

namespace holonomic::HOL_ISA {

// Inverse masses of the lanes: constant along each, or tables in scratch. `thrice`: also those that forces are
// multiplied with as they are read.
static inline void set_masses(Block &block, const Lane *lane, Arena &arena, bool thrice = true) {
    const double *table[W];
    double constant[W];  // where there is no table
    block.uniform_w = true;
    for (int i = 0; i < W; ++i) {
        const Lane &of = lane[i < block.lanes ? i : 0];
        const bool has_unit = !of.w && of.w_uniform > 0;  // not in a chain of nothing but fixed atoms
        table[i] = of.w;
        constant[i] = has_unit ? 1.0 : of.w_uniform;
        block.movable[i] = has_unit || of.w ? -1 : 0;
        block.unit[i] = has_unit ? of.w_uniform : 1.0;
        block.uniform_w = block.uniform_w && has_unit;
    }
    block.mass = splat(1.0) / block.unit;
    block.unit_masses = block.uniform_w && !any(~equal(block.mass, splat(1.0)));
    if (block.uniform_w) return;
    vec *w = arena.vecs(block.n + 1);
    bool same = true;
    for (int i = 1; i < W; ++i)
        same = same && table[i] == table[0] && constant[i] == constant[0] && block.len[i] == block.len[0];
    const auto value = [&](int i, long k) HOL_FORCED {  // inert bonds past the end: any positive mass
        return k > block.len[i] ? 1.0 : (table[i] ? table[i][k] : constant[i]);
    };
    interleave(table, block.len, 1, block.n + 1, w, value);
    block.w = w;
    for (int i = 0; i < W && thrice; ++i) {
        if (i > 0 && same) {
            block.w3[i] = block.w3[0];
            continue;
        }
        double *const w3 = arena.doubles(3 * (block.n + 1 + W));
        long k = 0;
        for (; table[i] && k + W <= block.len[i] + 1; k += W) {
            const vec x = load(table[i] + k);
            HOL_UNROLL
            for (int j = 0; j < 3; ++j) {
                vec three = {};
                HOL_UNROLL
                for (int e = 0; e < W; ++e) three[e] = x[(j * W + e) / 3];
                store(w3 + 3 * k + j * W, three);
            }
        }
        for (; k < block.n + 1 + W; ++k) w3[3 * k] = w3[3 * k + 1] = w3[3 * k + 2] = value(i, k);
        block.w3[i] = w3;
    }
}

static inline void note_bad(const Block &block, mask bad, Tally &tally) {
    const unsigned which = bits(bad & block.in_use());
    for (int i = 0; i < block.lanes; ++i)
        if (which >> i & 1) note_bad(block.chain[i], tally);
}

// Fills a block with the chains first .. first + lanes - 1 of a unit. In a regular unit `block` may still hold the
// block before; what both have in common is kept.
static inline void open_block(const Unit &unit, int64_t first, Block &block, Lane *lane) {
    const int64_t left = unit.count - first;
    block.lanes = left < W ? static_cast<int>(left) : W;
    block.roomy = block.staged = false;
    block.ahead = block.list_ahead = 0;
    if (unit.regular) {
        const Lane &head = unit.lanes[0];
        const int64_t n = head.n_bonds;
        if (first == 0) {
            block.n = block.n_min = n;
            for (int i = 0; i < W; ++i) {
                lane[i] = head;
                block.len[i] = n;
            }
        }
        for (int i = 0; i < block.lanes; ++i) {
            const int64_t c = first + i;
            lane[i].first_atom = head.first_atom + c * (n + 1);
            if (head.atoms) lane[i].atoms = head.atoms + c * (n + 1);
            lane[i].first_bond = block.first_bond[i] = head.first_bond + c * n;
            lane[i].chain = block.chain[i] = head.chain + c;
        }
        block.staged = head.atoms != nullptr;
        block.roomy = (left - block.lanes) * (n + 1) >= W && !block.staged;
        if (unit.large) block.ahead = 3 * W * (n + 1);  // the next unit often goes on where this one ends
        if (unit.large && left >= 2 * W) block.list_ahead = W * (n + 1);
        return;
    }
    block.n = 0;
    block.n_min = unit.lanes[first].n_bonds;
    for (int i = 0; i < block.lanes; ++i) {
        lane[i] = unit.lanes[first + i];
        block.staged = block.staged || lane[i].atoms;
        block.len[i] = lane[i].n_bonds;
        block.first_bond[i] = lane[i].first_bond;
        block.chain[i] = lane[i].chain;
        if (lane[i].n_bonds > block.n) block.n = lane[i].n_bonds;
        if (lane[i].n_bonds < block.n_min) block.n_min = lane[i].n_bonds;
    }
    for (int i = block.lanes; i < W; ++i) block.len[i] = block.len[0];
    // If chains of one length stand one behind the other, the next block often goes on where this one ends.
    bool consecutive = unit.large && !block.staged && block.lanes == W && block.n == block.n_min;
    for (int i = 1; i < block.lanes; ++i)
        consecutive = consecutive && lane[i].first_atom == lane[0].first_atom + i * (block.n + 1);
    if (consecutive) block.ahead = 3 * W * (block.n + 1);
}

HOL_INLINE bool in_place(const AtomArray &array, const Block &block) { return array.packed && !block.staged; }

// Returns where the lanes of a block are: in the caller's array, or in staging buffers if it can't be used in place.
static inline Packed open(const AtomArray &array, const Block &block, const Lane *lane, Arena &arena, bool read) {
    Packed packed = {};
    if (!array.x) return packed;
    const bool direct = in_place(array, block);
    for (int i = 0; i < block.lanes; ++i) {
        if (direct) {
            packed.lane[i] = reinterpret_cast<double *>(array.x) + 3 * lane[i].first_atom;
        } else {
            packed.lane[i] = arena.doubles(staged_size(block.n));
            if (read) stage(array, lane[i], 0, block.len[i], packed.lane[i]);
        }
    }
    repeat_first(packed, block.lanes);
    return packed;
}

// Copies staged lanes back.
static inline void close(const AtomArray &array, const Block &block, const Lane *lane, mask which, const Packed &packed,
                         bool add) {
    if (in_place(array, block)) return;
    const unsigned chosen = bits(which & block.in_use());
    for (int i = 0; i < block.lanes; ++i)
        if (chosen >> i & 1) unstage(array, lane[i], 0, block.len[i], packed.lane[i], add);
}

// Calls work(block, lane, call, arena, tally) for the blocks of a unit. Before that, small(call, unit, block, first,
// tally) does as many chains as it can and returns the first one that it leaves. In a unit that is not regular it
// gets no block.
template <class Call, class Work, class Small>
static inline void for_each_block(const Call &call, const Unit &unit, double *scratch, Tally &tally, Work work,
                                  Small small) {
    Block block;
    Lane lane[W];
    Arena arena(scratch, int64_t{0});
    const auto leave_to_small = [&](int64_t &first) {
        const int64_t next = small(call, unit, block, first, tally);
        if (next == first) return false;
        first = next - W;  // the rest goes on from there
        return true;
    };
    for (int64_t first = 0; first < unit.count; first += W) {
        if (!unit.regular && leave_to_small(first)) continue;
        open_block(unit, first, block, lane);
        if (first == 0 || !unit.regular || block.lanes < W) {
            arena = Arena(scratch, block.n);
            set_masses(block, lane, arena);
        }
        if (unit.regular && block.lanes == W && leave_to_small(first)) continue;
        work(block, lane, call, arena, tally);
    }
}

// For `small` of calls that have no faster path.
template <class Call>
static inline int64_t no_molecules(const Call &, const Unit &, Block &, int64_t first, Tally &) {
    return first;
}

}  // namespace holonomic::HOL_ISA
#endif
