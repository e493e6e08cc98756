// Position level of a block of chains: load, iterate (newton/iterate.hpp), move the atoms, store.
#include "core/kernels/isa/choose.hpp"
#include "core/kernels/newton/attempts.hpp"
#include "core/kernels/newton/listed.hpp"
#include "core/kernels/verbs/positions_small.hpp"
#include "core/kernels/verbs/verbs.hpp"

namespace holonomic::HOL_ISA {

template <bool uniform_w, bool uniform_a>
static inline void positions_block(const Block &block, const Lane *lane, const PositionsCall &call,
                                   const BondLengths &a, Arena arena, Tally &tally) {
    if (block.staged && listed_positions<uniform_w, uniform_a>(block, lane, call, a, arena, tally)) return;
    Positions<uniform_w, uniform_a>(block, lane, call, a, arena, tally).solve();
}

void positions(const PositionsCall &call, const Unit &unit, double *scratch, Tally &tally) {
    BondLengths lengths = {};
    const double *begin = nullptr;
    double *end = nullptr;
    for_each_block(
        call, unit, scratch, tally,
        [&](const Block &block, const Lane *lane, const PositionsCall &, Arena arena, Tally &) {
            if (unit.regular && begin == arena.next) {  // as the chains of the block before, and in place
                arena.next = end;
            } else {
                begin = arena.next;
                lengths = bond_lengths(block, lane, arena);
                end = arena.next;
            }
            choose(
                [&](auto uniform_w, auto uniform_a) {
                    positions_block<uniform_w, uniform_a>(block, lane, call, lengths, arena, tally);
                },
                block.uniform_w, !lengths.a2);
        },
        small_positions);
}

}  // namespace holonomic::HOL_ISA
