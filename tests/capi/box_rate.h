/**
 * @file box_rate.h
 * A box that changes at the rate L, and the rates of bonds in it.
 */
#ifndef TESTS_BOX_RATE_H
#define TESTS_BOX_RATE_H

#include <stdint.h>

extern const double L[9];

/** L x of a rate. */
void rate_times(const double *rate, const long double *x, long double *y);

/** d.(v_j - v_i + L d), and the sum of its terms' absolute values; images in an orthorhombic box, or without one. */
long double rate_of_bond(const double *r, const double *v, int64_t i, int64_t j, const double *box, long double *size);

#endif
