// Small molecules: which kernel knows their number of bonds.
#ifndef HOLONOMIC_KERNELS_VERBS_SMALL_HPP
#define HOLONOMIC_KERNELS_VERBS_SMALL_HPP

#include "core/kernels/memory/fixed.hpp"

namespace holonomic {
namespace HOL_ISA {

// Of<N, uniform>::run(call, unit, block, first) for molecules of N bonds, from molecule `first` on; returns the first
// one that is not done.
template <template <int, bool> class Of, class Call>
static int64_t any_molecules(const Call &call, const Unit &unit, const Block &block, int64_t first) {
    if (!unit.regular || unit.lanes[0].atoms || unit.lanes[0].n_bonds > largest_molecule) return first;
    const bool uniform = block.uniform_w;
    switch (unit.lanes[0].n_bonds) {
        case 1:
            return uniform ? Of<1, true>::run(call, unit, block, first) : Of<1, false>::run(call, unit, block, first);
        case 2:
            return uniform ? Of<2, true>::run(call, unit, block, first) : Of<2, false>::run(call, unit, block, first);
        case 3:
            return uniform ? Of<3, true>::run(call, unit, block, first) : Of<3, false>::run(call, unit, block, first);
        case 4:
            return uniform ? Of<4, true>::run(call, unit, block, first) : Of<4, false>::run(call, unit, block, first);
        default:
            return uniform ? Of<5, true>::run(call, unit, block, first) : Of<5, false>::run(call, unit, block, first);
    }
}

}  // namespace HOL_ISA
}  // namespace holonomic
#endif
