// SPDX-License-Identifier: GPL-2.0-only
#ifndef HOLONOMIC_LAMMPS_PLAN_SHAPE_HPP
#define HOLONOMIC_LAMMPS_PLAN_SHAPE_HPP

#include <array>
#include <vector>

#include "components.hpp"

namespace holonomic_lammps {

/** A bond between two atoms, by their tags. */
struct RigidBond {
    Tag from, to;
    double length;
};

/** A bond of this length holds no distance: two atoms belong to one body. */
constexpr double no_distance = 0;

/** An atom of a rigid body, and where it is in any frame of the body's own. */
struct BodyAtom {
    Tag body;  /**< a name, of this body alone */
    Tag first; /**< an atom of the body, the same for all of them */
    Tag atom;
    double at[3];
};

/** Atoms of a molecule that are rigid as one whole. */
struct Body {
    std::vector<int> places;
    std::vector<std::array<double, 3>> at;
};

/** What molecules may have in common: which of their places are bonded, at which distances, and which are bodies. */
struct Shape {
    int n_atoms = 0;
    bool linear = false;                   /**< places follow one another along the chain, pairs are (k, k+1) */
    std::vector<std::array<int, 2>> pairs; /**< places of the two atoms of each bond; none within a body */
    std::vector<double> lengths;
    std::vector<Body> bodies;
    double tolerance = 1e-3; /**< by which part lengths that depend on each other may be adjusted */
    bool rigid = false;      /**< the library has bodies in it, these or what dependent distances are */
    int taken = 0;           /**< degrees of freedom that its constraints take */

    /** Whether distances depend on each other, or bodies hold what distances do not. */
    bool dependent() const { return rigid || taken != static_cast<int>(pairs.size()); }

    bool operator<(const Shape &other) const;
};

/** The shape of a molecule and the tags at its places: along a linear chain from its end of lower tag, else ascending.
 * Its atoms are those of the bonds. Atoms that distances hold on a line, three or more, are a body, too, where the
 * other distances do not depend on each other; where they do, the library finds out what they hold. */
Shape shape_of(const std::vector<RigidBond> &bonds, const std::vector<BodyAtom> &bodies, std::vector<Tag> &tags);

/** A shape travels as numbers. */
void write(const Shape &shape, std::vector<double> &numbers);
/** Takes the numbers of one shape, and steps behind them. */
Shape read(const double *&number);

/** A way through a molecule: each atom after the one that it hangs on (place and earlier place), the first left out. */
using Walk = std::vector<std::array<int, 2>>;
Walk walk(const Shape &shape);

}  // namespace holonomic_lammps

#endif
