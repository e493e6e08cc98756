/**
 * @file seam_molecule.hpp
 * Large molecules of each kind that the library cuts, with what decouples, couples or is far larger at their seams.
 */
#ifndef STRESS_SEAM_MOLECULE_HPP
#define STRESS_SEAM_MOLECULE_HPP

#include <cstdint>
#include <vector>

#include "molecule_problem.h"

namespace stress
{

enum seam_shape { ARMS, PATHS, TREE_TILES, TILES, N_SEAM_SHAPES };
enum seam_kind { FIXED_SEAM, SQUARE_SEAM, STRAIGHT_SEAM, UNEQUAL_SEAM, PULLED_SEAM, N_SEAM_KINDS };
const char *seam_shape_name(int shape);
const char *seam_kind_name(int kind);

/** How far from the seam's atom: one before, at it, one and two behind. */
constexpr int first_seam_step = -1, n_seam_steps = 4;

/** A tree whose atoms come after their parents, and the bonds that close its cycles. */
struct seam_graph {
    std::vector<std::int64_t> parent;  ///< of each atom but the first
    std::vector<std::int64_t> pairs;   ///< of all bonds, the lower atom first, ascending
    std::vector<std::vector<std::int64_t>> neighbours;

    std::int64_t walk(std::int64_t atom, int steps) const;  ///< to the lowest neighbour, or up to the highest ones
};

seam_graph make_seam_graph(seam_shape shape);

/** Atoms at the seams of each sort that the molecule has, asked of the library's core; ends the program if it is not
 * cut as it should be. */
std::vector<std::vector<std::int64_t>> seams_of(seam_shape shape, const seam_graph &g);

struct seam_molecule {
    std::vector<std::int64_t> pairs;
    std::vector<double> mass, w, r, v, f, length, drifted;
    double dt;

    molecule_problem problem() const;
};

/** What stands at an atom. */
struct put_at {
    std::int64_t atom;
    seam_kind kind;
};

seam_molecule make_seam_molecule(const seam_graph &g, const std::vector<put_at> &puts, std::uint64_t seed);

}  // namespace stress

#endif
