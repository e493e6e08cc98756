/**
 * Scenes of chains: many of the same kind, with the state of their atoms.
 */
#ifndef BENCH_PROBLEM_HPP
#define BENCH_PROBLEM_HPP

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "scene.hpp"

namespace bench {

/// Chains of equal length, masses and bond lengths, one after the other in the arrays; unit energy, dt in its time
/// unit.
struct Problem : Scene {
    std::vector<double> mass, w;  ///< [bonds+1] along a chain; mass 0, w 0: held fixed
    std::vector<double> length;   ///< [bonds]

    std::size_t n() const { return static_cast<std::size_t>(bonds); }
    std::size_t first_atom(std::size_t chain) const { return chain * (n() + 1); }
};

/// How a problem is made.
struct Recipe {
    std::string name;
    std::int64_t chains = 1, bonds = 1;
    bool one_by_one = false;
    bool general_masses = false;        ///< along the chain, instead of the kind's own
    double decades = 2;                 ///< that general masses span
    bool general_lengths = false;       ///< 0.7..1.5 along the chain
    bool flat = false;                  ///< in the plane z = 0
    bool orthogonal = false;            ///< every bond at a right angle to the one before, along an axis
    std::int64_t fixed_every = 0;       ///< so many atoms apart, one is held fixed; 0: none
    double light = 1e-6;                ///< light_joints: mass of every second atom
    double turn_from = 0, turn_to = 5;  ///< straight5, light_joints: degrees between a bond and the one before
    std::uint64_t seed = 1;
};

/// Always the same for the same recipe.
Problem make_problem(const Recipe &recipe);

/// Single chains of n_bonds: as many different ones as make about `pool` bonds, at least one and at most 2000.
Recipe single(const std::string &name, std::int64_t n_bonds, std::int64_t pool = 20000);

/// n_chains chains of n_bonds given to the method in one call.
Recipe batch(const std::string &name, std::int64_t n_chains, std::int64_t n_bonds);

/// The same as light joints of the given mass in chains whose bonds turn by so many degrees.
Recipe with_joints(Recipe recipe, double light, double turn_from, double turn_to);

}  // namespace bench

#endif
