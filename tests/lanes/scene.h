/**
 * @file scene.h
 * Chains of every length in the places where callers keep them, and the calls of the library on them.
 */
#ifndef TESTS_SCENE_H
#define TESTS_SCENE_H

#include <holonomic.h>
#include <stddef.h>

/** Where the atoms stand. */
typedef enum place {
    PACKED = 0, /**< chains of one length, one behind the other: hol_chains_add_block */
    MIXED,      /**< the same with chains that are up to four bonds shorter between them */
    LISTED,     /**< by lists of atoms in random order */
    APART,      /**< separate arrays for x, y and z */
    PLACES
} place;

extern const char *const place_names[PLACES];

/** Random coils with a handle. */
typedef struct scene {
    place where;
    int64_t n_chains, n_atoms, n_bonds;
    int64_t *bonds; /**< [n_chains] */
    int64_t *atoms; /**< atom numbers, chain after chain */
    double *mass;   /**< [n_atoms] */
    double *length; /**< [n_bonds] */
    double *r, *v, *f;
    hol_chains *chains;
} scene;

/** n_chains chains of n_bonds bonds; `unequal`: masses over two decades and lengths from 0.7 to 1.5, else all 1. */
scene scene_make(int64_t n_chains, int64_t n_bonds, place where, int unequal);

void scene_free(scene *s);

/** What the calls gave; [n_atoms][3] or [n_bonds]. */
typedef struct answers {
    double *lambda[3], *tension, *g, virial[3][9]; /**< of forces, velocities, positions */
    double *projected;                             /**< velocities */
    double *drifted, *moved, *pushed;              /**< positions before and after; velocities after those */
    hol_report report;
    double *log_det, *log_det_z, energy, *fixman; /**< [n_chains], [n_chains], -, [n_atoms][3] */
    const char *failed;                           /**< the call that failed, or NULL */
} answers;

extern const double time_step, temperature;

/** Calls everything, in the layout of the scene. */
answers scene_answers(const scene *s);

/** The four calls with nothing but what most callers want: lambda and the vectors per atom. */
answers scene_plain_answers(const scene *s);

void answers_free(answers *x);

#endif
