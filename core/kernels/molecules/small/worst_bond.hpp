// What a report says of small molecules side by side.
#pragma once

#include "core/kernels/arithmetic/width.hpp"
#include "core/kernels/molecules/iterate.hpp"
#include "core/kernels/tally.hpp"

namespace holonomic::HOL_ISA::graph {

// The worst bond of the molecules in `which`, from the errors of all, N in the order of the bonds: of a molecule the
// one with the smallest number.
template <int N, class V, class Lanes>
HOL_NOINLINE void note_worst_bond(const V *size, const Lanes &lanes, V error, unsigned which, Tally &tally) {
    for (int i = 0; i < Width<V>::lanes; ++i) {
        if (!(which >> i & 1)) continue;
        const double e = Width<V>::get(error, i);
        if (!take_worst(tally, e, lanes.molecule(i))) continue;
        tally.worst_bond = 0;
        for (int k = N - 1; k >= 0; --k)
            if (Width<V>::get(size[k], i) >= e) tally.worst_bond = k;
    }
}

}  // namespace holonomic::HOL_ISA::graph
