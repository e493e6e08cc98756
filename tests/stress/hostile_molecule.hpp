/**
 * @file hostile_molecule.hpp
 * Random trees, rings, triangles and graphs made to break a solver.
 */
#ifndef STRESS_HOSTILE_MOLECULE_HPP
#define STRESS_HOSTILE_MOLECULE_HPP

#include <cstdint>
#include <string>
#include <vector>

#include "molecule_problem.h"

namespace stress
{

enum molecule_class { TREES, RINGS, TRIANGLES, GRAPHS, N_CLASSES };
const char *class_name(int c);

/** What is hard about a molecule; it has any number of these. */
enum molecule_feature : unsigned {
    MASSES_APART = 1u << 0,   ///< over 24 decades, graphs over 6
    HELD_FIXED = 1u << 1,     ///< some atoms
    LENGTHS_APART = 1u << 2,  ///< bond lengths over 6 decades, graphs over 1
    ALIGNED = 1u << 3,        ///< bonds straight on or folded back, to 1e-12 .. 1 rad; rings pressed onto a line
    FLAT = 1u << 4,           ///< all in a plane to 1e-12 .. 1
    FAR_OFF = 1u << 5,        ///< coordinates shifted by up to 1e6
    ONE_PULLED = 1u << 6,     ///< a force on one atom alone
    CONSISTENT = 1u << 7      ///< velocities that obey the constraints
};
constexpr int n_molecule_features = 8;
const char *molecule_feature_name(int bit);

struct hostile_molecule {
    molecule_class shape = TREES;
    unsigned features = 0;
    std::uint64_t seed = 0;
    std::vector<std::int64_t> pairs;  ///< [n_bonds][2]
    std::vector<double> w, mass;      ///< 1 / mass gives w to the last bit; 0 = fixed
    std::vector<double> length;       ///< |d| rounded
    std::vector<double> r, v, f;      ///< [n_atoms][3]
    double dt = 0;                    ///< a step in which no bond turns far

    std::int64_t n_atoms() const
    {
        return static_cast<std::int64_t>(w.size());
    }
    std::int64_t n_bonds() const
    {
        return static_cast<std::int64_t>(length.size());
    }
    molecule_problem problem() const;
    std::vector<double> drifted() const;
    std::string words() const;
};

/** From this number on graphs are strips of triangles: all, and half of them in the numbers of scripts/soak. */
/// From first_bush on, trees have atoms of many bonds, and graphs are rings with such. From first_star on, trees are
/// stars of three to five bonds; in soaks a quarter of them.
constexpr std::uint64_t first_strip = 10000000, first_bush = 20000000, first_star = 30000000,
                        first_of_soaks = UINT64_C(1) << 32;

/** The molecule with this number; the same on every machine. Every fourth number is of each class. */
hostile_molecule make_hostile_molecule(std::uint64_t seed);

/** A molecule of the same shape, with the same atoms held fixed, of other masses, in another direction and motion. */
hostile_molecule make_sibling(const hostile_molecule &of, std::uint64_t seed);

/** Sets lengths from positions. False if a bond has length zero. */
bool set_lengths(hostile_molecule &m);

/** Sets dt so that the ends of no bond move farther apart than this part of its length; 0 if they do not move. */
void set_time_step(hostile_molecule &m, double drift);

}  // namespace stress

#endif
