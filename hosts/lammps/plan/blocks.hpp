// SPDX-License-Identifier: GPL-2.0-only
#ifndef HOLONOMIC_LAMMPS_PLAN_BLOCKS_HPP
#define HOLONOMIC_LAMMPS_PLAN_BLOCKS_HPP

#include "packed.hpp"

namespace holonomic_lammps {

/**
 * Cuts the residents of a plan into blocks, few enough atoms each for the cache. Blocks of the last plan whose
 * molecules still follow one another are kept with the library's handles, which is what planning spends most of its
 * time on.
 * @param masses  [n_slots]; 0: held fixed
 */
std::vector<Packed> cut_into_blocks(const Plan &plan, const double *masses, std::vector<Packed> last);

}  // namespace holonomic_lammps

#endif
