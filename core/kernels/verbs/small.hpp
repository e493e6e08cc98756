// Small molecules: which kernel knows their number of bonds.
#ifndef HOLONOMIC_KERNELS_VERBS_SMALL_HPP
#define HOLONOMIC_KERNELS_VERBS_SMALL_HPP

#include "core/kernels/isa/choose.hpp"
#include "core/kernels/memory/small.hpp"

namespace holonomic::HOL_ISA {

// Calls kernel(place, uniform, boxed) for the molecules from `first` on, where place.type is one of memory/small.hpp.
// The kernel returns the first molecule that is not done. `uniform`: equal masses, and `one_length`. `boxed`: there may
// be a box. Units that are not regular need no block: molecules with as many bonds as the first one are done.
template <class Kernel>
static inline int64_t any_molecules(const Unit &unit, const Block &block, int64_t first, bool boxed, bool one_length,
                                    const Kernel &kernel) {
    constexpr Constant<bool, true> yes{};
    constexpr Constant<bool, false> no{};
    const Lane &head = unit.lanes[unit.regular ? 0 : first];
    const bool in_row = unit.regular && !head.atoms;
    if (head.n_bonds > (boxed || !in_row ? largest_boxed_molecule : largest_molecule)) return first;
    if (!unit.regular)
        return choose_number<1, largest_boxed_molecule>(head.n_bonds,
                                                        [&](auto n) { return kernel(Type<ByLanes<n>>{}, no, yes); });
    return choose_number<1, largest_molecule>(head.n_bonds, [&](auto n) {
        return choose(
            [&](auto uniform) {
                if constexpr (n <= largest_boxed_molecule) {
                    if (!in_row) return kernel(Type<ByList<n>>{}, uniform, yes);
                    if (boxed) return kernel(Type<InRow<n>>{}, uniform, yes);
                }
                return kernel(Type<InRow<n>>{}, uniform, no);
            },
            block.uniform_w && one_length);
    });
}

}  // namespace holonomic::HOL_ISA
#endif
