// SPDX-License-Identifier: GPL-2.0-only
// Minimisation on the constraints: the energy of a point is that of the point on the constraints next to it, and its
// force is tangent. Both with equal masses, so that a minimiser's steps along the force stay on the constraints to
// first order.
#include <algorithm>

#include "comm.h"
#include "templates.hpp"
#include "update.h"

using namespace LAMMPS_NS;

bool FixHolonomic::minimises() const { return update->whichflag == 2; }

void FixHolonomic::min_setup(int vflag) {
    std::fill(rate_, rate_ + 6, 0.0);
    std::fill(step_rate_, step_rate_ + 6, 0.0);
    min_post_force(vflag);
}

void FixHolonomic::min_pre_neighbor() { pre_neighbor(); }

/** A function of the positions alone: a line search comes back to where it has been. */
void FixHolonomic::min_pre_force(int) {
    guarded([&] {
        constrain_positions(true, 1.0);
        comm->forward_comm();
    });
}
