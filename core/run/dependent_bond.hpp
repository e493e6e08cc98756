// Looks for a bond whose constraint follows from the others'.
#ifndef HOLONOMIC_DEPENDENT_BOND_HPP
#define HOLONOMIC_DEPENDENT_BOND_HPP

#include <cstdint>

#include "core/molecules/molecule.hpp"

namespace holonomic {

// Of a molecule that is no linear chain, by the careful solver: the first bond whose pivot vanishes; -1 if none does,
// -2 if the bond vectors are of no use. Throws std::bad_alloc.
std::int64_t dependent_bond(const Molecule &molecule, const AtomArray &r, const Box &box);

}  // namespace holonomic
#endif
