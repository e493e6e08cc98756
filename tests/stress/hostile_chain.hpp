/**
 * @file hostile_chain.hpp
 * Random chains made to break a solver: every combination of what is hard for one, each drawn over its whole range.
 */
#ifndef STRESS_HOSTILE_CHAIN_HPP
#define STRESS_HOSTILE_CHAIN_HPP

#include <cstdint>
#include <string>
#include <vector>

#include "random.h"
#include "solution.h"

namespace stress
{

/** What is hard about a chain; a chain has any number of these. */
enum feature : unsigned {
    UNEQUAL_MASSES = 1u << 0,   ///< over 24 decades
    FIXED_ATOMS = 1u << 1,      ///< at the ends, or anywhere
    UNEQUAL_BONDS = 1u << 2,    ///< lengths over 12 decades
    STRAIGHT = 1u << 3,         ///< joints turned by 1e-16 .. 1 rad, or folded back to that
    RIGHT_ANGLES = 1u << 4,     ///< joints within 0 or 1e-17 .. 0.1 rad of a right angle
    FAR_AWAY = 1u << 5,         ///< coordinates shifted by up to 1e8
    WIDE_FORCES = 1u << 6,      ///< forces and velocities over 30 decades
    DENORMAL_FORCES = 1u << 7,  ///< denormal numbers among the forces and velocities
};
constexpr int n_features = 8;
const char *feature_name(int bit);

struct hostile_chain {
    unsigned features = 0;
    std::uint64_t seed = 0;
    std::int64_t n_bonds = 0;
    std::vector<double> w;        ///< inverse masses, exact: 1/mass gives this very double
    std::vector<double> mass;     ///< 0 = fixed
    std::vector<double> length;   ///< |d| rounded
    std::vector<double> r, v, f;  ///< [n_bonds+1][3]
    double dt = 0;                ///< a step in which no atom moves far; 0: the velocities allow none

    solution_problem problem() const;
    std::string words() const;  ///< its features
};

/** Sets a mass whose reciprocal is the stored inverse mass to the last bit. */
void set_mass(hostile_chain &c, std::size_t i, double mass);

/** From this number on some chains have what is hard at the places where the kernels cut them (seam_features.hpp). */
constexpr std::uint64_t first_with_seams = UINT64_C(1) << 32;

/** The chain with this number; the same on every machine. */
hostile_chain make_hostile_chain(std::uint64_t seed, std::int64_t longest);

/** Positions after a drift with the velocities over dt. */
std::vector<double> drifted(const hostile_chain &c);

/** Sets lengths and dt from masses, positions and velocities. False if a bond has length zero. */
bool complete(hostile_chain &c, double drift);

}  // namespace stress

#endif
