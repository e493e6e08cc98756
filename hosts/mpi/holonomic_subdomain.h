/**
 * @file holonomic_subdomain.h
 * Molecules that are divided among the processes of a parallel program: each process keeps the bonds between its own
 * atoms, and the processes share the bonds that are cut, the interface. The results are those that the library
 * holonomic finds for the whole molecule on one process.
 *
 * This interface is no part of the promise of docs/abi.md: it may change with any release.
 *
 * Each process eliminates the bonds inside its subdomain, but for those where many parts between cut bonds meet. What
 * is left, those and the cut bonds, are the interface's equations, of which every process adds up its part (the Schur
 * complement), and which every process solves alike. A residual of all bonds in twice the precision then corrects the
 * multipliers, and proves or refuses them. How many sums over processes that takes does not depend on the molecule.
 *
 * Conventions (atoms, masses, bonds, signs, units, fixed atoms, box) are those of holonomic.h. All functions are
 * collective: every process calls them, in the same order. If one process fails, all return an error and nothing is
 * written. A subdomain is used by one thread at a time. The library needs no MPI: the program gives a function that
 * adds numbers up over its processes.
 */
#ifndef HOLONOMIC_SUBDOMAIN_H
#define HOLONOMIC_SUBDOMAIN_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/**
 * Replaces numbers[0..n-1] by their sums over all processes, with the same bits on each (MPI_Allreduce with MPI_SUM and
 * MPI_IN_PLACE does so). This is the only communication. Processes come with the same n.
 * @return 0, or anything else if it went wrong: the call that needed it then returns HOL_ERR_CALLBACK
 */
typedef int (*hol_subdomain_sum)(void *context, int64_t n, double *numbers);

/** What one process knows of divided molecules. */
typedef struct hol_subdomain hol_subdomain;

/**
 * @param[in]  rank, n_ranks  number of this process, and how many there are
 * @param[in]  sum, context   adds up over the processes; context is handed on to it
 * @param[in]  n_atoms        atoms of this process, without copies of others' atoms; may be 0
 * @param[in]  masses         [n_atoms], as in hol_chains_create: 0 or infinite is held fixed. Copied
 * @param[in]  n_bonds        bonds between two atoms of this process; may be 0
 * @param[in]  pairs          [n_bonds][2], their atoms, counted from 0. Copied
 * @param[in]  lengths        [n_bonds]. Copied
 * @param[in]  n_cut          bonds whose atoms are on two processes, of all processes together, in the same order on
 *                            each; may be 0. Any bond may be given here, also one with both atoms on one process
 * @param[in]  ends           [n_cut][2], numbers of the two atoms, -1 for an atom of another process. Every atom of a
 *                            cut bond is named by one process, and by one alone. Copied
 * @param[in]  cut_lengths    [n_cut], on every process. Copied
 * @param[out] subdomain      the new handle, to be given to hol_subdomain_destroy; NULL on an error
 * @return HOL_OK; HOL_ERR_NULL; HOL_ERR_VALUE (a size, length or mass); HOL_ERR_INDEX (an atom that is not there, a
 *         bond of an atom with itself; an end that no process names, or two); HOL_ERR_MEMORY; HOL_ERR_CALLBACK
 */
int hol_subdomain_create(int rank, int n_ranks, hol_subdomain_sum sum, void *context, int64_t n_atoms,
                         const double *masses, int64_t n_bonds, const int64_t *pairs, const double *lengths,
                         int64_t n_cut, const int64_t *ends, const double *cut_lengths, hol_subdomain **subdomain);

/**
 * Frees a handle. Not collective.
 * @param[in] subdomain  the handle; NULL does nothing
 */
void hol_subdomain_destroy(hol_subdomain *subdomain);

/**
 * Periodic box of the positions that come next, as hol_chains_set_box. Not collective; the same on every process.
 * @param[in] subdomain  the handle
 * @param[in] box        as in hol_chains_set_box, or NULL: none. Copied
 * @return HOL_OK; HOL_ERR_NULL (subdomain); HOL_ERR_VALUE
 */
int hol_subdomain_set_box(hol_subdomain *subdomain, const double *box);

/**
 * Rate at which that box changes, as hol_chains_set_box_rate. Not collective; the same on every process.
 * @param[in] subdomain  the handle
 * @param[in] L          as in hol_chains_set_box_rate, or NULL: none. Copied
 * @return HOL_OK; HOL_ERR_NULL (subdomain); HOL_ERR_VALUE
 */
int hol_subdomain_set_box_rate(hol_subdomain *subdomain, const double *L);

/**
 * Eliminates what is inside, and factorizes the interface's equations at these positions; the functions below speak of
 * them until this is called again. Two sums.
 * @param[in] subdomain  the handle
 * @param[in] r          [n_atoms][3]. Copied. Bonds are taken as minimum images if there is a box
 * @return HOL_OK; HOL_ERR_NULL; HOL_ERR_NOT_FINITE; HOL_ERR_DEGENERATE (bonds that depend on each other);
 * HOL_ERR_MEMORY; HOL_ERR_CALLBACK
 */
int hol_subdomain_factorize(hol_subdomain *subdomain, const double *r);

/**
 * hol_forces at the positions of hol_subdomain_factorize. Three sums.
 * @param[in]  subdomain   the handle
 * @param[in]  v, f        [n_atoms][3]; either may be NULL: zero
 * @param[out] lambda      multipliers of this process's bonds [n_bonds], or NULL
 * @param[out] cut_lambda  those of the cut bonds [n_cut], on every process, or NULL
 * @param[in,out] g        constraint forces [n_atoms][3], or NULL; may be f itself
 * @param[in]  mode        HOL_WRITE: g = G for every atom; HOL_ADD: g = g + G
 * @param[out] virial      [3][3], this process's part: the sum over processes is the virial; or NULL
 * @return HOL_OK; HOL_ERR_NULL; HOL_ERR_VALUE (mode); HOL_ERR_STATE (nothing was factorized); HOL_ERR_NOT_FINITE;
 * HOL_ERR_DEGENERATE (one correction does not reach the rounding: bonds nearly depend on each other); HOL_ERR_MEMORY;
 *         HOL_ERR_CALLBACK
 */
int hol_subdomain_forces(hol_subdomain *subdomain, const double *v, const double *f, double *lambda, double *cut_lambda,
                         double *g, int mode, double *virial);

/**
 * hol_project_velocities at the positions of hol_subdomain_factorize. Sums as hol_subdomain_forces.
 * @param[in]     subdomain   the handle
 * @param[in,out] v           [n_atoms][3]
 * @param[out]    lambda      [n_bonds] in the units of hol_project_velocities, or NULL
 * @param[out]    cut_lambda  [n_cut], or NULL
 * @param[out]    virial      [3][3], this process's part, or NULL
 * @return as hol_subdomain_forces
 */
int hol_subdomain_project_velocities(hol_subdomain *subdomain, double *v, double *lambda, double *cut_lambda,
                                     double *virial);

/**
 * hol_project_positions with the positions of hol_subdomain_factorize as reference. One sum for each of Newton's
 * steps, one more where it makes new factors, and two.
 * @param[in]     subdomain   the handle
 * @param[in,out] r           [n_atoms][3], in: after the drift; out: on the constraints, to the rounding
 * @param[in,out] v           [n_atoms][3], or NULL: v_i += dt w_i G_i
 * @param[in]     dt          > 0
 * @param[out]    lambda      [n_bonds], or NULL
 * @param[out]    cut_lambda  [n_cut], or NULL
 * @param[out]    virial      [3][3], this process's part, or NULL
 * @param[out]    iterations  how many steps it took, or NULL
 * @return as hol_subdomain_forces, without HOL_ERR_DEGENERATE; HOL_ERR_NO_CONVERGENCE as hol_project_positions
 */
int hol_subdomain_project_positions(hol_subdomain *subdomain, double *r, double *v, double dt, double *lambda,
                                    double *cut_lambda, double *virial, int *iterations);

/**
 * How far positions and velocities are from the constraints, as hol_violation says: the largest over all bonds of all
 * processes. Three sums.
 * @param[in]  subdomain  the handle
 * @param[in]  r       [n_atoms][3], in the box of hol_subdomain_set_box
 * @param[in]  v       [n_atoms][3], or NULL
 * @param[out] length  largest abs(d.d - a^2) / a^2, on every process, or NULL
 * @param[out] rate    largest abs(d.(v_j - v_i + L d)), 0 without v, on every process, or NULL
 * @return HOL_OK; HOL_ERR_NULL; HOL_ERR_NOT_FINITE; HOL_ERR_CALLBACK
 */
int hol_subdomain_violation(hol_subdomain *subdomain, const double *r, const double *v, double *length, double *rate);

/**
 * Numbers by which the program knows its atoms; messages show them (hol_chains_set_labels). Not collective.
 * @param[in] subdomain  the handle
 * @param[in] atoms      [n_atoms], or NULL: none. Copied
 * @return HOL_OK; HOL_ERR_NULL; HOL_ERR_MEMORY
 */
int hol_subdomain_set_labels(hol_subdomain *subdomain, const int64_t *atoms);

/**
 * Vectors of the cut bonds at the positions of hol_subdomain_factorize, from the first atom to the second, images
 * taken. Not collective.
 * @param[in]  subdomain  the handle
 * @param[out] d          [n_cut][3]
 * @return HOL_OK; HOL_ERR_NULL; HOL_ERR_STATE (nothing was factorized)
 */
int hol_subdomain_cut_vectors(const hol_subdomain *subdomain, double *d);

/** What the calls since the handle was made have cost this process. */
typedef struct hol_subdomain_work {
    int64_t n_sums;     /**< calls of sum */
    int64_t n_numbers;  /**< numbers that were handed to it */
    int64_t n_solves;   /**< solutions with the factors of all bonds of this process */
    int64_t n_rows;     /**< equations of the interface: cut bonds, and those inside where many parts meet */
    int64_t n_entries;  /**< numbers of the interface's factors */
    double last_change; /**< what the last correction has changed, relative to the multipliers; on all processes */
} hol_subdomain_work;

/**
 * Not collective.
 * @param[in]  subdomain  the handle
 * @param[out] work       what its calls have cost
 * @return HOL_OK; HOL_ERR_NULL
 */
int hol_subdomain_get_work(const hol_subdomain *subdomain, hol_subdomain_work *work);

/** What went wrong in this thread's last call above that failed; "" before. Never NULL. */
const char *hol_subdomain_error_message(void);

#ifdef __cplusplus
}
#endif
#endif
