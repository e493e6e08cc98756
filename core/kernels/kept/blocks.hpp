// The blocks of a unit as they were kept: those of for_each_block(). What the next one has in common with the last one
// is not found again.
#pragma once

#include "core/kernels/molecules/atoms/layout.hpp"
#include "core/kernels/molecules/blocks.hpp"

namespace holonomic::HOL_ISA::graph {

template <class V>
HOL_INLINE Atoms<V> kept_atoms(const MoleculeUnit &unit, int64_t first, int used) {
    MoleculeLane lane[Width<V>::lanes];
    for (int i = 0; i < used; ++i) lane[i] = molecule_of(unit, first + i);
    return Atoms<V>(lane, used, true);
}
HOL_INLINE int64_t number_of(const MoleculeUnit &unit, int64_t i) {
    return unit.regular ? unit.lanes[0].molecule + i : unit.lanes[i].molecule;
}

// Calls body(atoms, first, used) for each block: the first of its molecules, and how many.
template <class Body>
HOL_INLINE void for_each_kept_block(const MoleculeUnit &unit, const Body &body) {
    int64_t first = 0;
    if (unit.count >= W) {
        Atoms<vec> at = kept_atoms<vec>(unit, 0, W);
        for (;;) {
            body(at, first, W);
            first += W;
            if (unit.count - first < W) break;
            if (unit.regular && at.layout == rows_in_order)
                at.advance(unit.elimination->n_atoms, unit.elimination->n_bonds);
            else
                at = kept_atoms<vec>(unit, first, W);
        }
    }
    const int left = static_cast<int>(unit.count - first);
    if (left > 1) body(kept_atoms<vec>(unit, first, left), first, left);
    if (left == 1) body(kept_atoms<double>(unit, first, 1), first, 1);
}

}  // namespace holonomic::HOL_ISA::graph
