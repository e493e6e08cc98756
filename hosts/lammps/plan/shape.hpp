// SPDX-License-Identifier: GPL-2.0-only
#ifndef HOLONOMIC_LAMMPS_PLAN_SHAPE_HPP
#define HOLONOMIC_LAMMPS_PLAN_SHAPE_HPP

#include <array>
#include <vector>

#include "components.hpp"

namespace holonomic_lammps {

/** A bond between two atoms, by their tags. */
struct Bond {
    Tag from, to;
    double length;
};

/** What molecules may have in common: which of their places are bonded, at which distances. */
struct Shape {
    int n_atoms = 0;
    bool linear = false;                   /**< places follow one another along the chain, pairs are (k, k+1) */
    std::vector<std::array<int, 2>> pairs; /**< places of the two atoms of each bond */
    std::vector<double> lengths;

    bool operator<(const Shape &other) const;
};

/** The shape of a molecule and the tags at its places: along a linear chain from its end of lower tag, else ascending.
 * Its atoms are those of the bonds. */
Shape shape_of(std::vector<Bond> bonds, std::vector<Tag> &tags);

/** A way through a molecule: each atom after the one that it hangs on (place and earlier place), the first left out. */
std::vector<std::array<int, 2>> walk(const Shape &shape);

}  // namespace holonomic_lammps

#endif
