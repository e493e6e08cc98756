// SPDX-License-Identifier: GPL-2.0-only
#ifndef HOLONOMIC_LAMMPS_FIX_TEMPLATES_HPP
#define HOLONOMIC_LAMMPS_FIX_TEMPLATES_HPP

#include <algorithm>

#include "error.h"
#include "fix_holonomic.h"
#include "update.h"

namespace LAMMPS_NS {

template <class Function>
void FixHolonomic::guarded(Function function) {
    const auto text = [this](const std::exception &e) {
        return std::string("Fix holonomic, step ") + std::to_string(update->ntimestep) + ": " + e.what();
    };
    try {
        function();
    } catch (const holonomic_lammps::ErrorEverywhere &e) {
        error->all(FLERR, text(e));
    } catch (const std::exception &e) {
        error->one(FLERR, text(e));
    }
}

/** Calls add(atom, force) for the constraint force of each atom, on the rank that owns it. */
template <class Add>
void FixHolonomic::return_reactions(Add add) {
    const std::vector<double> &numbers = reactions_;
    const int *atoms = plan_->atoms().data();
    for (int slot = 0; slot < plan_->n_slots(); ++slot)
        if (atoms[slot] >= 0) add(atoms[slot], &numbers[3 * slot]);
    plan_->exchange.to_owners<3>(
        world, [&](int slot, double *out) { std::copy(&numbers[3 * slot], &numbers[3 * slot] + 3, out); }, add);
    for (int k = 0; k < divided_->n_atoms(); ++k) add(divided_->atoms()[k], &divided_g_[3 * k]);
}

}  // namespace LAMMPS_NS

#endif
