/**
 * @file melt.h
 * A melt of bead-rod chains with purely repulsive (WCA) beads in a cubic box, integrated by RATTLE with the library.
 * Unit bonds, masses, bead size and energy; kT = 1.
 */
#ifndef TESTS_MELT_H
#define TESTS_MELT_H

#include <holonomic.h>

typedef struct melt {
    hol_chains *chains;
    int64_t n_chains, n_beads, n_atoms;
    double side;             /**< of the box */
    double *r, *v, *f, *w;   /**< [n_atoms][3]; w = 1/m per atom */
    double *before, *lambda; /**< positions of the last step; multipliers of the last step */
    double potential;
    int64_t *head, *next; /**< cells of the pair search */
    int64_t *pairs, n_pairs, capacity;
    double *at_list;           /**< positions when the pairs were listed */
    double worst_length;       /**< largest |d.d - 1| seen since it was last reset */
    int64_t iterations, steps; /**< of the position level */
} melt;

/** Chains on a cubic lattice path, velocities from the Maxwell distribution with zero total momentum. */
melt melt_make(int64_t n_chains, int64_t n_beads, double density, uint64_t seed);

/** One step of RATTLE. */
void melt_step(melt *m, double dt);

/** Scales velocities so that the kinetic energy is that of kT = 1. */
void melt_rescale(melt *m);

double melt_kinetic(const melt *m);

void melt_free(melt *m);

#endif
