/** @file residue_checks.h
 * What multipliers of residues must be, and what they must do. */
#ifndef TESTS_RESIDUE_CHECKS_H
#define TESTS_RESIDUE_CHECKS_H

#include "check.h"
#include "molecule_solution.h"
#include "residues.h"

/** What multipliers do to the atoms, in long double: G_i, the sum of the sizes of its terms, the virial, and its. */
typedef struct pulls {
    long double *g, *size, virial[9], virial_size;
} pulls;

pulls pulls_of(const residues *s, const double *lambda);
void pulls_free(pulls *p);

/** G, tension and virial are those of the multipliers, but for their rounding; each may be NULL. */
void check_pulls(const residues *s, const double *lambda, const double *g, const double *tension, const double *virial);

/** d.(v_j - v_i + L d) of each bond, L or NULL, is a few roundings of the sizes of its terms, and of those before, or
 * NULL. */
void check_rates(const residues *s, const double *before, const double *v, const double *box_rate);

/** v - before = w G of the multipliers; light atoms aside, also where a last correction of rounding was made. */
void check_moves(const residues *s, const double *before, const double *v, const double *lambda);

/** A few roundings of the scales of a solution in many digits; more in a box, where images round by eps of its sides.
 */
long double residue_unit(const residues *s);

/** Multipliers, and velocities or positions or NULL, are those of a solution in many digits, which is freed. */
void check_solution(const residues *s, const double *lambda, const double *moved, molecule_solution *exact);

molecule_problem residues_problem(const residues *s);

/** |d.d - a^2| / a^2 of a bond, without its sign. */
double length_error(const residues *s, const double *r, int64_t bond);

/** Rounding of coordinates that a bond's length has at the least, of the shortest bond. */
double length_rounding(const residues *s);

/** The worst bond that is not held at both ends; its error. */
int64_t worst_bond(const residues *s, const double *r, double *error);

/** All bonds have their lengths, but for the rounding of coordinates. */
void check_lengths(const residues *s, const double *r);

/** r - start = dt^2 w G of the multipliers, along the bonds there were. */
void check_displacements(const residues *s, const double *start, const double *r, const double *lambda, double dt);

/** Calls the function with each recipe, of so many bonds; the molecule's name is printed. With fewer in a quick run. */
void for_each_residues(int64_t n_bonds, int hostile, void (*check)(residues *s));

/** With some recipes, numbers that end with -1; two of them in a quick run. */
void for_some_residues(const int *recipes, int64_t n_bonds, void (*check)(residues *s));

#endif
