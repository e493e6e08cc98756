/**
 * @file hostile_body.hpp
 * Random molecules with rigid bodies, made to break a solver.
 */
#ifndef STRESS_HOSTILE_BODY_HPP
#define STRESS_HOSTILE_BODY_HPP

#include <cstdint>
#include <string>
#include <vector>

#include "molecule_dice.hpp"
#include "rigid_solution.hpp"

namespace stress
{

enum body_class {
    LONE,     ///< one body
    JOINED,   ///< bodies and atoms joined by bonds, without cycles
    LOOPS,    ///< the same with cycles
    CROWDED,  ///< a body with up to a hundred bonds
    N_BODY_CLASSES,
    RELATED = N_BODY_CLASSES,  ///< linear relations among atoms, and bonds
    LISTED                     ///< lists of distances that depend on each other, with the decimals of a file
};
const char *body_class_name(int c);

/** What is hard about a molecule; it has any number of these. */
enum body_feature : unsigned {
    BODY_MASSES_APART = 1u << 0,  ///< over 12 decades, within a body too
    BODY_SITES = 1u << 1,         ///< massless ones
    BODY_LINE = 1u << 2,          ///< all bodies near a line, to 1e-7 .. 1 or so that they count as straight
    BODY_PLANE = 1u << 3,         ///< the same of a plane
    BODY_FAR_OFF = 1u << 4,       ///< coordinates shifted by up to 1e8, places by up to 1e4
    BODY_HELD_FIXED = 1u << 5,    ///< some of the atoms at their bonds
    BODY_SIZES_APART = 1u << 6,   ///< bodies and bonds over 4 decades
    BODY_ALIGNED = 1u << 7,       ///< bonds straight away from a body's centre
    BODY_ONE_PULLED = 1u << 8,    ///< a force on one atom alone
    BODY_CONSISTENT = 1u << 9,    ///< velocities that obey the constraints
    BODY_CRUDE = 1u << 10         ///< positions off by up to a hundredth of the thinnest axis or shortest bond
};
constexpr int n_body_features = 11;

struct hostile_body {
    body_class shape = LONE;
    unsigned features = 0;
    std::uint64_t seed = 0;
    reference::rigid_problem p;
    double dt = 0;               ///< a step in which nothing turns far
    bool refused = false;        ///< a body of it can't be carried by its masses: hol_chains_add_rigid has to say so
    std::vector<double> listed;  ///< lengths as the library is given them; p has those of the positions
    std::int64_t freedoms = -1;  ///< that it has to have, if it is listed
    std::vector<std::pair<std::vector<std::size_t>, int>> groups;  ///< of a list: atoms on a line, in a plane, in space

    std::int64_t n_bonds() const
    {
        return static_cast<std::int64_t>(p.length.size());
    }
    std::vector<double> drifted() const;
    std::vector<double> right_hand_side() const;
    std::string words() const;
};

/** The molecule with this number; the same on every machine. Every fourth number is of each of the first classes. */
hostile_body make_hostile_body(std::uint64_t seed);

/** Puts bodies of its class and features in space, and bonds at them (hostile_places.cpp). */
void place_bodies(hostile_body &m, molecule_dice &d);

/** Of one of the two others (hostile_relations.cpp). */
hostile_body make_related(std::uint64_t seed);
hostile_body make_listed(std::uint64_t seed);
/** Puts a list's atoms where the library's lengths are, and says what holds them there; by the set of kernels that is
 * in use. Nothing else of it is to be asked for before. */
void complete_listed(hostile_body &m);

/** The places of a body whose positions are mirrored. They stay as they are unless a site is off a plane: which of two
 * mirror images another body is the positions say. */
void mirror_if_it_matters(reference::rigid_problem &p, std::size_t body);

/** What both have in common: forces, velocities and a step; whether no bond is all but rounding. */
void draw_motion(hostile_body &m, molecule_dice &d);
bool set_lengths(hostile_body &m);

/** The same bodies and bonds, turned in space and in another motion, so that they share a block. */
hostile_body make_twin(const hostile_body &of, std::uint64_t seed);

}  // namespace stress

#endif
