/** Steps to be projected, and what their rounding leaves. */
#ifndef TESTS_POSITIONS_H
#define TESTS_POSITIONS_H

#include "assembly.h"

/** Positions after a drift with the velocities, projected if `consistent`. */
double *drift(assembly *a, double dt, int consistent);

/**
 * What rounding the coordinates of a bond's two atoms does to |d.d - a^2| / a^2: each changes by eps/2 of the largest
 * coordinate in each direction, so d by sqrt(3) eps extent; and the iteration itself ends within eight roundings.
 */
long double rounding_of_a_bond(long double extent, long double a);

/** 40 chains of up to 60 bonds; or a few so long that the library solves them in windows. */
assembly short_or_long(chain_kind kind, int is_long, arrangement how, uint64_t seed);

#endif
