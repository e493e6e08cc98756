/**
 * @file everything.h
 * All that the library makes of a scene, one call after the other, in one record: the same calls give the same bits.
 */
#ifndef TESTS_EVERYTHING_H
#define TESTS_EVERYTHING_H

#include <stddef.h>
#include <stdint.h>

/** Atoms, bonds and bodies that a handle is made of, and their state. Arrays are the scene's own. */
typedef struct scene {
    int64_t n_atoms, n_bonds;
    double *mass, *r, *v, *f; /**< [n_atoms], [n_atoms][3] */
    double *moved;            /**< [n_atoms][3], positions after a drift */
    int64_t *pairs;           /**< [n_bonds][2] */
    double *length;           /**< [n_bonds] */
    int64_t n_copies, size;   /**< or bodies of `size` consecutive atoms, alike; n_copies 0: none */
    double *places;           /**< [size][3] */
    const double *box;        /**< or NULL */
    int n_threads;
} scene;

typedef struct record {
    size_t n, room;
    double *values; /**< statuses among them */
    int n_good;     /**< calls that succeeded */
} record;

/**
 * Makes a handle, calls each function that calculates, with good arguments and with bad ones, and ends it. Calculates
 * nothing itself, so that nothing of it depends on the floating-point environment.
 */
record everything_of(const scene *s);

/** Fails unless both are the same bits. */
void assert_same_record(const record *a, const record *b, const char *what);

/** An empty scene over n atoms of mass 1, and a bond more, of the length that it has. */
scene scene_of_atoms(int64_t n);
void scene_bond(scene *s, int64_t i, int64_t j);
/** Velocities, forces and moved positions; the last thing to be made. */
void scene_finish(scene *s, uint64_t seed);

void scene_free(scene *s);

#endif
