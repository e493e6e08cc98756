// SPDX-License-Identifier: GPL-2.0-only
#ifndef HOLONOMIC_LAMMPS_PLAN_LINES_HPP
#define HOLONOMIC_LAMMPS_PLAN_LINES_HPP

#include "shape.hpp"

namespace holonomic_lammps {

/**
 * Makes bodies of atoms that distances hold on a line: three of which one distance is the sum of the two others to
 * rounding, and more where such threes have two atoms in common (acetylene). Atoms of other bodies are left as they
 * are. Gives whether there are any.
 */
bool find_lines(Shape &shape);

}  // namespace holonomic_lammps

#endif
