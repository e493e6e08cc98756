// The lanes of a chunk of work one by one, for work that is not done in lanes.
#pragma once

#include <cstdint>
#include <type_traits>

#include "core/kernels/call.hpp"
#include "core/plan/elimination.hpp"

namespace holonomic {

// What a unit has of each molecule.
template <class AnyUnit>
using LaneOf = std::remove_const_t<std::remove_pointer_t<decltype(AnyUnit::lanes)>>;

template <class AnyLane>
inline AnyLane shifted(AnyLane lane, std::int64_t n_atoms, std::int64_t n_bonds) {
    lane.first_atom += n_atoms;
    if (lane.atoms) lane.atoms += n_atoms;
    lane.first_bond += n_bonds;
    return lane;
}

// Molecule i of a unit. Of a chain, `element` is not filled in.
inline Lane lane_of(const Unit &unit, std::int64_t i) {
    if (!unit.regular) return unit.lanes[i];
    const std::int64_t n_bonds = unit.lanes[0].n_bonds;
    Lane lane = shifted(unit.lanes[0], i * (n_bonds + 1), i * n_bonds);
    lane.chain += i;
    return lane;
}
inline MoleculeLane lane_of(const MoleculeUnit &unit, std::int64_t i) {
    if (!unit.regular) return unit.lanes[i];
    MoleculeLane lane = shifted(unit.lanes[0], i * unit.elimination->n_atoms, i * unit.elimination->n_bonds);
    lane.molecule += i;
    return lane;
}

}  // namespace holonomic
