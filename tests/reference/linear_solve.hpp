/**
 * @file linear_solve.hpp
 * Textbook elimination with row exchanges in 113-bit arithmetic. It shares no idea with the library: it subtracts, and
 * pays for it with the extra digits.
 */
#ifndef REFERENCE_LINEAR_SOLVE_HPP
#define REFERENCE_LINEAR_SOLVE_HPP

#include <cstddef>
#include <vector>

#include "quad.hpp"

namespace reference
{

/** Tridiagonal matrix: row k holds lower[k], diagonal[k], upper[k]; lower[0] and upper[n-1] are not used. */
struct tridiagonal {
    std::vector<quad> lower, diagonal, upper;
    explicit tridiagonal(std::size_t n) : lower(n), diagonal(n), upper(n)
    {
    }
    std::size_t size() const
    {
        return diagonal.size();
    }
};

/** Solves the whole matrix as a dense one, O(n^3). False if it is singular. */
bool solve_dense(const tridiagonal &matrix, std::vector<quad> &right_side);

/** Solves by banded elimination with row exchanges, O(n). False if it is singular. */
bool solve_banded(tridiagonal matrix, std::vector<quad> &right_side);

/** Dense for the sizes at which that takes no noticeable time, otherwise banded. */
bool solve(const tridiagonal &matrix, std::vector<quad> &right_side);

/**
 * The matrix whose inverse holds the absolute values of the elements of the inverse of `matrix`, for a symmetric
 * positive definite tridiagonal one: off-diagonal elements made negative (a change of signs of rows and columns does
 * it).
 */
tridiagonal with_negative_neighbours(tridiagonal matrix);

}  // namespace reference

#endif
