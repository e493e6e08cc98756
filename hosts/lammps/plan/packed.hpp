// SPDX-License-Identifier: GPL-2.0-only
#ifndef HOLONOMIC_LAMMPS_PLAN_PACKED_HPP
#define HOLONOMIC_LAMMPS_PLAN_PACKED_HPP

#include <holonomic.h>

#include <memory>
#include <string>

#include "plan.hpp"

namespace holonomic_lammps {

/**
 * The library's handle for the molecules that live on this rank. Arrays per atom are [n_slots][3], whole molecules
 * without a box; arrays per bond follow the residents, and within each the pairs of its shape. Errors are
 * std::runtime_error and name atoms by their tags.
 */
class Packed {
public:
    /** @param masses  [n_slots]; 0: held fixed */
    Packed(const Plan &plan, const double *masses);

    /** Molecules of which a position has been moved. */
    std::int64_t positions(const double *before, double *now, double dt);
    void velocities(const double *r, double *v);
    /** virial: [3][3]. */
    void forces(const double *r, const double *v, const double *f, double *tension, double *g, double *virial);
    hol_worst violation(const double *r, const double *v) const;

    std::int64_t n_bonds() const { return hol_chains_n_bonds(chains_.get()); }
    std::int64_t memory() const { return hol_chains_memory(chains_.get()); }

private:
    /** No molecule lives on this rank; its arrays may be NULL. */
    bool empty() const { return plan_->n_slots() == 0; }
    void add(const Resident &first, int n_molecules);
    void check(int status, const char *doing) const;
    std::string place() const;

    const Plan *plan_;
    std::unique_ptr<hol_chains, void (*)(hol_chains *)> chains_;
};

}  // namespace holonomic_lammps

#endif
