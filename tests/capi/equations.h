/** The equations of multipliers, in long double. */
#ifndef TESTS_EQUATIONS_H
#define TESTS_EQUATIONS_H

#include "molecule.h"
#include "molecule_solution.h"

/** d = r_j - r_i of a pair, the nearest image in a box whose vectors have no components above the diagonal, or NULL. */
void bond_in_box(const double *r, const int64_t *pair, const double *box, long double d[3]);

/** What multipliers leave of d.(a_j - a_i) + c is a few roundings of the terms that it is made of, and of theirs: a = w
 * (f + G), c = |v_j - v_i|^2; or a = v + w G and no c; or c given. v, f and `given` may be NULL. */
void leave_roundings_of_equations(const molecule *m, const double *lambda, const double *v, const double *f, int rates,
                                  const double *given);
/** The same in a box, or NULL: images round by eps of its sides. */
void leave_roundings_in_box(const molecule *m, const double *box, const double *lambda, const double *v,
                            const double *f, int rates, const double *given);

/** Rates d.(v_j - v_i) of velocities are roundings of what these are made of. */
void leave_roundings_of_rates(const molecule *m, const double *v, const molecule_solution *exact);

#endif
