// Multipliers of bonds within bodies that are held by their lengths: of those that do what the body does to its atoms,
// or come nearest to it (nothing holds a line but forces across it), the ones of least norm.
#pragma once

#include "core/rigid/system.hpp"

namespace holonomic::rigid {

// Where the whole force on each atom of a body goes before share_within() is called.
inline double *force_within(const System &system) {
    return system.within + 3 * static_cast<std::ptrdiff_t>(system.kind().bonds.size());
}

// Multipliers of rows in system.t, bond vectors from `at`. Writes t of bonds within bodies to system.within [n_bonds];
// a bond pulls its second atom by -t d. The forces are lost.
void share_within(const System &system, const Conformation &at);

// Of any bond.
inline Vector3<double> vector_of(const System &system, const Conformation &at, std::size_t bond) {
    const Bond &its = system.kind().bonds[bond];
    if (its.row >= 0) return rounded(system.bond_vector(at, static_cast<std::int32_t>(bond)));
    return rounded(at.x[its.j] - at.x[its.i]);
}

// t of any bond, once share_within() has been called where the molecule is by lengths.
inline double multiplier_of(const System &system, std::size_t bond) {
    const std::int32_t row = system.kind().bonds[bond].row;
    return row >= 0 ? rounded(system.t[row]) : system.kind().by_lengths ? system.within[bond] : 0;
}

}  // namespace holonomic::rigid
