/**
 * @file molecule_problem.h
 * What the independent solutions for molecules of any shape take, and what they give; molecule_solution.h solves.
 *
 * Quantities and scales are those of tests/oracle/molecules/README.md.
 */
#ifndef REFERENCE_MOLECULE_PROBLEM_H
#define REFERENCE_MOLECULE_PROBLEM_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Any set of atoms and bonds; it need not be connected. Bonds between two fixed atoms are no constraints. */
typedef struct molecule_problem {
    int64_t n_atoms, n_bonds;
    const int64_t *pairs;       /**< [n_bonds][2]: d_k = r_j - r_i for the pair (i, j) */
    const double *inverse_mass; /**< [n_atoms], 0 = held fixed */
    const double *r;            /**< [n_atoms][3] */
    const double *v, *f;        /**< [n_atoms][3] or NULL */
    const double *box;          /**< [3][3] or NULL; a bond is the shortest image, found by trying the images */
} molecule_problem;

/** Multipliers and what follows from them. Free with molecule_solution_free. */
typedef struct molecule_solution {
    int64_t n_atoms, n_bonds;
    long double *lambda, *lambda_scale; /**< [n_bonds] */
    long double *tension;               /**< [n_bonds], 2 lambda |d| */
    long double *g, *g_scale;           /**< [n_atoms][3] and [n_atoms] */
    long double *moved, *moved_scale;   /**< [n_atoms][3] and [n_atoms]: projected velocities or positions */
    long double virial[9], virial_scale;
    long double least_pivot; /**< smallest pivot of Z~ in the order of elimination */
} molecule_solution;

/** What depends on positions and masses alone. Free with molecule_metric_free. */
typedef struct molecule_metric {
    int64_t n_atoms, n_bonds;
    long double log_det;                      /**< ln det Z~ */
    long double log_det_z, log_det_z_scale;   /**< ln det Z; |ln det Z~| + sum |ln Z_kk| */
    long double condition, least_pivot;       /**< of Z~, infinity norm */
    long double *fixman_force, *fixman_scale; /**< [n_atoms][3] and [n_atoms], over kT */
    long double *inverse;                     /**< [n_bonds][n_bonds] of Z~^-1; 0 in rows of bonds that are none */
} molecule_metric;

#ifdef __cplusplus
}
#endif
#endif
