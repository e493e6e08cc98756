#include "core/run/dependent_bond.hpp"

#include "core/inverse/careful_molecule.hpp"

namespace holonomic {

std::int64_t dependent_bond(const Molecule &molecule, const AtomArray &r, const Box &box) {
    const CarefulMolecule solver(molecule, r, box);
    if (solver.good()) return -1;
    return solver.dependent_bond() < 0 ? -2 : solver.dependent_bond();
}

}  // namespace holonomic
