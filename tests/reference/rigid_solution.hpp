/**
 * @file rigid_solution.hpp
 * Independent solutions for molecules with rigid bodies, in 320 bits.
 *
 * A body is two, three or four points of equal mass in the frame that a Cholesky factor of its second moments gives,
 * held by the distances of these points; its atoms are at fixed combinations of them, so that bonds are distances of
 * combinations. How large errors may be is measured in another frame and by other constraints: centre and principal
 * vectors, whose products are held. Both must have the same solution, which is checked in every case.
 */
#ifndef REFERENCE_RIGID_SOLUTION_HPP
#define REFERENCE_RIGID_SOLUTION_HPP

#include <array>
#include <cstddef>
#include <vector>

namespace reference
{

/** Atoms between which sums c_i r_i = 0 hold, rows of coefficients that add up to 0, and nothing else. */
struct loose_part {
    std::vector<std::size_t> atoms;
    std::vector<std::vector<double>> relations;  ///< [..][atoms]
};

/** A set of bodies, loose parts, other atoms, and bonds. */
struct rigid_problem {
    std::vector<double> mass;                     ///< [n_atoms], 0: a massless site, -1: held fixed
    std::vector<double> place;                    ///< [n_atoms][3] reference coordinates of atoms of bodies
    std::vector<double> r, v, f;                  ///< [n_atoms][3]
    std::vector<std::vector<std::size_t>> bodies; /**< their atoms */
    std::vector<loose_part> parts;
    std::vector<std::array<std::size_t, 2>> pairs;
    std::vector<double> length;
    std::vector<bool> implied;  ///< bonds that others imply, which are left out; or empty: none

    std::size_t n_atoms() const
    {
        return mass.size();
    }
};

/**
 * What one level gives, and the scales by which errors are judged: what relative changes of one rounding can do to the
 * vectors of centre, principal axes and bonds, to forces or velocities and to masses, if all add up
 * (docs/stability.md).
 */
struct rigid_level {
    bool there = false;
    std::vector<long double> lambda, lambda_scale;  ///< [n_bonds]
    std::vector<long double> g, g_scale;            ///< [n_atoms][3] and [n_atoms]; of bodies at `forces` alone
    std::vector<long double> moved, moved_scale;    ///< the same: projected velocities or positions
    std::array<long double, 9> virial{};
    long double virial_scale = 0;
};

/** What a body looks like. */
struct body_facts {
    int rank = 0;          ///< 1: on a line, 2: in a plane, 3; an axis below 1e-8 of the longest counts as none
    bool flagged = false;  ///< an axis, or the distance of an atom from line or plane, is within a decade of that
    bool refused = false;  ///< a mass is farther from the line or plane of the others than that, or a site from a line
    std::vector<std::size_t> off_plane;  ///< massless sites that are farther from a plane
};
body_facts facts_of_body(const rigid_problem &p, std::size_t body);

/** Lengths of the principal axes that a body has, and what an atom's coordinates count in their vectors. */
struct body_shape {
    std::vector<double> length;                ///< [rank]
    std::vector<std::array<double, 3>> share;  ///< [atoms][rank] of the vectors
};
body_shape shape_of_body(const rigid_problem &p, const std::vector<std::size_t> &atoms);

struct rigid_solution {
    bool regular = false;  ///< the constraints do not depend on each other; nothing but least_pivot is set otherwise
    bool agrees = true;    ///< both sets of constraints have the same solution
    /** The least part of a diagonal element that is left of it once all other rows are eliminated: the square of the
     * sine between a constraint's gradient and the space of all others, whatever the order. */
    long double least_pivot = 0;
    std::size_t n_constraints = 0;
    rigid_level forces, solve, velocities, positions;
};

/** rhs [n_bonds] or empty: no `solve`. drifted [n_atoms][3] or empty: no `positions`. Of several positions that obey
 * the constraints those that Newton's method comes to from `drifted`, or from near `found` [n_atoms][3], if that is not
 * empty. */
rigid_solution solve_rigid(const rigid_problem &p, const std::vector<double> &rhs, const std::vector<double> &drifted,
                           double dt, const std::vector<double> &found = {});

}  // namespace reference

#endif
