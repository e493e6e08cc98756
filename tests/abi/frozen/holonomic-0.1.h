/**
 * @file holonomic.h
 * Exact Lagrange multipliers and constraint forces of chains of rigid bonds, in time linear in the number of bonds.
 *
 * Conventions, valid for every function (docs/theory.md has the derivations):
 *
 * - Atom i has mass m_i, inverse mass w_i = 1/m_i (0 for an atom that is held fixed), position r_i, velocity v_i and
 *   applied force f_i. A chain of N bonds joins N+1 atoms; bond k has the vector d_k = r_k - r_{k-1}, the length a_k
 *   and the constraint sigma_k = d_k.d_k - a_k^2 = 0.
 * - The constraint force is G_i = - sum_k lambda_k grad_i sigma_k = 2 (lambda_{i+1} d_{i+1} - lambda_i d_i):
 *   lambda_k > 0 pulls the two atoms together, and T_k = 2 lambda_k |d_k| is the tension of the bond, a force.
 * - Units are the caller's own; any consistent set does (m, length, time; force = mass length / time^2).
 * - An output that is NULL is not computed; an input that may be NULL is zero then and costs nothing.
 * - Arrays per atom are [n_atoms][3] (Fortran: (3, n_atoms)); only the atoms that belong to chains are read and
 *   written. Arrays per bond are [n_bonds], chain after chain in the order in which the chains were added
 *   (hol_chains_offsets). Arrays per chain are [n_chains].
 * - Every function that can fail returns an hol_status. hol_error_message() then says in words, for the calling
 *   thread, what was wrong and where, and hol_error_location() gives the place in numbers.
 * - A wrong argument: nothing is written. Bad data in some chains (HOL_ERR_NOT_FINITE, HOL_ERR_DEGENERATE,
 *   HOL_ERR_NO_CONVERGENCE): the outputs of these chains stay as they were, bit for bit, sums over chains (virial,
 *   energy) are not written, and all other chains are complete. The status, message and location are those of the
 *   first bad chain.
 * - The library never prints, exits, aborts or throws, and changes no floating-point environment.
 * - Threads: a handle that no thread changes (create, add, set, destroy) may be used by any number of threads at once.
 *   Results do not depend on hol_chains_set_threads, on the memory layout, nor on which other chains there are.
 *   Scratch memory belongs to the calling thread; after a thread's first call with chains of that size nothing is
 *   allocated, but for a long chain whose positions need a second attempt (light atoms, taut between heavy ones).
 */
#ifndef HOLONOMIC_H
#define HOLONOMIC_H

#include <stdint.h>

#define HOL_VERSION_MAJOR 0
#define HOL_VERSION_MINOR 1
#define HOL_VERSION_PATCH 0

#if defined(_WIN32) || !defined(__GNUC__)
#define HOL_API
#else
#define HOL_API __attribute__((visibility("default")))
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* ---------------------------------------------------------------------------------------------- status and errors */

/** What a function returns. Values are never changed nor reused. */
typedef enum hol_status {
    HOL_OK = 0,
    HOL_ERR_NULL = 1,           /**< a pointer that is needed is NULL */
    HOL_ERR_VALUE = 2,          /**< a size, mass, length or option is out of its range */
    HOL_ERR_INDEX = 3,          /**< an atom, bond or chain number is out of range */
    HOL_ERR_SHARED_ATOM = 4,    /**< an atom is used twice; chains that share an atom are not supported yet */
    HOL_ERR_MEMORY = 5,         /**< out of memory */
    HOL_ERR_NOT_FINITE = 6,     /**< an infinity or NaN in the data of a chain, or an overflow on the way */
    HOL_ERR_DEGENERATE = 7,     /**< a bond of length zero, or a chain stretched taut between fixed atoms */
    HOL_ERR_NO_CONVERGENCE = 8, /**< the bond lengths can't be reached from these positions */
    HOL_ERR_NOT_DEFINITE = 9,   /**< hol_tridiagonal_*: the matrix is not positive definite */
    HOL_ERR_INTERNAL = 10       /**< a bug in the library: please report the message */
} hol_status;

/** Version of the library that runs, "MAJOR.MINOR.PATCH". Never NULL. Since 0.1. */
HOL_API const char *hol_version(void);

/** Name of a status, such as "HOL_ERR_INDEX"; "unknown status" for any other number. Never NULL. Since 0.1. */
HOL_API const char *hol_status_name(int status);

/**
 * What went wrong in this thread's last call that failed, naming the chain, bond or atom; "" before the first failure.
 * Valid until the thread's next failing call. Never NULL. Since 0.1.
 */
HOL_API const char *hol_error_message(void);

/**
 * Where this thread's last failing call failed. Each pointer may be NULL. Since 0.1.
 * @param[out] chain  number of the first bad chain, or -1 if it does not apply (likewise below)
 * @param[out] bond   number of the bond within its chain
 * @param[out] atom   number of the atom in the caller's arrays
 * @param[out] n_bad  how many chains were bad (0 for a wrong argument)
 *
 * Numbers are counted as in the handle concerned (hol_chains_set_index_base), from 0 by default.
 */
HOL_API void hol_error_location(int64_t *chain, int64_t *bond, int64_t *atom, int64_t *n_bad);

/**
 * The instruction set that the calculations use on this machine: "baseline", "avx2" or "avx512". Never NULL.
 * The environment variable HOLONOMIC_ISA, read at the first use in a process, forces one of these names if the
 * machine has it. Since 0.1.
 */
HOL_API const char *hol_instruction_set(void);

/* -------------------------------------------------------------------------------------------------------- chains */

/** Which atoms are joined by rigid bonds: any number of linear chains over the caller's atom arrays. */
typedef struct hol_chains hol_chains;

/**
 * Makes an empty set of chains over n_atoms atoms.
 * @param[in]  n_atoms  number of atoms in the caller's arrays, >= 0
 * @param[in]  masses   [n_atoms], mass; 0 or +infinity: the atom is held fixed. Copied.
 * @param[out] chains   the new handle, to be given to hol_chains_destroy; NULL on an error
 * @return HOL_OK; HOL_ERR_NULL; HOL_ERR_VALUE (n_atoms < 0; a mass negative, NaN, or so small that 1/m overflows: the
 *         message names the atom, counted from 0); HOL_ERR_MEMORY. Since 0.1.
 */
HOL_API int hol_chains_create(int64_t n_atoms, const double *masses, hol_chains **chains);

/** Frees a handle; NULL is allowed and does nothing. No other thread may be using it. Since 0.1. */
HOL_API void hol_chains_destroy(hol_chains *chains);

/**
 * Adds one chain of n_bonds bonds, given by its atoms in order along the chain.
 * @param[in,out] chains
 * @param[in]     n_bonds  >= 1
 * @param[in]     atoms    [n_bonds+1], any numbers of atoms of the caller's arrays, each used once
 * @param[in]     lengths  [n_bonds], bond lengths, > 0 and finite. Used by hol_project_positions and hol_violation;
 *                         the acceleration and velocity levels use the bond vectors as they are. Copied.
 * @return HOL_OK; HOL_ERR_NULL; HOL_ERR_VALUE (n_bonds, a length); HOL_ERR_INDEX; HOL_ERR_SHARED_ATOM; HOL_ERR_MEMORY.
 *         On an error nothing is added. Not thread-safe on one handle. Since 0.1.
 */
HOL_API int hol_chains_add(hol_chains *chains, int64_t n_bonds, const int64_t *atoms, const double *lengths);

/**
 * Adds n_chains chains of n_bonds bonds each, over consecutive atoms: chain c has the atoms
 * first_atom + c (n_bonds+1) .. first_atom + c (n_bonds+1) + n_bonds. A melt in one call.
 * @param[in] n_chains    >= 1
 * @param[in] n_bonds     >= 1
 * @param[in] first_atom  number of the first atom of the first chain
 * @param[in] lengths     [n_bonds], bond lengths along a chain, the same for every chain. Copied.
 * @return as hol_chains_add. Since 0.1.
 */
HOL_API int hol_chains_add_block(hol_chains *chains, int64_t n_chains, int64_t n_bonds, int64_t first_atom,
                                 const double *lengths);

/**
 * Counts atoms, bonds and chains from `base`, 0 (default) or 1, in hol_chains_add, hol_chains_add_block, in every
 * number that the library returns and in its messages. For callers whose index lists come from Fortran.
 * @return HOL_OK; HOL_ERR_NULL; HOL_ERR_VALUE. Since 0.1.
 */
HOL_API int hol_chains_set_index_base(hol_chains *chains, int base);

/**
 * Periodic box: bond vectors are taken as the minimum image. The default is none.
 * @param[in] box  [3][3], row i is box vector i, length; a row of zeros: not periodic along that axis. NULL: no box.
 *
 * Orthorhombic boxes (off-diagonal elements all zero) cost less than triclinic ones. The image is the right one for
 * bonds shorter than half the smallest distance between opposite faces. May be set again before every call.
 * @return HOL_OK; HOL_ERR_NULL (chains); HOL_ERR_VALUE (not finite, or singular). Since 0.1.
 */
HOL_API int hol_chains_set_box(hol_chains *chains, const double *box);

/**
 * Number of threads that a call may use, >= 1. The default is 1. Without OpenMP at build time all calls use one.
 * @return HOL_OK; HOL_ERR_NULL; HOL_ERR_VALUE. Since 0.1.
 */
HOL_API int hol_chains_set_threads(hol_chains *chains, int n_threads);

/**
 * Leaves chains out: the data of an inactive chain are neither read nor written, and it counts in no sum.
 * @param[in] active  [n_chains], 0 = inactive, anything else = active; copied. NULL: all active (default). Chains
 *                    added later are active.
 * @return HOL_OK; HOL_ERR_NULL (chains); HOL_ERR_MEMORY. Since 0.1.
 */
HOL_API int hol_chains_set_active(hol_chains *chains, const unsigned char *active);

/**
 * Tolerance of hol_project_positions: a chain is done when |d.d - a^2| / a^2 <= tolerance for each of its bonds.
 * @param[in] tolerance  > 0, or 0 for the default: the rounding of the coordinates, i.e. of the largest coordinate of
 *                       the chain in the element type of the caller's positions.
 * A tolerance below what the coordinates can carry means the default.
 * @return HOL_OK; HOL_ERR_NULL; HOL_ERR_VALUE. Since 0.1.
 */
HOL_API int hol_chains_set_tolerance(hol_chains *chains, double tolerance);

/**
 * Bound on the iterations of hol_project_positions for a chain, 1..1000. The default is 50; a well-posed step needs
 * 2 to 5. @return HOL_OK; HOL_ERR_NULL; HOL_ERR_VALUE. Since 0.1.
 */
HOL_API int hol_chains_set_max_iterations(hol_chains *chains, int max_iterations);

/** Number of atoms, chains and bonds; 0 if chains is NULL. Since 0.1. */
HOL_API int64_t hol_chains_n_atoms(const hol_chains *chains);
HOL_API int64_t hol_chains_n_chains(const hol_chains *chains);
HOL_API int64_t hol_chains_n_bonds(const hol_chains *chains);

/**
 * Where each chain's bonds stand in the arrays per bond.
 * @param[out] offsets  [n_chains+1]: chain c has the bonds offsets[c] .. offsets[c+1]-1; counted from the index base
 * @return HOL_OK; HOL_ERR_NULL. Since 0.1.
 */
HOL_API int hol_chains_offsets(const hol_chains *chains, int64_t *offsets);

/**
 * Atoms of one chain, in order.
 * @param[in]  chain  number of the chain
 * @param[out] atoms  [number of bonds of the chain + 1]
 * @return HOL_OK; HOL_ERR_NULL; HOL_ERR_INDEX. Since 0.1.
 */
HOL_API int hol_chains_atoms(const hol_chains *chains, int64_t chain, int64_t *atoms);

/**
 * Degrees of freedom of all n_atoms atoms: dimensions times the number of atoms that can move, less one for each bond
 * of an active chain between atoms that are not both fixed. A conserved total momentum is not subtracted.
 * @param[in] dimensions  3, or 2 for views without z
 * @return the number; -1 if chains is NULL or dimensions is neither. Since 0.1.
 */
HOL_API int64_t hol_chains_degrees_of_freedom(const hol_chains *chains, int dimensions);

/** Memory that the handle occupies, in bytes; 0 if chains is NULL. Since 0.1. */
HOL_API int64_t hol_chains_memory(const hol_chains *chains);

/* --------------------------------------------------------------------------------------------------------- views */

/** Element type of a view. */
typedef enum hol_element { HOL_DOUBLE = 0, HOL_FLOAT = 1 } hol_element;

/**
 * Where a vector per atom stands in the caller's memory: component x of atom i is the element at
 * (char *)x + i * stride, likewise y and z. Separate arrays, padded records, single precision, two dimensions.
 * Arithmetic is in double precision whatever the element type. Inputs are only read.
 */
typedef struct hol_view {
    void *x, *y, *z;  /**< of atom 0; z == NULL: two dimensions, all z are zero (in every view of a call or in none) */
    int64_t stride;   /**< bytes from an atom to the next, a multiple of the element's size, not 0; may be negative */
    int32_t element;  /**< HOL_DOUBLE or HOL_FLOAT */
    int32_t reserved; /**< 0 */
} hol_view;

/* -------------------------------------------------------------------------------------------- acceleration level */

/** Whether an output per atom replaces what is there, or is added to it. */
typedef enum hol_mode { HOL_WRITE = 0, HOL_ADD = 1 } hol_mode;

/**
 * Constraint forces that keep every bond's length constant at this instant.
 *
 * Finds the multipliers with which each bond obeys sigma'' = 0, that is
 *     d_k . (A_k - A_{k-1}) + |v_k - v_{k-1}|^2 = 0,   A_i = w_i (f_i + G_i),
 * by one factorization per chain: no iteration, no tolerance. docs/theory.md (5)-(12); Mazars 2007, Eqs. (6), (24).
 *
 * @param[in]  chains   which atoms are bonded
 * @param[in]  r        positions [n_atoms][3], length
 * @param[in]  v        velocities [n_atoms][3], or NULL: at rest
 * @param[in]  f        applied forces [n_atoms][3], or NULL: none
 * @param[out] lambda   multipliers [n_bonds], force/length, or NULL
 * @param[out] tension  T = 2 lambda |d| [n_bonds], force, > 0 under tension, or NULL
 * @param[out] g        constraint forces [n_atoms][3], force, or NULL. May be f itself.
 * @param[in]  mode     HOL_WRITE: g = G for the atoms of the chains; HOL_ADD: g = g + G
 * @param[out] virial   [3][3], energy, or NULL: sum_i r_i (x) G_i = - sum_k 2 lambda_k d_k (x) d_k over active chains
 * @return HOL_OK; HOL_ERR_NULL (chains or r); HOL_ERR_VALUE (mode); HOL_ERR_NOT_FINITE; HOL_ERR_DEGENERATE;
 *         HOL_ERR_MEMORY. Thread-safe on one handle. Since 0.1.
 */
HOL_API int hol_forces(const hol_chains *chains, const double *r, const double *v, const double *f, double *lambda,
                       double *tension, double *g, int mode, double *virial);

/** hol_forces with arrays per atom of any layout; views may be NULL as the arrays may. Since 0.1. */
HOL_API int hol_forces_view(const hol_chains *chains, const hol_view *r, const hol_view *v, const hol_view *f,
                            double *lambda, double *tension, const hol_view *g, int mode, double *virial);

/* ------------------------------------------------------------------------------------------------ velocity level */

/**
 * Projects velocities onto the constraints (the second half of RATTLE): after the call d_k . (v_k - v_{k-1}) = 0 for
 * every bond. The change is the one of least kinetic energy, v_i += w_i G_i, with G_i as above; exact, no iteration.
 * docs/theory.md (13)-(14).
 *
 * @param[in]     chains
 * @param[in]     r       positions [n_atoms][3]
 * @param[in,out] v       velocities [n_atoms][3]
 * @param[out]    lambda  multipliers of the impulse [n_bonds], force time/length, or NULL: m_i dv_i = - sum lambda grad
 * sigma
 * @param[out]    virial  [3][3], energy time, or NULL: sum_i r_i (x) (m_i dv_i). Divide by the time over which the
 *                        impulse acts (docs/integrators.md).
 * @return HOL_OK; HOL_ERR_NULL (chains, r or v); HOL_ERR_NOT_FINITE; HOL_ERR_DEGENERATE; HOL_ERR_MEMORY.
 *         Thread-safe on one handle, each thread with velocities of its own. Since 0.1.
 */
HOL_API int hol_project_velocities(const hol_chains *chains, const double *r, double *v, double *lambda,
                                   double *virial);

/** hol_project_velocities with arrays per atom of any layout. Since 0.1. */
HOL_API int hol_project_velocities_view(const hol_chains *chains, const hol_view *r, const hol_view *v, double *lambda,
                                        double *virial);

/* ------------------------------------------------------------------------------------------------ position level */

/** What hol_project_positions did. */
typedef struct hol_report {
    int64_t iterations;  /**< largest number of linear solves that a chain took */
    int64_t n_corrected; /**< chains that were moved; the others already obeyed the tolerance */
    int64_t n_failed;    /**< chains that were left as they were because they did not converge or had bad data */
    int64_t chain;       /**< chain and */
    int64_t bond;        /**< bond (within the chain) with the largest error; -1 if there is none */
    double max_error;    /**< largest |d.d - a^2| / a^2 left in a chain that did not fail, before the positions are
                              rounded to the caller's element type */
} hol_report;

/**
 * Puts positions back on the constraints (SHAKE; the first half of RATTLE): finds G along the bonds of r_ref such that
 *     r_i + dt^2 w_i G_i,   G_i = 2 (lambda_{i+1} b_{i+1} - lambda_i b_i),   b_k = r_ref,k - r_ref,k-1,
 * has |d_k| = a_k for every bond, to the rounding of the coordinates, by Newton's method with the exact tridiagonal
 * Jacobian. docs/theory.md (15)-(19), docs/integrators.md.
 *
 * @param[in]     chains
 * @param[in]     r_ref   positions before the drift [n_atoms][3]
 * @param[in,out] r       positions after the drift [n_atoms][3]; in: unconstrained, out: constrained
 * @param[in,out] v       velocities [n_atoms][3], or NULL; v_i += dt w_i G_i, the displacement over dt. Only added to:
 *                        what is there is not checked, and a NaN stays one
 * @param[in]     dt      time step, time, > 0 and finite
 * @param[in,out] lambda  multipliers [n_bonds], force/length, or NULL. The constraint force over a leap-frog step; half
 *                        of it for velocity Verlet, whose position update carries dt^2/2.
 * @param[in]     guess   0, or 1: lambda holds a first guess, the multipliers of the last step, which saves an
 * iteration
 * @param[out]    virial  [3][3], energy, or NULL: sum_i r_ref,i (x) G_i = - sum_k 2 lambda_k b_k (x) b_k
 * @param[out]    report  or NULL; written whenever the arguments are valid, also if chains fail
 * @return HOL_OK; HOL_ERR_NULL (chains, r_ref or r; lambda with guess = 1); HOL_ERR_VALUE (dt, guess);
 *         HOL_ERR_NOT_FINITE; HOL_ERR_DEGENERATE; HOL_ERR_NO_CONVERGENCE; HOL_ERR_MEMORY. A chain already within the
 *         tolerance (hol_chains_set_tolerance) is not touched and has lambda = 0. A chain that fails keeps r, v and
 *         lambda. Thread-safe on one handle, each thread with arrays of its own. Since 0.1.
 */
HOL_API int hol_project_positions(const hol_chains *chains, const double *r_ref, double *r, double *v, double dt,
                                  double *lambda, int guess, double *virial, hol_report *report);

/** hol_project_positions with arrays per atom of any layout. Since 0.1. */
HOL_API int hol_project_positions_view(const hol_chains *chains, const hol_view *r_ref, const hol_view *r,
                                       const hol_view *v, double dt, double *lambda, int guess, double *virial,
                                       hol_report *report);

/** How far positions and velocities are from the constraints. */
typedef struct hol_worst {
    double length;        /**< largest |d.d - a^2| / a^2 */
    int64_t length_chain; /**< its chain, -1 if there is no bond */
    int64_t length_bond;  /**< its bond within the chain */
    double rate;          /**< largest |d . (v_k - v_{k-1})|, length^2/time; 0 without v */
    int64_t rate_chain;
    int64_t rate_bond;
} hol_worst;

/**
 * Largest violation of the constraints over the active chains.
 * @param[in]  r      positions [n_atoms][3]
 * @param[in]  v      velocities [n_atoms][3], or NULL
 * @param[out] worst
 * @return HOL_OK; HOL_ERR_NULL (chains, r or worst); HOL_ERR_NOT_FINITE (worst is then not written). Since 0.1.
 */
HOL_API int hol_violation(const hol_chains *chains, const double *r, const double *v, hol_worst *worst);

/** hol_violation with arrays per atom of any layout. Since 0.1. */
HOL_API int hol_violation_view(const hol_chains *chains, const hol_view *r, const hol_view *v, hol_worst *worst);

/* -------------------------------------------------------------------------- metric determinant and Fixman potential */

/**
 * The metric determinant of rigid chains, and the Fixman potential that corrects for it.
 *
 * Z is the matrix that hol_forces solves; Z~ is Z scaled to ones on its diagonal, a function of the masses and of the
 * angles between neighbouring bonds only. A rigid chain visits its conformations with the weight det Z~^(+1/2) relative
 * to the freely jointed chain (stiff springs); with the potential energy
 *     U_F = +(kT/2) sum over chains of ln det Z~
 * added to the others it visits them as the freely jointed chain does. docs/theory.md (24)-(32); Mazars 2007, Eq. (19).
 *
 * @param[in]     chains
 * @param[in]     r          positions [n_atoms][3]
 * @param[in]     kT         thermal energy, >= 0 and finite; only energy and force depend on it
 * @param[out]    log_det    [n_chains] ln det Z~, <= 0, or NULL. Relative error a few roundings, however straight the
 *                           chain and however unequal its masses. 0 for a chain of one bond.
 * @param[out]    log_det_z  [n_chains] ln det Z, which contains masses and the bonds' actual lengths in the caller's
 *                           units (Z_kk = 4 (w_{k-1} + w_k) |d_k|^2), or NULL
 * @param[out]    energy     U_F, or NULL; summed over active chains
 * @param[in,out] force      - grad U_F [n_atoms][3], or NULL
 * @param[in]     mode       HOL_WRITE: force = - grad U_F for the atoms of the chains; HOL_ADD: added to what is there
 *
 * Entries of inactive chains are not written. The force on a fixed atom is reported too: minus what the others get.
 * Total force, total torque and the trace of the virial of the force are zero.
 * @return HOL_OK; HOL_ERR_NULL (chains or r); HOL_ERR_VALUE (kT, mode); HOL_ERR_NOT_FINITE; HOL_ERR_DEGENERATE;
 *         HOL_ERR_MEMORY. Thread-safe on one handle. Since 0.1.
 */
HOL_API int hol_metric(const hol_chains *chains, const double *r, double kT, double *log_det, double *log_det_z,
                       double *energy, double *force, int mode);

/** hol_metric with arrays per atom of any layout. Since 0.1. */
HOL_API int hol_metric_view(const hol_chains *chains, const hol_view *r, double kT, double *log_det, double *log_det_z,
                            double *energy, const hol_view *force, int mode);

/* ------------------------------------------------------------------------------------------------- inverse of Z */

/** The inverse of the matrix Z of one chain in one conformation, prepared so that each element costs what it must. */
typedef struct hol_inverse hol_inverse;

/** Which inverse: of Z~ (ones on its diagonal, no units) or of Z, in 1/(length^2/mass). lambda = Z^-1 (K + C). */
typedef enum hol_scaling { HOL_UNIT_DIAGONAL = 0, HOL_PHYSICAL = 1 } hol_scaling;

/**
 * Prepares the inverse for one chain, in time and memory proportional to its number of bonds N.
 * docs/theory.md (33)-(37); Mazars 2007, Eqs. (20) and (28). Everything is copied: the set of chains and r may be
 * changed or freed afterwards.
 * @param[in]  chains   an inactive chain is allowed
 * @param[in]  chain    number of the chain, counted from the index base of `chains`, as bonds and atoms are in all the
 *                      functions below
 * @param[in]  r        positions [n_atoms][3]
 * @param[out] inverse  the new handle, to be given to hol_inverse_destroy; NULL on an error
 * @return HOL_OK; HOL_ERR_NULL; HOL_ERR_INDEX; HOL_ERR_NOT_FINITE; HOL_ERR_DEGENERATE; HOL_ERR_MEMORY.
 *         Thread-safe on one `chains`. Since 0.1.
 */
HOL_API int hol_inverse_create(const hol_chains *chains, int64_t chain, const double *r, hol_inverse **inverse);

/** hol_inverse_create with positions of any layout. Since 0.1. */
HOL_API int hol_inverse_create_view(const hol_chains *chains, int64_t chain, const hol_view *r, hol_inverse **inverse);

/** Frees a handle; NULL is allowed and does nothing. Since 0.1. */
HOL_API void hol_inverse_destroy(hol_inverse *inverse);

/** Number of bonds of the chain, i.e. of rows; 0 if inverse is NULL. Since 0.1. */
HOL_API int64_t hol_inverse_n_bonds(const hol_inverse *inverse);

/**
 * One element, in a time proportional to |i - j| + 1. It is right to a few roundings plus one or two for each step
 * from i to j; it vanishes exactly where a right angle or a fixed atom lies between i and j, and underflows only if the
 * element does.
 * @param[in]  inverse
 * @param[in]  scaling  HOL_UNIT_DIAGONAL or HOL_PHYSICAL
 * @param[in]  i, j     numbers of bonds within the chain
 * @param[out] value    (Z~^-1)_ij or (Z^-1)_ij
 * @return HOL_OK; HOL_ERR_NULL; HOL_ERR_VALUE (scaling); HOL_ERR_INDEX. Thread-safe, as all functions of a hol_inverse
 *         are. Since 0.1.
 */
HOL_API int hol_inverse_entry(const hol_inverse *inverse, int scaling, int64_t i, int64_t j, double *value);

/**
 * Row i, which is column i too, in O(N).
 * @param[out] row  [N]
 * @return as hol_inverse_entry. Since 0.1.
 */
HOL_API int hol_inverse_row(const hol_inverse *inverse, int scaling, int64_t i, double *row);

/**
 * The diagonal and `width` diagonals beside it, in O(N (width+1)); width 0 is the diagonal alone.
 * @param[in]  width  >= 0
 * @param[out] band   [N][width+1]: element (i, i+k) at band[i (width+1) + k], 0 where i+k is past the last bond
 * @return HOL_OK; HOL_ERR_NULL; HOL_ERR_VALUE (scaling, width). Since 0.1.
 */
HOL_API int hol_inverse_band(const hol_inverse *inverse, int scaling, int64_t width, double *band);

/**
 * The whole inverse, in O(N^2).
 * @param[out] matrix  [N][N], symmetric to the last bit
 * @return HOL_OK; HOL_ERR_NULL; HOL_ERR_VALUE (scaling). Since 0.1.
 */
HOL_API int hol_inverse_matrix(const hol_inverse *inverse, int scaling, double *matrix);

/**
 * Condition number of Z~ in the infinity norm, |Z~| |Z~^-1|, in O(N): by how much relative errors in the matrix can
 * grow in the multipliers, at worst and in norm. About N^2/2 for a straight chain of equal masses. The library's own
 * rounding does not grow with it; the effect of errors in the caller's positions does.
 * @return HOL_OK; HOL_ERR_NULL. Since 0.1.
 */
HOL_API int hol_inverse_condition(const hol_inverse *inverse, double *condition);

/**
 * How far given multipliers of the chain are from the exact ones, as a guaranteed bound found afterwards: |Z^-1| times
 * the residual K + C - Z lambda, evaluated in twice the precision, with the rounding of the evaluation itself added.
 * O(N). It says how far to trust multipliers from any source, this library or another solver.
 *
 * @param[in]  inverse  of the conformation to which the multipliers belong
 * @param[in]  v, f     velocities and applied forces as given to hol_forces, [n_atoms][3]; either may be NULL
 * @param[in]  lambda   [N], the chain's part of the multipliers
 * @param[out] bound    [N] |lambda_k - exact lambda_k| <= bound_k, or NULL
 * @param[out] relative the largest bound_k over the largest |lambda_k|, or NULL; 0 if all bounds are 0, infinite if
 *                      only the multipliers are
 *
 * "Exact" is for the given doubles of r, v, f and for the inverse masses as rounded to doubles. What the data's own
 * errors do comes on top: at most a relative error of theirs times hol_inverse_condition.
 * @return HOL_OK; HOL_ERR_NULL (inverse or lambda); HOL_ERR_NOT_FINITE (v, f or lambda; nothing is written). Since 0.1.
 */
HOL_API int hol_inverse_error_bound(const hol_inverse *inverse, const double *v, const double *f, const double *lambda,
                                    double *bound, double *relative);

/** hol_inverse_error_bound with arrays per atom of any layout. Since 0.1. */
HOL_API int hol_inverse_error_bound_view(const hol_inverse *inverse, const hol_view *v, const hol_view *f,
                                         const double *lambda, double *bound, double *relative);

/* ------------------------------------------------------------------------------------- the bare tridiagonal algebra */

/*
 * The symmetric tridiagonal matrix T of n rows with ones on its diagonal and -gamma beside it, T_{k-1,k} = -gamma_k, as
 * it appears in spin models, harmonic chains and other one-dimensional models. gamma is [n-1]: gamma[0] couples the
 * first two rows (gamma_2 in the paper), gamma[k] rows k and k+1 counted from 0.
 *
 * Accuracy. Results are those of the given doubles to a few roundings (plus one or two for each row between i and j in
 * inverse elements), as all recursions run in twice the precision; this holds up to a condition number of about 1e14.
 * But gamma alone carries only so much: changing each gamma by half a unit in its last place changes the results by up
 * to 1.1e-16 times the condition number, relatively. Chains whose masses and bond vectors are known should go through
 * hol_metric and hol_inverse, which lose nothing. A matrix that its rounding has made singular is reported as such.
 *
 * All return HOL_OK; HOL_ERR_NULL; HOL_ERR_VALUE (n < 1; width); HOL_ERR_INDEX (i, j); HOL_ERR_NOT_FINITE (gamma, b);
 * HOL_ERR_NOT_DEFINITE (Omega^2 <= 0: message and hol_error_location's bond name the row, counted from 0);
 * HOL_ERR_MEMORY. On an error nothing is written. Thread-safe. docs/theory.md (38)-(41).
 */

/**
 * Pivots of the elimination from the first row on, Omega_k^2 = 1 - gamma_k^2 / Omega_{k-1}^2 (Mazars 2007, Eq. 17).
 * O(n).
 * @param[in]  n
 * @param[in]  gamma   [n-1]; may be NULL if n = 1
 * @param[out] omega2  [n], the first is 1
 * Since 0.1.
 */
HOL_API int hol_tridiagonal_pivots(int64_t n, const double *gamma, double *omega2);

/** ln det T = sum of ln Omega^2 (Mazars 2007, Eq. 19). O(n). Since 0.1. */
HOL_API int hol_tridiagonal_log_det(int64_t n, const double *gamma, double *log_det);

/**
 * Solves T x = b. O(n).
 * @param[in]  b  [n]
 * @param[out] x  [n], may be b itself
 * Since 0.1.
 */
HOL_API int hol_tridiagonal_solve(int64_t n, const double *gamma, const double *b, double *x);

/**
 * One element of the inverse (Mazars 2007, Eq. 20). O(n) whatever i and j; for many elements use the band.
 * @param[in] i, j  rows, counted from 0
 * Since 0.1.
 */
HOL_API int hol_tridiagonal_inverse_entry(int64_t n, const double *gamma, int64_t i, int64_t j, double *value);

/**
 * The diagonal of the inverse and `width` diagonals beside it. O(n (width+1)).
 * @param[out] band  [n][width+1]: element (i, i+k) at band[i (width+1) + k], 0 where i+k is past the last row
 * Since 0.1.
 */
HOL_API int hol_tridiagonal_inverse_band(int64_t n, const double *gamma, int64_t width, double *band);

/* -------------------------------------------------------------------------------------------- partition functions */

/**
 * Means of powers of the metric determinant over all conformations of the freely jointed chain of given masses, i.e.
 * over independent bond directions, each uniform on the sphere; as logarithms. With x_n = m_n m_{n-2} / ((m_{n-1} +
 * m_n) (m_{n-1} + m_{n-2})) and gamma_n uniform in 0 .. sqrt(x_n): log_he      ln < det Z~^(-1/2) >: the multiple
 * hypergeometric function He(1/2; 3/2; x_2..x_N), the integral of Mazars 2007, Eq. (31) log_rigid   ln < det Z~^(+1/2)
 * >: the rigid chain's partition function over that of the freely jointed chain;
 *                 - kT log_rigid is what the metric contributes to the free energy of a rigid chain
 *     log_volume  sum of ln sqrt(x_n): log_he + log_volume is the integral of Eq. (34) (with x_n in its product), and
 *                 likewise for log_rigid; -infinity if an inner atom is fixed
 *
 * @param[in]  n_bonds     N >= 1
 * @param[in]  masses      [N+1], any unit; 0 or +infinity: held fixed. NULL: all equal
 * @param[out] log_he      or NULL
 * @param[out] log_rigid   or NULL
 * @param[out] log_volume  or NULL
 *
 * Method: a transfer operator in the pivots Omega, docs/theory.md (42)-(49), in O(N); a chain of 10,000 bonds takes
 * about a second, two or three if its masses span many decades. exp(log_he) and exp(log_rigid) have the relative error
 * of the logarithm's own rounding as a double, about 1e-16 (1 + |logarithm|), where long double has 64 bits or more;
 * elsewhere about 1e-16 N.
 * @return HOL_OK; HOL_ERR_NULL (all three outputs); HOL_ERR_VALUE (n_bonds, a mass: the message names the atom, counted
 *         from 0); HOL_ERR_DEGENERATE (a bond between two fixed atoms); HOL_ERR_MEMORY. On an error nothing is written.
 *         Thread-safe. Since 0.1.
 */
HOL_API int hol_partition_function(int64_t n_bonds, const double *masses, double *log_he, double *log_rigid,
                                   double *log_volume);

#ifdef __cplusplus
}
#endif
#endif
