/** @file residue_flock.h
 * Several molecules of residues in one set, and all results of each. */
#ifndef TESTS_RESIDUE_FLOCK_H
#define TESTS_RESIDUE_FLOCK_H

#include <stddef.h>

#include "residues.h"

/** All arrays per bond and per atom, of the bonds and atoms that they are of. */
enum { BOND_RESULTS = 5, ATOM_RESULTS = 4 };
typedef struct residue_results {
    double *bond[BOND_RESULTS]; /**< lambda, tension; of given right-hand sides; of velocities; of positions */
    double *atom[ATOM_RESULTS]; /**< g; projected v; projected r, and v after it */
    double virial[9];           /**< of the forces */
    size_t n_bonds, size;
} residue_results;

/** With right-hand sides from the lengths. */
residue_results residue_compute(const hol_chains *chains, const molecule *m, double dt);
void residue_results_free(residue_results *x);

/** Bits of `some` are those of `all` from this bond and atom on. */
void assert_same_results(const residue_results *some, const residue_results *all, int64_t bond, int64_t atom);

/** Copies of a molecule, each turned in another way without a rounding, with velocities and forces of its own. The
 * forces of number 1 are large. Atoms of one after those of the other. */
molecule residue_copies(const molecule *m, int64_t copies);

/** One of them alone. */
molecule residue_copy(const molecule *all, const molecule *m, int64_t copy);

#endif
