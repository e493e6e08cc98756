/**
 * @file partition_reference.h
 * Means of det Z~^(p/2), p = -1 or +1, over independent uniform bond directions, computed in ways that share nothing
 * with the library: a power series, and nested quadrature of the determinant itself.
 */
#ifndef REFERENCE_PARTITION_REFERENCE_H
#define REFERENCE_PARTITION_REFERENCE_H

#include <stdint.h>

/**
 * ln of the mean as the power series in x_2 .. x_N,
 *     sum over k_2..k_N of prod x_n^k_n / ((2 k_n + 1) k_n! (a)_k_n)  (a)_{k_2} (a)_{k_2+k_3} .. (a)_{k_N},   a = -p/2,
 * which is He(1/2; 3/2; x) for p = -1. It converges as long as no two neighbouring x are near 1/4 on average or beyond.
 * @param[in] masses  [n_bonds+1], finite
 * @param[in] terms   [2], terms to take in k_n for odd and for even n
 */
long double partition_series(int64_t n_bonds, const double *masses, int p, const int64_t *terms);

/**
 * ln of the mean for 3 or 4 bonds: the outer gammas by tanh-sinh quadrature, the innermost integral in closed form.
 * @param[in] masses  [n_bonds+1]; 0 = fixed
 */
long double partition_quadrature(int64_t n_bonds, const double *masses, int p);

#endif
