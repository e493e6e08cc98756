// SPDX-License-Identifier: GPL-2.0-only
#ifndef HOLONOMIC_LAMMPS_PLAN_SUPERPOSE_HPP
#define HOLONOMIC_LAMMPS_PLAN_SUPERPOSE_HPP

#include <array>
#include <vector>

namespace holonomic_lammps {

using Points = std::vector<std::array<double, 3>>;

/** How far a shape, moved and turned onto as many points with the least sum of squares, is from them at most: Horn
 * 1987. A shape is not mirrored. */
double largest_displacement(const Points &shape, const Points &points);

/** The distance of the two points that are closest to each other. */
double shortest_distance(const Points &shape);

/** A way through a shape, each point behind the one that it is closest to: (point, earlier point), Prim 1957. */
std::vector<std::array<int, 2>> shortest_way(const Points &shape);

}  // namespace holonomic_lammps

#endif
