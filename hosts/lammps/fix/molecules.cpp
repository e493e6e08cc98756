// SPDX-License-Identifier: GPL-2.0-only
// Which molecules there are, who has what of them, and what is found anew when bonds change.
#include <algorithm>
#include <numeric>

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "fix_holonomic.h"
#include "templates.hpp"

using namespace LAMMPS_NS;
using namespace holonomic_lammps;

Registry FixHolonomic::register_molecules(const std::vector<int> &which) {
    const std::vector<RigidBond> bonds = selection_.select(groupbit, atoms_, which);
    return Registry(world, bonds, selection_.bodies.select(groupbit, which), domain->dimension, size_to_divide(),
                    tolerance_);
}

void FixHolonomic::take_memberships(const std::vector<int> &which) {
    std::vector<Tag> tags;
    for (int i : which) tags.push_back(atom->tag[i]);
    const std::vector<Membership> members = registry_.memberships(tags);
    for (std::size_t k = 0; k < which.size(); ++k) static_cast<Membership &>(atoms_[which[k]]) = members[k];
    n_atoms_ = atom->natoms;
}

/** All of them. */
void FixHolonomic::find_molecules() {
    guarded([&] {
        std::vector<int> all(atom->nlocal);
        std::iota(all.begin(), all.end(), 0);
        registry_ = register_molecules(all);
        take_memberships(all);
        blocks_.clear();
        *plan_ = Plan(world);
    });
    tell_displacement();
    tell_adjustment();
}

/** Once, and again if it has become more. */
void FixHolonomic::tell_adjustment() {
    const Registry::Adjusted &most = registry_.most_adjusted();
    if (!(most.part > 1e-6 && most.part > 1.001 * told_adjustment_)) return;
    told_adjustment_ = most.part;
    if (comm->me == 0)
        error->warning(FLERR,
                       "Fix holonomic: bonds and angles that depend on each other do not fit to the last digit: "
                       "distances are adjusted in the least way, that of atoms " +
                           std::to_string(most.from) + " and " + std::to_string(most.to) + " most, by " +
                           std::to_string(100 * most.part) + " per cent");
}

/** Likewise. */
void FixHolonomic::tell_displacement() {
    const Bodies::Displacement &most = selection_.bodies.most_displaced();
    if (!(most.part > Bodies::unremarkable && most.part > 1.001 * told_)) return;
    told_ = most.part;
    if (comm->me == 0)
        error->warning(FLERR, "Fix holonomic: an atom of " + most.whose + " is " + std::to_string(most.distance) +
                                  " from where " + most.name +
                                  " has it, the largest displacement: it is moved there before the run");
}

/**
 * Those with atoms whose bonds have changed, or which are bonded to such atoms now, and those that have lost atoms: the
 * others stay as they are. Gives whether molecules that are divided among the ranks may be others.
 */
bool FixHolonomic::renew_molecules(const std::vector<int> &changed, bool other_atoms) {
    std::vector<Tag> names;
    for (int i : changed) {
        names.push_back(atom->tag[i]);
        if (atom->num_bond) names.insert(names.end(), atom->bond_atom[i], atom->bond_atom[i] + atom->num_bond[i]);
    }
    // All ranks learn of all that has changed: too much for them if it is most of the system.
    bigint n_names = static_cast<bigint>(names.size());
    MPI_Allreduce(MPI_IN_PLACE, &n_names, 1, MPI_LMP_BIGINT, MPI_SUM, world);
    if (4 * n_names > atom->natoms) {
        find_molecules();
        return true;
    }
    const std::unordered_set<Tag> touched = everywhere(world, names);
    std::vector<Tag> molecules;
    if (other_atoms) molecules = registry_.incomplete({atoms_.begin(), atoms_.begin() + atom->nlocal});
    for (int i = 0; i < atom->nlocal; ++i)
        if (atoms_[i].molecule && touched.count(atom->tag[i])) molecules.push_back(atoms_[i].molecule);
    const std::unordered_set<Tag> gone = everywhere(world, molecules);
    std::vector<int> which;
    for (int i = 0; i < atom->nlocal; ++i)
        if (gone.count(atoms_[i].molecule) || touched.count(atom->tag[i])) which.push_back(i);
    const bool divided = registry_.replace(gone, register_molecules(which));
    take_memberships(which);
    plan_->forget(gone);
    return divided;
}

/**
 * Where every rank still has the same atoms in the same order, the plan holds: on one rank until they are sorted. Where
 * bonds or atoms have come or gone, their molecules are found anew; gives whether that is so.
 */
bool FixHolonomic::replan(bool fresh) {
    enum { order = 1, bonds = 2, atoms = 4 };
    const tagint *tag = atom->tag;
    int changed = fresh || planned_.size() != static_cast<std::size_t>(atom->nlocal) ||
                          !std::equal(planned_.begin(), planned_.end(), tag)
                      ? order
                      : 0;
    const std::vector<int> others = selection_.changed(atoms_);
    if (!others.empty()) changed |= bonds;
    // As many may have come as have gone.
    const auto is_new = [this](int i) { return atoms_[i].topology == Belonging::never_seen; };
    if (n_atoms_ != atom->natoms || std::any_of(others.begin(), others.end(), is_new)) changed |= atoms;
    MPI_Allreduce(MPI_IN_PLACE, &changed, 1, MPI_INT, MPI_BOR, world);
    if (!changed) return false;
    const bool found_anew = (changed & ~order) != 0;
    const bool divided_anew = found_anew && renew_molecules(others, (changed & atoms) != 0);
    planned_.assign(tag, tag + atom->nlocal);
    const std::vector<Membership> members(atoms_.begin(), atoms_.begin() + atom->nlocal);
    const std::vector<Tag> tags(planned_.begin(), planned_.end());
    changed = plan_->renew(registry_, members.data(), tags.data(), atom->nlocal) || fresh;
    MPI_Allreduce(MPI_IN_PLACE, &changed, 1, MPI_INT, MPI_MAX, world);
    renew_divided(members, tags, fresh || divided_anew);
    away_.clear();
    for (const Peer &owner : plan_->exchange.owners)
        for (int slot : owner.indices) away_.push_back({slot, static_cast<int>(away_.size())});
    std::sort(away_.begin(), away_.end(), [](const Away &a, const Away &b) { return a.slot < b.slot; });
    answers_.resize(3 * away_.size());
    if (!changed) return found_anew;
    take_masses();
    make_blocks();
    for (std::vector<double> *array : {&now_, &before_, &velocities_, &forces_, &reactions_})
        array->assign(3 * static_cast<std::size_t>(plan_->n_slots()), 0.0);
    return found_anew;
}

void FixHolonomic::make_blocks() {
    std::vector<Packed> last;
    for (Block &block : blocks_) last.push_back(std::move(block.packed));
    blocks_.clear();
    std::int64_t n_bonds = 0;
    for (Packed &packed : cut_into_blocks(*plan_, masses_.data(), std::move(last))) {
        n_bonds += packed.n_bonds();
        blocks_.push_back({std::move(packed), 0, 0, 0, 0});
    }
    tensions_.assign(n_bonds, 0.0);
}

void FixHolonomic::take_masses() {
    masses_.resize(plan_->n_slots());
    for (int slot = 0; slot < plan_->n_slots(); ++slot)
        if (plan_->atoms()[slot] >= 0) masses_[slot] = mass_of(plan_->atoms()[slot]);
    plan_->exchange.to_homes<1>(
        world, [&](int i, double *mass) { *mass = mass_of(i); },
        [&](int slot, const double *mass) { masses_[slot] = *mass; });
    inverse_masses_.resize(masses_.size());
    for (std::size_t k = 0; k < masses_.size(); ++k) inverse_masses_[k] = masses_[k] > 0 ? 1 / masses_[k] : 0;
}
