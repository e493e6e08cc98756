#define HOL_QUAD_DOUBLE
#define HOL_ISA plain_quad_double
#define HOL_LANES 2
#include "core/extended/equations.hpp"

namespace holonomic {

std::unique_ptr<const ExtendedMolecule> ExtendedMolecule::in_four_times_the_precision(const Molecule &m,
                                                                                      const AtomArray &r,
                                                                                      const Box &box) {
    return std::make_unique<plain_quad_double::extended::Equations>(m, r, box);
}

}  // namespace holonomic
