// SPDX-License-Identifier: GPL-2.0-only
#include "packed.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "library.hpp"

namespace holonomic_lammps {

namespace {

const char *reason(int status) {
    switch (status) {
        case HOL_ERR_NO_CONVERGENCE:
            return "the bond lengths can't be reached from these positions: the time step is too long, or forces are "
                   "too "
                   "large";
        case HOL_ERR_NOT_FINITE:
            return "a position, velocity or force is infinite or no number";
        case HOL_ERR_DEGENERATE:
            return "constraints that depend on each other, or atoms that coincide";
        case HOL_ERR_MEMORY:
            return "out of memory";
        default:
            return hol_error_message();
    }
}

std::string pair_of(Tag a, Tag b) { return "atoms " + std::to_string(a) + " and " + std::to_string(b); }

}  // namespace

Packed::Packed(const Plan &plan, const double *masses, int first, int end, int first_bond)
    : plan_(&plan), numbering_(plan.numbering()),
      residents_(plan.residents().begin() + first, plan.residents().begin() + end),
      chains_(nullptr, hol_chains_destroy) {
    const std::vector<Resident> &residents = plan.residents();
    move_to(first, first_bond);
    masses_.assign(masses + first_slot_, masses + end_slot_);
    hol_chains *chains = nullptr;
    // To the library an atom without mass in a body is a site; one of infinite mass is held fixed, or refused there.
    std::vector<double> of_slots = masses_;
    for (double &mass : of_slots)
        if (mass == 0) mass = HUGE_VAL;
    check(hol_chains_create(end_slot_ - first_slot_, of_slots.data(), &chains), "taking the masses");
    chains_.reset(chains);
    for (int from = first, to = first; from < end; from = to) {
        while (to < end && residents[to].shape == residents[from].shape) ++to;
        add(residents[from], to - from);
    }
}

bool Packed::holds(int first, const double *masses) const {
    const std::vector<Resident> &all = plan_->residents();
    return numbering_ == plan_->numbering() && residents_.size() <= all.size() - first &&
           std::equal(
               residents_.begin(), residents_.end(), all.begin() + first,
               [](const Resident &a, const Resident &b) { return a.molecule == b.molecule && a.shape == b.shape; }) &&
           std::equal(masses_.begin(), masses_.end(), masses + all[first].first);
}

void Packed::move_to(int first, int first_bond) {
    first_resident_ = first;
    end_resident_ = first + static_cast<int>(residents_.size());
    const Resident &last = plan_->residents()[end_resident_ - 1];
    first_slot_ = plan_->residents()[first].first;
    end_slot_ = last.first + plan_->shapes()[last.shape].n_atoms;
    first_bond_ = first_bond;
}

/** Molecules of one shape, one behind the other. */
void Packed::add(const Resident &first, int n_molecules) {
    const Shape &shape = plan_->shapes()[first.shape];
    const int status = add_molecules(chains_.get(), shape, n_molecules, first.first - first_slot_);
    if (status == HOL_OK) return;
    const auto n_bonds = static_cast<std::int64_t>(shape.pairs.size());
    std::int64_t bond;
    hol_error_location(nullptr, &bond, nullptr, nullptr);
    std::string where = "molecule of atom " + std::to_string(first.molecule);
    if (bond >= 0 && n_bonds > 0) {
        const Tag *tags = &plan_->tags()[first.first + bond / n_bonds * shape.n_atoms];
        const auto &pair = shape.pairs[bond % n_bonds];
        where = pair_of(tags[pair[0]], tags[pair[1]]);
    }
    throw std::runtime_error(where + ": " + reason(status) + " (" + hol_error_message() + ")");
}

void Packed::positions(const double *before, double *now, double dt, std::int64_t *n_moved) {
    hol_report report;
    const int k = 3 * first_slot_;
    // Positions as a data file has them may be off by more than the library takes for sound.
    check(hol_chains_set_checks(chains_.get(), n_moved ? HOL_NEVER : HOL_AT_START), "setting the checks");
    check(hol_project_positions(chains_.get(), before + k, now + k, nullptr, dt, nullptr, 0, nullptr,
                                n_moved ? &report : nullptr),
          "positions");
    if (n_moved) *n_moved += report.n_corrected;
}

void Packed::set_rate(const double *L) { check(hol_chains_set_box_rate(chains_.get(), L), "the rate of the box"); }

void Packed::velocities(const double *r, double *v) {
    check(hol_project_velocities(chains_.get(), r + 3 * first_slot_, v + 3 * first_slot_, nullptr, nullptr),
          "velocities");
}

void Packed::forces(const double *r, const double *v, const double *f, double *tension, double *g, double *virial) {
    const int k = 3 * first_slot_;
    check(hol_forces(chains_.get(), r + k, v + k, f + k, nullptr, tension ? tension + first_bond_ : nullptr, g + k,
                     HOL_WRITE, virial),
          "constraint forces");
}

hol_worst Packed::violation(const double *r, const double *v) const {
    hol_worst worst{};
    check(hol_violation(chains_.get(), r + 3 * first_slot_, v + 3 * first_slot_, &worst), "errors of bonds");
    return worst;
}

void Packed::check(int status, const char *doing) const {
    if (status == HOL_OK) return;
    throw std::runtime_error(std::string(doing) + ": " + place() + reason(status));
}

/** The molecule, and the bond or atom if there is one, of the last error. */
std::string Packed::place() const {
    std::int64_t chain, bond, atom, n_bad, n_atoms = 0, n_bonds = 0;
    hol_error_location(&chain, &bond, &atom, &n_bad);
    if (chain < 0 || hol_chains_molecule(chains_.get(), chain, nullptr, &n_atoms, &n_bonds) != HOL_OK) return "";
    std::vector<std::int64_t> atoms(n_atoms), bonds(n_bonds);
    hol_chains_atoms(chains_.get(), chain, atoms.data());
    hol_chains_bonds(chains_.get(), chain, bonds.data());
    std::string text = "the molecule of atom " + std::to_string(plan_->tags()[first_slot_ + atoms[0]]);
    if (atom >= 0) text = "atom " + std::to_string(plan_->tags()[first_slot_ + atom]) + " in " + text;
    if (bond >= 0 && bond < n_bonds) {
        // Bonds follow the residents.
        std::int64_t k = bonds[bond];
        for (int m = first_resident_; m < end_resident_; ++m) {
            const Resident &resident = plan_->residents()[m];
            const Shape &shape = plan_->shapes()[resident.shape];
            if (k >= static_cast<std::int64_t>(shape.pairs.size())) {
                k -= static_cast<std::int64_t>(shape.pairs.size());
                continue;
            }
            const Tag *tags = &plan_->tags()[resident.first];
            text = "the bond between " + pair_of(tags[shape.pairs[k][0]], tags[shape.pairs[k][1]]) + " in " + text;
            break;
        }
    }
    if (n_bad > 1) text += " and " + std::to_string(n_bad - 1) + " more";
    return text + ": ";
}

}  // namespace holonomic_lammps
