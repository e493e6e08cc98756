#define HOL_ISA plain
#define HOL_LANES 2
#include "core/extended/equations.hpp"

namespace holonomic {

std::unique_ptr<const ExtendedMolecule> ExtendedMolecule::make(const Molecule &m, const AtomArray &r, const Box &box) {
    std::unique_ptr<const ExtendedMolecule> twice = std::make_unique<plain::extended::Equations>(m, r, box);
    return twice->lacks_digits() ? in_four_times_the_precision(m, r, box) : std::move(twice);
}

}  // namespace holonomic
