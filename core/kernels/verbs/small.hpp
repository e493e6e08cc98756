// Small molecules: which kernel knows their number of bonds.
#ifndef HOLONOMIC_KERNELS_VERBS_SMALL_HPP
#define HOLONOMIC_KERNELS_VERBS_SMALL_HPP

#include "core/kernels/memory/loose.hpp"

namespace holonomic {
namespace HOL_ISA {

// Of<N, uniform, boxed, Place>::run(call, unit, block, first) for molecules of N bonds, from molecule `first` on;
// returns the first one that is not done. Place: of memory/fixed.hpp.
template <int N, template <int, bool, bool, template <int> class> class Of, class Call>
static int64_t molecules_of(const Call &call, const Unit &unit, const Block &block, int64_t first, bool uniform,
                            bool boxed, Tally &tally) {
    if constexpr (N <= largest_boxed_molecule) {
        if (unit.lanes[0].atoms)
            return uniform ? Of<N, true, true, ByList>::run(call, unit, block, first, tally)
                           : Of<N, false, true, ByList>::run(call, unit, block, first, tally);
        if (boxed)
            return uniform ? Of<N, true, true, InRow>::run(call, unit, block, first, tally)
                           : Of<N, false, true, InRow>::run(call, unit, block, first, tally);
    }
    return uniform ? Of<N, true, false, InRow>::run(call, unit, block, first, tally)
                   : Of<N, false, false, InRow>::run(call, unit, block, first, tally);
}

// `boxed`: there is a box. Units that are not regular need no block: of these, those that have as many bonds as the
// first one are done.
template <template <int, bool, bool, template <int> class> class Of, class Call>
static int64_t any_molecules(const Call &call, const Unit &unit, const Block &block, int64_t first, bool boxed,
                             Tally &tally, bool one_length = true) {
    if (!unit.regular) {
        switch (unit.lanes[first].n_bonds) {
            case 1:
                return Of<1, false, true, ByLanes>::run(call, unit, block, first, tally);
            case 2:
                return Of<2, false, true, ByLanes>::run(call, unit, block, first, tally);
            case 3:
                return Of<3, false, true, ByLanes>::run(call, unit, block, first, tally);
            default:
                return first;
        }
    }
    const Lane &head = unit.lanes[0];
    const bool uniform = block.uniform_w && one_length;
    if (head.n_bonds > (boxed || head.atoms ? largest_boxed_molecule : largest_molecule)) return first;
    switch (head.n_bonds) {
        case 1:
            return molecules_of<1, Of>(call, unit, block, first, uniform, boxed, tally);
        case 2:
            return molecules_of<2, Of>(call, unit, block, first, uniform, boxed, tally);
        case 3:
            return molecules_of<3, Of>(call, unit, block, first, uniform, boxed, tally);
        case 4:
            return molecules_of<4, Of>(call, unit, block, first, uniform, boxed, tally);
        default:
            return molecules_of<5, Of>(call, unit, block, first, uniform, boxed, tally);
    }
}

}  // namespace HOL_ISA
}  // namespace holonomic
#endif
