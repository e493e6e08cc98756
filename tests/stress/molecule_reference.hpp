/**
 * @file molecule_reference.hpp
 * Everything that a molecule is compared with, made once and for every set of kernels.
 */
#ifndef STRESS_MOLECULE_REFERENCE_HPP
#define STRESS_MOLECULE_REFERENCE_HPP

#include "hostile_molecule.hpp"
#include "molecule_solution.h"

namespace stress
{

/** A solution of molecule_solution.h, if there is one. */
struct molecule_level {
    molecule_solution s{};
    bool there = false;
    molecule_level() = default;
    molecule_level(molecule_level &&other) noexcept : s(other.s), there(other.there)
    {
        other.there = false;
    }
    molecule_level &operator=(const molecule_level &) = delete;
    ~molecule_level()
    {
        if (there) molecule_solution_free(&s);
    }
};

struct molecule_reference {
    /** Z has an inverse; its determinant is no rounding of zero. Nothing but condition and least_pivot is set
     * otherwise. */
    bool regular = false;
    molecule_metric metric{};
    molecule_level forces, solve, velocities, positions;  ///< positions: there if Newton's method converges

    explicit molecule_reference(const hostile_molecule &m);
    molecule_reference(molecule_reference &&other) noexcept;
    molecule_reference &operator=(const molecule_reference &) = delete;
    ~molecule_reference();
};

/** A right-hand side for hol_solve. */
std::vector<double> right_hand_side(const hostile_molecule &m);

}  // namespace stress

#endif
