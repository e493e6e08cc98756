// SPDX-License-Identifier: GPL-2.0-only
// Molecules that are divided among the ranks: each has the atoms that it owns, and no atom travels.
#include <algorithm>
#include <cmath>

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "fix_holonomic.h"
#include "force.h"
#include "image.hpp"
#include "memory.h"
#include "templates.hpp"
#include "update.h"

using namespace LAMMPS_NS;
using namespace holonomic_lammps;

/** From how many atoms on a molecule is divided. Its home would have more to do than all the rest of a step takes; on
 * few ranks that is so of no molecule, since what is divided takes two to eleven times as long a bond. */
std::int64_t FixHolonomic::size_to_divide() const {
    constexpr std::int64_t large = 20000;
    constexpr int many_ranks = 16;
    if (comm->nprocs == 1) return 0;
    if (divide_ >= 0) return divide_;
    return comm->nprocs >= many_ranks ? large : 0;
}

void FixHolonomic::renew_divided(const std::vector<Membership> &members, const std::vector<Tag> &tags, bool fresh) {
    if (registry_.n_divided() > 0 && domain->deform_vremap)
        throw ErrorEverywhere("fix deform with remap v needs `divide 0`: molecules may not be divided among ranks");
    if (registry_.n_divided() == 0 && !divided_->any()) return;
    std::vector<double> masses(atom->nlocal);
    for (int i = 0; i < atom->nlocal; ++i) masses[i] = mass_of(i);
    divided_->renew(registry_, members.data(), tags.data(), masses, fresh);
    for (std::vector<double> *array : {&divided_r_, &divided_v_, &divided_f_, &divided_g_})
        array->assign(3 * static_cast<std::size_t>(divided_->n_atoms()), 0.0);
}

/** The atoms' positions; the cell that they are in, with zeros for directions that are not periodic. */
void FixHolonomic::take_divided_positions() {
    const double *h = domain->h;
    const double rows[9] = {domain->xperiodic ? h[0] : 0,
                            0,
                            0,
                            domain->yperiodic ? h[5] : 0,
                            domain->yperiodic ? h[1] : 0,
                            0,
                            domain->zperiodic ? h[4] : 0,
                            domain->zperiodic ? h[3] : 0,
                            domain->zperiodic ? h[2] : 0};
    divided_->set_box(domain->xperiodic || domain->yperiodic || domain->zperiodic ? rows : nullptr);
    for (int k = 0; k < divided_->n_atoms(); ++k) std::copy_n(atom->x[divided_->atoms()[k]], 3, &divided_r_[3 * k]);
}

/** As constrain_positions; the reference is what the last forces belong to. */
bool FixHolonomic::constrain_divided_positions(bool from_themselves, double time) {
    if (!divided_->any()) return false;
    take_divided_positions();
    if (from_themselves) divided_->factorize(divided_r_.data());
    divided_->positions(divided_r_.data(), time);
    bool moved = false;
    for (int k = 0; k < divided_->n_atoms(); ++k) {
        const int i = divided_->atoms()[k];
        for (int c = 0; c < 3; ++c) {
            moved = moved || atom->x[i][c] != divided_r_[3 * k + c];
            if (!from_themselves) atom->v[i][c] += (divided_r_[3 * k + c] - atom->x[i][c]) / time;
            atom->x[i][c] = divided_r_[3 * k + c];
        }
    }
    return moved;
}

/** As constrain_velocities; gives what velocities have become more than they were. */
std::vector<double> FixHolonomic::divided_changes(double half) {
    if (!divided_->any()) return {};
    const double L[9] = {rate_[0], rate_[5], rate_[4], 0, rate_[1], rate_[3], 0, 0, rate_[2]};
    const double unit = force->ftm2v;
    take_divided_positions();
    divided_->set_rate(L);
    divided_->factorize(divided_r_.data());
    for (int k = 0; k < divided_->n_atoms(); ++k) {
        const int i = divided_->atoms()[k];
        const double mass = mass_of(i), kick = mass > 0 ? half / mass : 0.0;
        for (int c = 0; c < 3; ++c) {
            divided_v_[3 * k + c] = atom->v[i][c] + kick * atom->f[i][c];
            divided_f_[3 * k + c] = unit * atom->f[i][c];
        }
    }
    std::vector<double> changes = divided_v_;
    if (!reruns_) divided_->velocities(divided_v_.data());
    for (std::size_t k = 0; k < changes.size(); ++k) changes[k] = divided_v_[k] - changes[k];
    return changes;
}

/** As exact_forces, before units are changed. */
void FixHolonomic::divided_forces() {
    if (!divided_->any()) return;
    double part[9];
    divided_->forces(divided_v_.data(), divided_f_.data(), divided_g_.data(), part);
    for (int k = 0; k < 9; ++k) virial_[k] += part[k];
}

std::vector<Divided::Known> FixHolonomic::divided_bonds() const {
    if (!divided_->any()) return {};
    return divided_->bonds(divided_r_.data(), [this](double *d) {
        const Vector shift = image_vector(*domain, nearest_image(*domain, d));
        for (int c = 0; c < 3; ++c) d[c] += shift[c];
    });
}

/** Half of a bond's virial at either atom. */
void FixHolonomic::tally_divided_atoms() {
    const double unit = 1 / force->ftm2v;
    for (const Divided::Known &bond : divided_bonds()) {
        const double t = -unit * bond.lambda, *d = bond.d;
        const double w[6] = {t * d[0] * d[0], t * d[1] * d[1], t * d[2] * d[2],
                             t * d[0] * d[1], t * d[0] * d[2], t * d[1] * d[2]};
        for (int at : bond.at)
            for (int k = 0; at >= 0 && k < 6; ++k) vatom[divided_->atoms()[at]][k] += w[k];
    }
}

hol_worst FixHolonomic::divided_errors() {
    if (!divided_->any()) return {};
    take_divided_positions();
    return divided_->violation(divided_r_.data(), divided_v_.data());
}
