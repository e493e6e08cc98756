// SPDX-License-Identifier: GPL-2.0-only
#ifndef HOLONOMIC_LAMMPS_PLAN_PACKED_HPP
#define HOLONOMIC_LAMMPS_PLAN_PACKED_HPP

#include <holonomic.h>

#include <memory>
#include <string>
#include <vector>

#include "plan.hpp"

namespace holonomic_lammps {

/**
 * The library's handle for some of the molecules that live on this rank, one behind the other. Arrays are those of all
 * slots, per atom [n_slots][3], whole molecules without a box, and of all bonds, which follow the residents, and within
 * each the pairs of its shape; the parts of these molecules are used. Errors are std::runtime_error and name atoms by
 * their tags.
 */
class Packed {
public:
    /** Residents first .. end - 1, at least one. @param masses  [n_slots]; 0: held fixed. first_bond: of all bonds */
    Packed(const Plan &plan, const double *masses, int first, int end, int first_bond);

    /** Whether the plan's residents from `first` on are these molecules, with these masses [n_slots]. */
    bool holds(int first, const double *masses) const;
    /** They stand from this resident on now, and their bonds from this one. */
    void move_to(int first, int first_bond);

    Tag name() const { return residents_[0].molecule; } /**< the first of the molecules */
    int first_resident() const { return first_resident_; }
    int end_resident() const { return end_resident_; }
    int first_slot() const { return first_slot_; }
    int end_slot() const { return end_slot_; }

    /** n_moved: how many molecules have been moved is added to it; a count that nobody wants costs time. */
    void positions(const double *before, double *now, double dt, std::int64_t *n_moved = nullptr);
    /** L [3][3] of a box that changes, for velocities, forces and violation: hol_chains_set_box_rate. */
    void set_rate(const double *L);
    void velocities(const double *r, double *v);
    /** virial: [3][3], of these molecules. tension may be NULL. */
    void forces(const double *r, const double *v, const double *f, double *tension, double *g, double *virial);
    hol_worst violation(const double *r, const double *v) const;

    std::int64_t n_bonds() const { return hol_chains_n_bonds(chains_.get()); }
    const hol_chains *handle() const { return chains_.get(); }
    std::int64_t memory() const { return hol_chains_memory(chains_.get()); }

private:
    void add(const Resident &first, int n_molecules);
    void check(int status, const char *doing) const;
    std::string place() const;

    const Plan *plan_;
    int numbering_;  // of the plan's shapes
    int first_resident_, end_resident_, first_slot_, end_slot_, first_bond_;
    std::vector<Resident> residents_;
    std::vector<double> masses_;
    std::unique_ptr<hol_chains, void (*)(hol_chains *)> chains_;
};

}  // namespace holonomic_lammps

#endif
