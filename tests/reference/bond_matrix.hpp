/**
 * @file bond_matrix.hpp
 * From a chain to its bond vectors and to the matrix Z, and from multipliers to forces, in 113-bit arithmetic.
 */
#ifndef REFERENCE_BOND_MATRIX_HPP
#define REFERENCE_BOND_MATRIX_HPP

#include <vector>

#include "linear_solve.hpp"
#include "solution.h"

namespace reference
{

/** A chain in 113 bits; bond k (from 0) joins atoms k and k+1. */
struct exact_chain {
    std::vector<quad> w;   ///< inverse masses
    std::vector<quad3> d;  ///< bond vectors
    explicit exact_chain(const solution_problem &p);
    std::size_t n_bonds() const
    {
        return d.size();
    }
};

/** Z: 4 (w + w') d.d on the diagonal, -4 w d.d' beside it. */
tridiagonal bond_matrix(const exact_chain &c);

/** Z~ = D Z D, with ones on its diagonal. */
tridiagonal scaled_bond_matrix(const exact_chain &c);

/** Fills in everything that follows from the multipliers along the bonds c.d. Returns 0, or -1: no memory. */
int fill(const exact_chain &c, const std::vector<quad> &lambda, const std::vector<quad> &scale, solution &out);

/** Row i of a [n][3] array, or zero if the array is NULL. */
quad3 row(const double *array, std::size_t i);

}  // namespace reference

#endif
