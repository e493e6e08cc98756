// Blocks of a unit: what is in their lanes, and where; their inverse masses.
#pragma once

#include "core/kernels/memory/arena.hpp"
#include "core/kernels/memory/block.hpp"
#include "core/kernels/memory/stage.hpp"
#include "core/kernels/tally.hpp"

namespace holonomic::HOL_ISA {

// Inverse masses of the lanes: constant along each, or tables in scratch.
void set_masses(Block &, const Lane *, Arena &);

// Then, unless it is done: tables of those that forces are multiplied with as they are read, component by component.
void repeat_masses(Block &, const Lane *, Arena &);

void note_bad(const Block &, mask bad, Tally &);

// Fills a block with the chains first .. first + lanes - 1 of a unit. In a regular unit `block` may still hold the
// block before; what both have in common is kept.
void open_block(const Unit &, int64_t first, Block &, Lane *);

HOL_INLINE bool in_place(const AtomArray &array, const Block &block) { return array.packed && !block.staged; }

// Returns where the lanes of a block are: in the caller's array, or in staging buffers if it can't be used in place.
Packed open_staged(const AtomArray &, const Block &, const Lane *, Arena &, bool read);
HOL_INLINE Packed open(const AtomArray &array, const Block &block, const Lane *lane, Arena &arena, bool read) {
    if (!array.x) return {};
    if (!in_place(array, block)) return open_staged(array, block, lane, arena, read);
    Packed packed;
    for (int i = 0; i < W; ++i)
        packed.lane[i] = reinterpret_cast<double *>(array.x) + 3 * lane[i < block.lanes ? i : 0].first_atom;
    return packed;
}

// Copies staged lanes back.
void close_staged(const AtomArray &, const Block &, const Lane *, mask which, const Packed &, bool add);
HOL_INLINE void close(const AtomArray &array, const Block &block, const Lane *lane, mask which, const Packed &packed,
                      bool add) {
    if (!in_place(array, block)) close_staged(array, block, lane, which, packed, add);
}

// What open_block() makes of a chain that comes alone, where a block has one lane.
HOL_INLINE void open_alone(const Lane &chain, bool large, Block &block) {
    block.n = block.n_min = block.len[0] = chain.n_bonds;
    block.lanes = 1;
    block.padded = false;
    block.ahead = large ? 3 * (chain.n_bonds + 1) : 0;
    block.list_ahead = 0;
    block.staged = chain.atoms != nullptr;
    block.first_bond[0] = chain.first_bond;
    block.chain[0] = chain.chain;
}

// Calls work(block, lane, call, arena, tally) for the blocks of a unit. Before that, small(call, unit, block, first,
// tally) does as many chains as it can and returns the first one that it leaves. In a unit that is not regular it
// gets no block. `repeated`: work needs repeat_masses().
template <class Call, class Work, class Small>
static inline void for_each_block(const Call &call, const Unit &unit, double *scratch, Tally &tally, Work work,
                                  Small small, bool repeated = true) {
    Block block;
    Lane lane[W];
    Arena arena(scratch, int64_t{0});
    if (W == 1 && unit.count == 1) {  // nothing is copied
        open_alone(unit.lanes[0], unit.large, block);
        arena = Arena(scratch, block.n);
        set_masses(block, unit.lanes, arena);
        if (small(call, unit, block, 0, tally) > 0) return;
        if (repeated) repeat_masses(block, unit.lanes, arena);
        work(block, unit.lanes, call, arena, tally);
        return;
    }
    for (int64_t first = 0; first < unit.count;) {
        int64_t next = unit.regular ? first : small(call, unit, block, first, tally);
        if (next == first) {
            open_block(unit, first, block, lane);
            if (first == 0 || !unit.regular || block.lanes < W) {
                arena = Arena(scratch, block.n);
                set_masses(block, lane, arena);
            }
            if (unit.regular && block.lanes == W) next = small(call, unit, block, first, tally);
        }
        if (next == first) {
            if (repeated) repeat_masses(block, lane, arena);
            work(block, lane, call, arena, tally);
            next = first + block.lanes;
        }
        first = next;
    }
}

// For `small` of calls that have no faster path.
template <class Call>
static inline int64_t no_molecules(const Call &, const Unit &, Block &, int64_t first, Tally &) {
    return first;
}

}  // namespace holonomic::HOL_ISA
