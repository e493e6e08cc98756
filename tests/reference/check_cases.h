/**
 * @file check_cases.h
 * What check_oracle does with one case of any format: a line per quantity, and the largest error over its bound.
 */
#ifndef REFERENCE_CHECK_CASES_H
#define REFERENCE_CHECK_CASES_H

#include <holonomic.h>

#include "molecule_file.h"
#include "oracle_file.h"
#include "rigid_file.h"

/** All quantities of a chain; infinite if a call fails. */
long double check_chain_case(const oracle_case *c);

/** All quantities of a molecule of any shape; one that is degenerate must be refused, with its outputs untouched. */
long double check_molecule_case(const molecule_file *c);

/**
 * The checks of positions against lengths find nothing wrong with a case, nor with its positions as a reference of
 * which bonds are 1e-3 off: 0, or infinite. pairs NULL: a linear chain.
 */
long double check_fit(const char *name, hol_chains *chains, int64_t n_atoms, int64_t n_bonds, const int64_t *pairs,
                      const double *length, const double *r);

/** All quantities of a molecule with rigid bodies. */
long double check_rigid_case(const rigid_file *c);

#endif
