/** The equations of multipliers, in long double. */
#ifndef TESTS_EQUATIONS_H
#define TESTS_EQUATIONS_H

#include "molecule.h"

/** What multipliers leave of d.(a_j - a_i) + c is a few roundings of the terms that it is made of, and of theirs: a = w
 * (f + G), c = |v_j - v_i|^2; or a = v + w G and no c; or c given. v, f and `given` may be NULL. */
void leave_roundings_of_equations(const molecule *m, const double *lambda, const double *v, const double *f, int rates,
                                  const double *given);

#endif
