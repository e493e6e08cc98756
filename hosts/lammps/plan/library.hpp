// SPDX-License-Identifier: GPL-2.0-only
#ifndef HOLONOMIC_LAMMPS_PLAN_LIBRARY_HPP
#define HOLONOMIC_LAMMPS_PLAN_LIBRARY_HPP

#include <holonomic.h>

#include "shape.hpp"

namespace holonomic_lammps {

/** Adds molecules of one shape, one behind the other; gives the library's status. */
int add_molecules(hol_chains *chains, const Shape &shape, std::int64_t n_molecules, std::int64_t first_atom);

/** How far the library has adjusted a length of distances that depend on each other, so that they are possible. */
struct Adjustment {
    double part = 0; /**< of the length */
    std::array<int, 2> places{};
};

/** Finds out what the library makes of a shape: `rigid` and `taken`. One that it refuses is left to add_molecules. */
Adjustment examine(Shape &shape, int dimensions);

}  // namespace holonomic_lammps

#endif
