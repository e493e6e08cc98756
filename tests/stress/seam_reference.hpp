/**
 * @file seam_reference.hpp
 * What large molecules are compared with: the bond matrix from atoms and bonds, and its elimination, in 113 bits.
 *
 * Scales. |A^-1| S would take a solution for each bond. Instead S gets random signs a few times: the root of the mean
 * square of the solutions is the root of the sum of the squares of what |A^-1| S adds up, and so never above it.
 */
#ifndef STRESS_SEAM_REFERENCE_HPP
#define STRESS_SEAM_REFERENCE_HPP

#include <vector>

#include "quad.hpp"

// What it is made for has to be declared before it.
#include "exact_molecule.hpp"
#include "seam_molecule.hpp"

namespace stress
{

using reference::quad;
using quads = std::vector<quad>;

/** Multipliers with t = 2 lambda, what they do to the atoms, and how far rounding moves each. */
struct seam_solution {
    quads lambda, lambda_scale;  ///< zero for bonds between fixed atoms
    quads g, g_scale;            ///< [3 n], [n]
    quads moved, moved_scale;    ///< velocities or positions
};

struct linear_solutions {
    seam_solution forces, velocities;
};
linear_solutions exact_linear(const seam_molecule &m);
/** By Newton's method; lambda is empty if it does not converge. */
seam_solution exact_positions(const seam_molecule &m);

}  // namespace stress

#endif
