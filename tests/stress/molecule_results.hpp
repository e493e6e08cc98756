/**
 * @file molecule_results.hpp
 * Everything that the library says about some molecules, through the public interface.
 */
#ifndef STRESS_MOLECULE_RESULTS_HPP
#define STRESS_MOLECULE_RESULTS_HPP

#include <holonomic.h>

#include <cstdint>
#include <memory>
#include <vector>

#include "hostile_molecule.hpp"

namespace stress
{

using numbers = std::vector<double>;

struct chains_deleter {
    void operator()(hol_chains *c) const
    {
        hol_chains_destroy(c);
    }
};

/** Several molecules over the same arrays. */
struct placement {
    std::vector<std::vector<std::size_t>> atoms;  ///< of each molecule, ascending: its own atom i is number atoms[i]
    std::vector<std::vector<std::size_t>> bonds;  ///< places of its bonds in the list
    numbers r, v, f, drift, rhs;
    std::vector<std::int64_t> molecule_of_bond;  ///< as the library counts them, -1: none
    int status = 0;                              ///< of adding the bonds
    std::unique_ptr<hol_chains, chains_deleter> chains;
};

/**
 * One after the other if shuffle is 0. Otherwise their atoms are interleaved with each other's and with others that
 * hold NaN, without changing the order within a molecule, and the bonds of all are listed in any order, either atom
 * first.
 */
placement place(const std::vector<const hostile_molecule *> &parts, std::uint64_t shuffle);

struct molecule_results {
    int forces = 0, solve = 0, velocities = 0, metric = 0, positions = 0, kept = 0;  ///< statuses
    numbers lambda, solved, mu, position_lambda;                                     ///< per bond
    numbers kept_lambda, kept_solved, kept_g;  ///< of forces and right-hand sides with kept factors
    numbers log_det, log_det_z;                ///< per bond, those of its molecule; 0 where it has none
    numbers g, fixman, v, r, moved;
    numbers virial;
};

/** dt: time step of the position level. Outputs that are not written hold blank(). */
molecule_results compute(const placement &a, double dt);

/** The same through separate arrays, each backwards. */
molecule_results compute_in_views(const placement &a, double dt);

/** The part of one molecule, in its own order. */
molecule_results part_of(const molecule_results &all, const placement &a, std::size_t molecule);

/** A number that no calculation gives, told by its bits. */
double blank();
bool is_blank(double x);
bool identical(const numbers &a, const numbers &b);

}  // namespace stress

#endif
