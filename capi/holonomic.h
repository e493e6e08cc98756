/**
 * @file holonomic.h
 * Exact Lagrange multipliers and constraint forces of molecules with rigid bonds: linear chains, branched molecules,
 * rings, rigid water, any graph.
 *
 * Conventions of all functions (derivations: docs/theory.md):
 *
 * - Atom i has mass m_i, inverse mass w_i = 1/m_i (0: held fixed), position r_i, velocity v_i and applied force f_i.
 *   Bond k joins atoms i and j; it has the vector d_k = r_j - r_i, the length a_k and the constraint
 *   sigma_k = d_k.d_k - a_k^2 = 0.
 * - The constraint force is G_i = - sum_k lambda_k grad_i sigma_k, in a linear chain
 *   2 (lambda_{i+1} d_{i+1} - lambda_i d_i). T_k = 2 lambda_k |d_k| is the tension of the bond, a force; > 0 pulls its
 *   atoms together. Neither depends on which atom of a bond comes first.
 * - A molecule is a set of atoms joined by bonds, directly or through each other. Fixed atoms join nothing, so one may
 *   belong to many molecules. Molecules are numbered in the order of the calls that add them and, within a call, by
 *   their lowest atom that can move. Molecules with rigid bodies come after all others. A chain is a linear molecule.
 *   In the name hol_chains, and only there, the word means a molecule of any shape.
 * - Bonds of a molecule are counted along a linear chain, otherwise by their lower and then by their higher atom:
 *   hol_chains_bonds gives their places in the arrays per bond.
 * - A bond between two fixed atoms is no constraint: it belongs to no molecule, removes no degree of freedom, and its
 *   multiplier and tension are 0.
 * - Units are the caller's own; any consistent set does (mass, length, time; force = mass length / time^2). Units that
 *   differ by powers of two give the same bits; only sums over molecules may differ in their last bits. If numbers on
 *   the way would overflow or underflow, the library works on the molecule in other units, which takes longer. If a
 *   result itself overflows, that is HOL_ERR_NOT_FINITE.
 * - An output that is NULL is not computed; an input that may be NULL is zero then. Neither costs anything.
 * - Arrays per atom are [n_atoms][3] (Fortran: (3, n_atoms)); only atoms of molecules are read and written. Arrays per
 *   bond are [n_bonds], in the order in which the bonds were given, call after call. Arrays per molecule are
 *   [n_molecules].
 * - Where a count is 0 (no atoms, no bonds, nothing to add), the pointers that go with it are not needed, and the
 *   function returns HOL_OK: a process without atoms calls what all others call.
 * - Every function that can fail returns an hol_status. hol_error_message() then says in words what was wrong and
 *   where, hol_error_location() in numbers; both are the calling thread's own.
 * - A wrong argument: nothing is written. Bad data in some molecules (HOL_ERR_NOT_FINITE, HOL_ERR_DEGENERATE,
 *   HOL_ERR_NO_CONVERGENCE): their outputs stay as they were, bit for bit; all other molecules are complete; sums over
 *   molecules (virial, energy) are not written. Status, message and location are those of the first bad molecule. A
 *   fixed atom of several molecules gets the sum over those that are not bad.
 * - An output may overlap another argument only where its description says so. If velocities or forces are the same
 *   array as the positions, that is HOL_ERR_VALUE.
 * - The library never prints, exits, aborts or throws.
 * - Floating-point environment: each function calculates in the default environment of the processor, in all its
 *   threads. So it gives the same bits whatever the caller has set: exceptions that trap (gfortran's -ffpe-trap),
 *   another rounding, denormal numbers flushed to zero. The caller's environment stays as it was, sticky exception
 *   flags included.
 * - Threads: any number of threads may use a handle at once, as long as none of them changes it (create, add, set,
 *   destroy). Scratch memory belongs to the calling thread. After a thread's first call with molecules of that size
 *   nothing is allocated, with three exceptions: hol_impose; a long chain whose positions need a second attempt (light
 *   atoms, taut between heavy ones); and a step so long that a molecule is looked at alone.
 * - Results depend on nothing but the molecule: not on hol_chains_set_threads, the memory layout, the other molecules,
 *   nor the order in which bonds were given.
 */
#ifndef HOLONOMIC_H
#define HOLONOMIC_H

#include <stdint.h>

#define HOL_VERSION_MAJOR 0
#define HOL_VERSION_MINOR 3
#define HOL_VERSION_PATCH 0
/** The version as a number that can be compared: 0.3.0 is 300. hol_version_number() is that of the library that runs.
 */
#define HOL_VERSION (10000 * HOL_VERSION_MAJOR + 100 * HOL_VERSION_MINOR + HOL_VERSION_PATCH)

#if defined(_WIN32) || !defined(__GNUC__)
#define HOL_API
#else
#define HOL_API __attribute__((visibility("default")))
#endif

/* An enum is an int in C++, too: any number may be handed over, and those that are none of its values are refused. */
#if defined(__cplusplus) && __cplusplus >= 201103L
#define HOL_IS_INT : int
#else
#define HOL_IS_INT
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* ---------------------------------------------------------------------------------------------- status and errors */

/** What a function returns. Values are never changed nor reused. */
typedef enum hol_status HOL_IS_INT {
    HOL_OK = 0,
    HOL_ERR_NULL = 1,           /**< a pointer that is needed is NULL */
    HOL_ERR_VALUE = 2,          /**< a size, mass, length or option is out of its range */
    HOL_ERR_INDEX = 3,          /**< the number of an atom, bond or molecule is out of range */
    HOL_ERR_SHARED_ATOM = 4,    /**< an atom that can move belongs to a molecule of an earlier call already */
    HOL_ERR_MEMORY = 5,         /**< out of memory */
    HOL_ERR_NOT_FINITE = 6,     /**< an infinity or NaN in the data of a molecule, or an overflow or underflow */
    HOL_ERR_DEGENERATE = 7,     /**< a bond of length zero, bonds that are not independent of each other */
    HOL_ERR_NO_CONVERGENCE = 8, /**< the bond lengths can't be reached from these positions */
    HOL_ERR_NOT_DEFINITE = 9,   /**< hol_tridiagonal_*: the matrix is not positive definite */
    HOL_ERR_INTERNAL = 10,      /**< a bug in the library: please report the message */
    HOL_ERR_LENGTHS = 11,       /**< positions do not fit the bonds' lengths (hol_chains_set_checks). Since 0.2. */
    HOL_ERR_UNSUPPORTED = 12,   /**< sound, but not implemented for such molecules. Since 0.3. */
    HOL_ERR_STATE = 13,         /**< not at this time: something has to be called before, or may not be any more.
                                     Since 0.3. */
    HOL_ERR_CALLBACK = 14       /**< a function of the caller's has failed. Since 0.3. */
} hol_status;

/** Version of the library that runs, "MAJOR.MINOR.PATCH". Never NULL. Since 0.1. */
HOL_API const char *hol_version(void);

/** Version of the library that runs as a number, HOL_VERSION of its header. Since 0.3. */
HOL_API int hol_version_number(void);

/** Name of a status, such as "HOL_ERR_INDEX"; "unknown status" for any other number. Never NULL. Since 0.1. */
HOL_API const char *hol_status_name(int status);

/**
 * What went wrong in this thread's last call that failed, with the function and the molecule, bond or atom; "" before
 * the first failure. Valid until the thread's next failing call. Never NULL. Since 0.1.
 */
HOL_API const char *hol_error_message(void);

/**
 * Where this thread's last failing call failed. Each pointer may be NULL. Since 0.1.
 * @param[out] molecule  number of the first bad molecule, or -1 if it does not apply (likewise below)
 * @param[out] bond      number of the bond within its molecule (hol_chains_bonds); of a bond that could not be added,
 *                       its number in the list of that call
 * @param[out] atom      number of the atom in the caller's arrays
 * @param[out] n_bad     how many molecules were bad (0 for a wrong argument)
 *
 * Numbers are counted as in the handle concerned (hol_chains_set_index_base), from 0 by default.
 */
HOL_API void hol_error_location(int64_t *molecule, int64_t *bond, int64_t *atom, int64_t *n_bad);

/**
 * For bindings to other languages: a binding that has found a failure itself records it here as this thread's last one.
 * The failure has no place: hol_error_location() gives -1, so that nothing is told of an earlier failure.
 * @param[in] status   an hol_status
 * @param[in] message  copied, at most 639 letters of it; NULL: ""
 * @return status. Since 0.3.
 */
HOL_API int hol_error_remember(int status, const char *message);

/**
 * The instruction set that the calculations use on this machine: "baseline", "avx2" or "avx512vl" (four lanes with the
 * registers of AVX-512); on 64-bit Arm "neon". Never NULL. A chain of up to 256 bonds that comes alone runs with
 * "scalar" (one lane) where one of the last three runs: the same bits, in less time. The environment variable
 * HOLONOMIC_ISA, read at the first use in a process, forces one of these names if the machine has it. Since 0.1.
 */
HOL_API const char *hol_instruction_set(void);

/* ----------------------------------------------------------------------------------------------------- molecules */

/** Which atoms are joined by rigid bonds: any number of molecules over the caller's atom arrays. */
typedef struct hol_chains hol_chains;

/**
 * Makes an empty set of molecules over n_atoms atoms.
 * @param[in]  n_atoms  number of atoms in the caller's arrays, >= 0
 * @param[in]  masses   [n_atoms], mass; +infinity: the atom is held fixed. 0 means the same, as in earlier releases,
 *                      except for an atom of a rigid body: there it makes a massless site (hol_chains_add_rigid). All
 *                      may be fixed. Copied.
 * @param[out] chains   the new handle, to be given to hol_chains_destroy; NULL on an error
 * @return HOL_OK; HOL_ERR_NULL; HOL_ERR_VALUE (n_atoms < 0; a mass negative, NaN, or so small that 1/m overflows: the
 *         message names the atom, counted from 0); HOL_ERR_MEMORY. Since 0.1.
 */
HOL_API int hol_chains_create(int64_t n_atoms, const double *masses, hol_chains **chains);

/**
 * Makes a second handle with the same molecules, lengths, masses, boxes and options. Each of the two can be changed
 * without the other: one for each replica that has a box of its own. Both share what the library has found out about
 * the shapes of molecules, so that a copy costs no more than to copy the lists. Either may be destroyed first.
 * @param[in]  chains
 * @param[out] copy    the new handle, to be given to hol_chains_destroy; NULL on an error
 * @return HOL_OK; HOL_ERR_NULL; HOL_ERR_MEMORY. Thread-safe on one handle. Since 0.3.
 */
HOL_API int hol_chains_copy(const hol_chains *chains, hol_chains **copy);

/** Frees a handle; NULL is allowed and does nothing. No other thread may be using it. Since 0.1. */
HOL_API void hol_chains_destroy(hol_chains *chains);

/**
 * Adds one linear chain of n_bonds bonds, given by its atoms in order along the chain.
 * @param[in,out] chains
 * @param[in]     n_bonds  >= 0
 * @param[in]     atoms    [n_bonds+1], any numbers of atoms of the caller's arrays; one that can move is used once. One
 *                         of mass 0 or infinite is held fixed, here and in all other functions that add bonds
 * @param[in]     lengths  [n_bonds], bond lengths, 1e-150 .. 1e150. Used by hol_project_positions and hol_violation;
 *                         the acceleration and velocity levels use the bond vectors as they are. Copied.
 * @return HOL_OK; HOL_ERR_NULL; HOL_ERR_VALUE (n_bonds, a length; since 0.2 a length of more than half the box that is
 *         set); HOL_ERR_INDEX; HOL_ERR_SHARED_ATOM; HOL_ERR_MEMORY (also: more than hol_chains_set_memory_limit
 *         allows). On an error nothing is added. Not thread-safe on one handle. Since 0.1.
 *
 * The chain is one molecule, whatever atoms of it are fixed; only a bond between two fixed atoms divides it in two.
 */
HOL_API int hol_chains_add(hol_chains *chains, int64_t n_bonds, const int64_t *atoms, const double *lengths);

/**
 * Adds n_chains linear chains of n_bonds bonds each, over consecutive atoms: chain c has the atoms
 * first_atom + c (n_bonds+1) .. first_atom + c (n_bonds+1) + n_bonds. A melt in one call.
 * @param[in,out] chains
 * @param[in] n_chains    >= 0
 * @param[in] n_bonds     >= 0
 * @param[in] first_atom  number of the first atom of the first chain
 * @param[in] lengths     [n_bonds], bond lengths along a chain, the same for every chain. Copied.
 * @return as hol_chains_add. Since 0.1.
 */
HOL_API int hol_chains_add_block(hol_chains *chains, int64_t n_chains, int64_t n_bonds, int64_t first_atom,
                                 const double *lengths);

/**
 * Adds bonds in any order, either atom first. The library finds the molecules that they form, and which of them are
 * linear chains, trees, rings, triangles or anything else (docs/molecules.md). It works on molecules with equal masses,
 * lengths and relative numbers of atoms together. So number the atoms of equal molecules alike: calls are then as fast
 * as with hol_chains_add_molecules.
 *
 * @param[in,out] chains
 * @param[in]     n_bonds  >= 0
 * @param[in]     pairs    [n_bonds][2], the two atoms of each bond (Fortran: (2, n_bonds))
 * @param[in]     lengths  [n_bonds], as in hol_chains_add. Copied.
 *
 * Distances that depend on each other become rigid bodies, as if hol_chains_add_rigid had been called, where their
 * lengths say so:
 * - atoms that are all bonded to each other: three on a line, four in a plane, five and more;
 * - rings of six atoms and more whose angles, held by distances of next neighbours, keep them in a plane;
 * - atoms that such a body holds by more distances than their places have coordinates.
 *
 * Lengths may have few decimals, as in a topology file. The library adjusts them in the least way
 * (hol_chains_adjustment), by no more than hol_chains_set_length_tolerance. Four atoms count as flat, and three as
 * straight, where a plane or a line misses their lengths by no more than their last decimal, or where no other places
 * are nearer. Forces and motions are those of the body. Multipliers of its bonds are not unique: their pulls come as
 * near as they can to the body's forces, and of all such multipliers these have the least norm. Only forces across a
 * line or plane have no multipliers. hol_solve does not look at the right-hand sides of these bonds.
 *
 * Groups of five atoms and more that share atoms, as all bonds and angles of an alkane do, become no bodies. Distances
 * that shorter ones of the molecule imply (the tenth of five atoms, ...) are left out of the equations
 * (hol_chains_implied); their lengths must agree with the others within the same tolerance. Groups on a line or in a
 * plane that share atoms with each other become linear relations (hol_chains_add_linear), and the distances that are
 * independent of these stay constraints; multipliers of all other distances are 0. A length of 0 makes one point of two
 * atoms that can move.
 *
 * New molecules are numbered by their lowest atoms that can move, those with bodies behind all others. Arrays per bond
 * have these bonds in the order of the list, after those of earlier calls. All bonds of a molecule have to be given in
 * one call, but a fixed atom may occur in any number of bonds and calls.
 * @return HOL_OK; HOL_ERR_NULL; HOL_ERR_VALUE (n_bonds, a length, a bond of an atom with itself, a molecule of more
 *         than 2^31 - 1 bonds; lengths of a triangle or ring that can't close: the message names the atoms);
 *         HOL_ERR_INDEX; HOL_ERR_SHARED_ATOM (an atom that can move is in a molecule of an earlier call; the message
 *         names it); HOL_ERR_DEGENERATE (a bond given twice, more bonds within a part of a molecule than it has
 *         freedoms, or lengths of four atoms and more that fit no places in space: the message names a bond. Bonds
 *         that depend on each other through the positions alone are found by the calls that meet them);
 *         HOL_ERR_MEMORY (also: more than hol_chains_set_memory_limit allows; the message names the molecule).
 *         On an error nothing is added. Not thread-safe on one handle. O(n_bonds). Since 0.2.
 */
HOL_API int hol_chains_add_bonds(hol_chains *chains, int64_t n_bonds, const int64_t *pairs, const double *lengths);

/**
 * Adds the same bonds for n_molecules molecules of n_atoms consecutive atoms each: molecule m has the atoms
 * first_atom + m n_atoms .. first_atom + m n_atoms + n_atoms - 1. A box of rigid water in one call.
 * @param[in,out] chains
 * @param[in] n_molecules  >= 0
 * @param[in] n_atoms      >= 2, atoms from one molecule to the next; some may have no bond (virtual sites)
 * @param[in] first_atom   number of the first atom of the first molecule
 * @param[in] n_bonds      >= 0, bonds of one molecule
 * @param[in] pairs        [n_bonds][2], numbers within the molecule, counted from the index base
 * @param[in] lengths      [n_bonds], the same for every molecule. Copied.
 * @return as hol_chains_add_bonds with n_molecules copies of these bonds in one list, molecule after molecule. If the
 *         bonds do not hold together, each copy makes several molecules. Since 0.2.
 */
HOL_API int hol_chains_add_molecules(hol_chains *chains, int64_t n_molecules, int64_t n_atoms, int64_t first_atom,
                                     int64_t n_bonds, const int64_t *pairs, const double *lengths);

/**
 * Adds rigid bodies, and bonds at them: any number of atoms held as one whole (CO2, benzene, a cage, a patchy
 * particle), with massless sites (TIP4P) among them, alone or in molecules with bonds, such as side chains, rings in a
 * row, or a body tethered to a fixed atom. docs/rigid.md.
 *
 * @param[in,out] chains
 * @param[in]     n_bodies  >= 0
 * @param[in]     sizes     [n_bodies], how many atoms each body has, >= 2
 * @param[in]     atoms     [sum of sizes], the atoms of one body after the other, any numbers of the caller's arrays.
 *                          An atom of mass 0 becomes a massless site here: its position is written with those of the
 *                          body's atoms, and the force on it goes to them, in G of hol_forces. So an integrator that
 *                          kicks and projects must kick by f + G (docs/rigid.md). An atom of infinite mass is held
 *                          fixed, and can be in no body
 * @param[in]     places    [sum of sizes][3], reference coordinates of these atoms, each body in any frame of its own.
 *                          They give the shape of the body alone. The positions given to the verbs say where it is and
 *                          which way it points. Copied.
 * @param[in]     n_bonds   >= 0; 0: the bodies are alone
 * @param[in]     pairs     [n_bonds][2], bonds between an atom of a body and another atom: of another body, of none, or
 *                          held fixed; and between other atoms of these molecules. May be NULL if n_bonds is 0
 * @param[in]     lengths   [n_bonds], as in hol_chains_add. May be NULL if n_bonds is 0. Copied.
 *
 * Bodies may be linear or planar: atoms on a line to 1e-8 of its length are a linear body. A site must lie on the line
 * of a linear body. It may lie off the plane of a planar one (the lone pairs of TIP5P): it keeps its height along the
 * normal, on the side on which it is in `places`, and can have no bond to atoms outside of its body (since 0.3). The
 * body itself satisfies a bond within it: its multiplier is 0. Bodies may share atoms (since 0.2): one is a ball joint,
 * two are a hinge.
 *
 * Molecules with bodies are numbered behind all others of the set, in the order of their first bodies; their bonds
 * stand in the arrays per bond in the order of the list, after those of earlier calls. All bonds of a molecule have to
 * be given in one call. The verbs treat them as other molecules: they give multipliers of bonds, velocities and
 * positions of all atoms, constraint forces G_i = m_i a_i - f_i (of a site -f_i), and the virial sum r_i (x) G_i. What
 * holds a body together has no multipliers of its own. hol_violation, hol_report and hol_error_location give -1 for the
 * bond where they mean the body. hol_metric, hol_inverse_create and hol_project_positions_along refuse such sets or
 * molecules: HOL_ERR_UNSUPPORTED.
 * @return HOL_OK; HOL_ERR_NULL; HOL_ERR_VALUE (sizes; a length; a body without mass, with mass at one point, with a
 *         fixed atom, or with a site that it cannot carry; a bond within a body of another length; a bond in no
 *         molecule with a body); HOL_ERR_INDEX; HOL_ERR_SHARED_ATOM (an atom twice in a body or in a molecule of an
 *         earlier call); HOL_ERR_NOT_FINITE (places); HOL_ERR_DEGENERATE (a bond given twice, more bonds than
 *         freedoms); HOL_ERR_MEMORY. On an error nothing is added. Not thread-safe on one handle. Since 0.2.
 */
HOL_API int hol_chains_add_rigid(hol_chains *chains, int64_t n_bodies, const int64_t *sizes, const int64_t *atoms,
                                 const double *places, int64_t n_bonds, const int64_t *pairs, const double *lengths);

/**
 * Adds the same bodies and bonds for n_molecules molecules of n_atoms consecutive atoms each, as
 * hol_chains_add_molecules does for bonds alone: a box of CO2 or of TIP4P in one call.
 * @param[in,out] chains
 * @param[in] n_molecules  >= 0
 * @param[in] n_atoms      >= 2, atoms from one molecule to the next
 * @param[in] first_atom   number of the first atom of the first molecule
 * @param[in] n_bodies     >= 0, bodies of one molecule
 * @param[in] sizes        [n_bodies]
 * @param[in] atoms        [sum of sizes], numbers within the molecule, counted from the index base
 * @param[in] places       [sum of sizes][3], the same for every molecule
 * @param[in] n_bonds      >= 0, bonds of one molecule
 * @param[in] pairs        [n_bonds][2], numbers within the molecule; or NULL if n_bonds is 0
 * @param[in] lengths      [n_bonds]; or NULL if n_bonds is 0
 * @return as hol_chains_add_rigid. Since 0.2.
 */
HOL_API int hol_chains_add_rigid_molecules(hol_chains *chains, int64_t n_molecules, int64_t n_atoms, int64_t first_atom,
                                           int64_t n_bodies, const int64_t *sizes, const int64_t *atoms,
                                           const double *places, int64_t n_bonds, const int64_t *pairs,
                                           const double *lengths);

/**
 * Finds two to four equal mass points that have the mass, the centre and the moments of inertia of a rigid body (an
 * equimomental system). With them hol_chains_add_rigid takes a body that is given by its inertia tensor: the points are
 * atoms of these masses, and all that the body carries are massless sites, atoms of mass 0 with places in the same
 * frame. docs/rigid.md.
 * @param[in]  mass      of the body, > 0
 * @param[in]  centre    [3], its centre of mass, in the frame of the places; NULL: the origin
 * @param[in]  inertia   [3][3], sum m (x.x 1 - x x^T) about the centre: symmetric to 1e-10, moments on the diagonal,
 *                       products with the minus sign beside it. One principal moment may be 0 (a linear body), and one
 *                       the sum of the others (a flat one)
 * @param[out] n_points  2 for a linear body, 3 for a flat one, otherwise 4
 * @param[out] masses    [4], of which n_points are written: mass / n_points each
 * @param[out] places    [4][3], likewise (Fortran: (3, 4))
 *
 * The points have the moments of the tensor to rounding. If the largest moment is above the sum of the others by no
 * more than 1e-5 of it, as decimals of a file may leave it, the body is taken as flat, or linear.
 * @return HOL_OK; HOL_ERR_NULL; HOL_ERR_VALUE: the mass; numbers that are not finite; a tensor that is not symmetric,
 *         is 0, has a negative moment, or one above the sum of the others, which no distribution of mass has. On an
 *         error nothing is written. Thread-safe. Since 0.3.
 */
HOL_API int hol_equimomental_points(double mass, const double *centre, const double *inertia, int64_t *n_points,
                                    double *masses, double *places);

/**
 * Adds linear relations among atoms, sum_i c_i r_i = 0 with constant c_i, and the bonds of their molecules. Examples: a
 * site by its base and coefficients (r_s = a r_1 + b r_2 + ..); atoms that are one point (1, -1); centroids and centres
 * of mass of flexible groups that coincide. A relation is three equations whose coefficients do not depend on the
 * coordinates: the library takes away all that it forbids of motions, forces and velocities, to rounding.
 * docs/rigid.md.
 * @param[in,out] chains
 * @param[in] n_relations   >= 1
 * @param[in] sizes         [n_relations], how many atoms each has, >= 2
 * @param[in] atoms         [sum of sizes], the atoms of one relation after the other. An atom of mass 0 is a massless
 *                          site, as in a body; one of infinite mass is held where the caller has it. To drive a centre
 *                          of mass, relate it to such a fixed atom, move the atom between r_ref and r, and give its
 *                          velocity in v. A fixed atom has no acceleration
 * @param[in] coefficients  [sum of sizes]; those of a relation add up to 0, so that nothing depends on the origin
 * @param[in] n_bonds       >= 0; 0: relations alone
 * @param[in] pairs         [n_bonds][2], bonds of the molecules that the relations make, or NULL
 * @param[in] lengths       [n_bonds], as in hol_chains_add, or NULL. Copied.
 *
 * Relations that share atoms are of one molecule. All relations and bonds of a molecule have to be given in one call.
 * Periodic images are taken along the bonds and, where there are none, from each atom of a relation to the next.
 * Molecules with relations are numbered and treated as those with bodies (hol_chains_add_rigid): G is the whole
 * constraint force, but only bonds have multipliers. Each relation takes three degrees of freedom. The work grows with
 * the third power of the atoms of a molecule that hang together by relations.
 * @return HOL_OK; HOL_ERR_NULL; HOL_ERR_VALUE (sizes, coefficients, a relation that follows from the others, masses of
 *         0 whose places do not follow from others, a length, a bond in no molecule with a relation); HOL_ERR_INDEX;
 *         HOL_ERR_SHARED_ATOM (an atom of an earlier call); HOL_ERR_DEGENERATE; HOL_ERR_MEMORY. On an error nothing is
 *         added. Not thread-safe on one handle. Since 0.3.
 */
HOL_API int hol_chains_add_linear(hol_chains *chains, int64_t n_relations, const int64_t *sizes, const int64_t *atoms,
                                  const double *coefficients, int64_t n_bonds, const int64_t *pairs,
                                  const double *lengths);

/**
 * Adds the same relations and bonds for n_molecules molecules of n_atoms consecutive atoms each, as
 * hol_chains_add_molecules does.
 * @param[in,out] chains
 * @param[in] n_molecules   >= 0
 * @param[in] n_atoms       >= 2, atoms from one molecule to the next; some may be in no relation and have no bond
 * @param[in] first_atom    the first atom of the first molecule
 * @param[in] n_relations   >= 1, relations of one molecule
 * @param[in] sizes         [n_relations]
 * @param[in] atoms         [sum of sizes], counted from the index base (hol_chains_set_index_base) within the molecule
 * @param[in] coefficients  [sum of sizes]
 * @param[in] n_bonds       >= 0
 * @param[in] pairs         [n_bonds][2], counted likewise, or NULL
 * @param[in] lengths       [n_bonds], or NULL
 * @return as hol_chains_add_linear. Since 0.3.
 */
HOL_API int hol_chains_add_linear_molecules(hol_chains *chains, int64_t n_molecules, int64_t n_atoms,
                                            int64_t first_atom, int64_t n_relations, const int64_t *sizes,
                                            const int64_t *atoms, const double *coefficients, int64_t n_bonds,
                                            const int64_t *pairs, const double *lengths);

/**
 * Adds bonds whose periodic images the caller gives, in place of the nearest ones: for a bond of more than half the box
 * (a reaction coordinate in a small cell), or one that goes round it. The vector of bond k, with the atoms i and j as
 * they are given, is
 *
 *     d = r_j - r_i + images[k][0] a + images[k][1] b + images[k][2] c
 *
 * with a, b, c the rows of the box as it was given to hol_chains_set_box (for the reference positions, the rows of
 * their own box).
 * @param[in,out] chains
 * @param[in]     n_bonds  >= 0
 * @param[in]     pairs    [n_bonds][2]
 * @param[in]     lengths  [n_bonds], as in hol_chains_add; the box may be narrower than twice that. Copied.
 * @param[in]     images   [n_bonds][3], in numbers of box vectors; all 0: as the atoms stand (Fortran: (3, n_bonds)).
 *                         Copied.
 *
 * All bonds of these molecules are such bonds. Images are ignored without a box, and along a row of zeros. A program
 * that moves atoms by box vectors between two calls says so by hol_chains_set_images; within a position step r_ref and
 * r have the same images. Distances that depend on each other become no bodies here: the calls that meet them report
 * them. These molecules are numbered and treated as those with bodies (hol_chains_add_rigid), and take some 1 to 6
 * microseconds for each few bonds. hol_inverse_create and hol_project_positions_along refuse such molecules
 * (HOL_ERR_UNSUPPORTED). A bond between two fixed atoms is in no equation, and its images are not kept.
 * @return as hol_chains_add_bonds; HOL_ERR_VALUE also for images beyond 2^31. On an error nothing is added. Since 0.3.
 */
HOL_API int hol_chains_add_bonds_with_images(hol_chains *chains, int64_t n_bonds, const int64_t *pairs,
                                             const double *lengths, const int64_t *images);

/**
 * New images of bonds that hol_chains_add_bonds_with_images has added.
 * @param[in,out] chains
 * @param[in]     images  [n_bonds][3], of all bonds of the set; 0 for those whose images are the nearest ones. Copied.
 * @return HOL_OK; HOL_ERR_NULL; HOL_ERR_VALUE (images that are not 0 for a bond that was added without: the message
 *         names it). On an error nothing is changed. Not thread-safe on one handle. O(n_bonds). Since 0.3.
 */
HOL_API int hol_chains_set_images(hol_chains *chains, const int64_t *images);

/**
 * The images of bonds that were told.
 * @param[in]  chains
 * @param[out] images  [n_bonds][3]; 0 for bonds that were added without (Fortran: (3, n_bonds))
 * @return HOL_OK; HOL_ERR_NULL. O(n_bonds). Since 0.3.
 */
HOL_API int hol_chains_images(const hol_chains *chains, int64_t *images);

/**
 * New lengths for all bonds, without building the set again.
 * @param[in,out] chains
 * @param[in] lengths  [n_bonds], 1e-150 .. 1e150. Copied.
 * @return HOL_OK; HOL_ERR_NULL; HOL_ERR_VALUE (a length, lengths of a triangle or ring that can't close, or one of more
 *         than half the box: the message names the bond); HOL_ERR_MEMORY. On an error nothing is changed. Not
 *         thread-safe on one handle. O(n_bonds): 4 to 34 ns per bond. Since 0.2.
 */
HOL_API int hol_chains_set_lengths(hol_chains *chains, const double *lengths);

/**
 * A new length for one bond.
 * @param[in,out] chains
 * @param[in] bond    its number in the arrays per bond
 * @param[in] length  1e-150 .. 1e150
 * @return as hol_chains_set_lengths; HOL_ERR_INDEX. It costs what that does. Since 0.3.
 */
HOL_API int hol_chains_set_length(hol_chains *chains, int64_t bond, double length);

/**
 * New masses for all atoms, without building the set again.
 * @param[in,out] chains
 * @param[in] masses  [n_atoms], as in hol_chains_create. An atom of a molecule stays fixed if it was, and movable if it
 *                    was: fixed atoms decide what the molecules are.
 * @return HOL_OK; HOL_ERR_NULL; HOL_ERR_VALUE (a mass: the message names the atom); HOL_ERR_MEMORY. On an error
 *         nothing is changed. Not thread-safe on one handle. O(n_atoms). Since 0.2.
 */
HOL_API int hol_chains_set_masses(hol_chains *chains, const double *masses);

/**
 * Counts atoms, bonds and molecules from `base`, 0 (default) or 1, in the lists that are given (hol_chains_add..), in
 * every number that the library returns and in its messages. For callers whose index lists come from Fortran. Call it
 * before the first molecule is added, so that numbers keep their meaning.
 * @return HOL_OK; HOL_ERR_NULL; HOL_ERR_VALUE; HOL_ERR_STATE (molecules have been added). Since 0.1.
 */
HOL_API int hol_chains_set_index_base(hol_chains *chains, int base);

/** Which rigid bodies a set has. Values are never changed nor reused. Since 0.3. */
typedef enum hol_bodies HOL_IS_INT {
    HOL_BODIES_FOUND = 0, /**< also those of distances that depend on each other (hol_chains_add_bonds; default) */
    HOL_BODIES_GIVEN = 1  /**< only those of hol_chains_add_rigid; such distances are HOL_ERR_DEGENERATE */
} hol_bodies;

/**
 * Whether distances that depend on each other become rigid bodies, from the next call that adds molecules on. Some
 * programs cannot use such bodies: they read a multiplier for each bond, or call hol_metric, hol_inverse_create or
 * hol_project_positions_along, which know no bodies. With HOL_BODIES_GIVEN such distances are refused at once.
 * hol_chains_roles tells what became of each bond.
 * @param[in,out] chains
 * @param[in]     which
 * @return HOL_OK; HOL_ERR_NULL; HOL_ERR_VALUE. Not thread-safe on one handle. Since 0.3.
 */
HOL_API int hol_chains_set_bodies(hol_chains *chains, hol_bodies which);

/**
 * Periodic box: bond vectors are taken as the minimum image. The default is none.
 * @param[in,out] chains
 * @param[in] box  [3][3], row i is box vector i, length. Three sides stand on the diagonal: {a,0,0, 0,b,0, 0,0,c}. A
 *                 row of zeros: not periodic along that axis, in which no other vector may have a component. NULL: none
 *
 * Any three vectors that span the lattice are the same box (since 0.2), also rows that are not reduced, as a tilt of
 * many sides ("flip no" of LAMMPS): images are taken in a cell that is as wide as the lattice has one. The image is the
 * right one for bonds shorter than half the smallest distance between opposite faces of that cell; molecules may be
 * larger, and their cycles may go round the box (networks, zeolites). A network that goes round the box has 3 n - 3
 * freedoms for its bonds, not 3 n - 6. If it has more than 3 n - 6 bonds, set the box before you add it. The box may be
 * set again before every call; that takes no time. An orthorhombic box (zeros beside the diagonal) makes calls up to
 * 1.6 times as long, any other 1.1 to 1.9 times. Programs whose molecules are whole need none.
 * @return HOL_OK; HOL_ERR_NULL (chains); HOL_ERR_VALUE (not finite, or no cell; since 0.2 that cell is narrower than
 *         twice the longest bond). On an error nothing is changed. Not thread-safe on one handle. Since 0.1.
 */
HOL_API int hol_chains_set_box(hol_chains *chains, const double *box);

/**
 * Box of the reference positions of hol_project_positions, where it is not the box of the positions: for barostats that
 * deform the cell between the two.
 * @param[in,out] chains
 * @param[in] box  as in hol_chains_set_box; NULL (default): that of hol_chains_set_box, also when it is set later
 * @return as hol_chains_set_box. It costs what that does. Since 0.2.
 */
HOL_API int hol_chains_set_reference_box(hol_chains *chains, const double *box);

/**
 * Rate at which the box changes, d(box)/dt = L box, and the atoms with it: r' = v + L r, where v is the velocity of the
 * program (barostats in the equations of motion, SLLOD, shear). The default is none.
 * @param[in,out] chains
 * @param[in] L  [3][3], 1/time: (L x)_a = sum_b L_ab x_b, row after row (Fortran: L(b,a), columns are rows here); NULL
 *               or zeros: none. Copied.
 *
 * A bond of vector d then has the relative velocity u = v_j - v_i + L d, with images of d as the box has them:
 * hol_project_velocities makes d.u zero, hol_violation measures d.u, and hol_forces has |u|^2 in place of
 * |v_j - v_i|^2, f being all that accelerates the positions (docs/integrators.md). Nothing else depends on it. Take L
 * at the instant of the velocities; it may be set again before every call. A box set in the handle is not needed. It
 * makes velocities up to 1.2 times as long, forces 2 to 5 times.
 * @return HOL_OK; HOL_ERR_NULL (chains); HOL_ERR_VALUE (not finite). On an error nothing is changed. Not thread-safe on
 *         one handle. Since 0.2.
 */
HOL_API int hol_chains_set_box_rate(hol_chains *chains, const double *L);

/**
 * Numbers by which the caller knows atoms and molecules, such as the tags of a program that moves atoms between
 * processes. Messages show them beside the library's own numbers, "atom 17 (label 90210)"; a molecule without a label
 * of its own is shown with one of its atoms. They may be any numbers, and cost memory alone.
 * @param[in,out] chains
 * @param[in] atoms      [n_atoms], or NULL: none (default). Copied.
 * @param[in] molecules  [n_molecules], or NULL: none (default). Copied. Molecules that are added later have none.
 * @return HOL_OK; HOL_ERR_NULL (chains); HOL_ERR_MEMORY. On an error nothing is changed. Not thread-safe on one handle.
 *         Since 0.2.
 */
HOL_API int hol_chains_set_labels(hol_chains *chains, const int64_t *atoms, const int64_t *molecules);

/** When positions are compared with the lengths of the bonds. Values are never changed nor reused. Since 0.2. */
typedef enum hol_when HOL_IS_INT {
    HOL_NEVER = 0,    /**< not at all: crude positions are projected whatever they are like */
    HOL_AT_START = 1, /**< in the first call at the position level, and in the first after a change (default) */
    HOL_ALWAYS = 2    /**< in every such call: to find the step at which something goes wrong */
} hol_when;

/**
 * When hol_project_positions compares positions with the lengths. Positions with a wrong unit, order or numbering, a
 * molecule that a face of the cell cuts, a box that is forgotten or stale: the equations still have solutions, and
 * Newton's method would find them, with atoms moved by half the cell. With HOL_AT_START (default)
 *
 * - the first call compares the reference. It moves nothing and returns HOL_ERR_LENGTHS if a bond is off by more than a
 *   tenth of its length or longer than half the box, or if bonds across faces of the box are off by more than 1e-3 of
 *   their length and by three times as much as any inside (a box that is a hundredth off does that). If the reference
 *   fits, but a bond of the positions to be projected is more than 5 times as long as it should be, it moves nothing
 *   and returns HOL_ERR_NO_CONVERGENCE. The same is done in the first call after new molecules, after
 *   hol_chains_set_active, after lengths of more than 1.5 times or less than two thirds of those before, and after a
 *   box that differs by more than 2 per cent. It costs one pass over the bonds, once.
 * - in every later call a molecule with a bond of more than 5 times its length in the positions to be projected is bad
 *   (HOL_ERR_NO_CONVERGENCE, as any step that is too long): it is left as it is, all others are complete. That costs
 *   under 2 per cent of the call.
 *
 * HOL_ALWAYS makes calls 1.6 to 2 times as long, of every shape.
 *
 * The message names the worst bond, its atoms, its length and the length wanted, whether a box is set, and the likely
 * causes: for a reference its unit, order or box; for positions whose reference fits, the forces or the time step. For
 * a crude start (a model built by hand, but not a file with two decimals) call hol_impose once (docs/recipes.md).
 *
 * @param[in,out] chains
 * @param[in]     when    an hol_when
 * @return HOL_OK; HOL_ERR_NULL; HOL_ERR_VALUE. Not thread-safe on one handle. Since 0.2.
 */
HOL_API int hol_chains_set_checks(hol_chains *chains, hol_when when);

/** Which box positions belong to. */
typedef enum hol_which_box HOL_IS_INT { HOL_BOX = 0, HOL_REFERENCE_BOX = 1 } hol_which_box;

/**
 * Compares positions with the lengths now, whatever hol_chains_set_checks says, as the first call of
 * hol_project_positions does with its reference. For programs that use forces or velocities alone, which take bond
 * vectors as they are.
 * @param[in] chains
 * @param[in] r    positions [n_atoms][3]
 * @param[in] box  HOL_BOX or HOL_REFERENCE_BOX: the box that they belong to
 * @return HOL_OK: no bond of an active molecule is off by more than a tenth of its length, or longer than half the box;
 *         HOL_ERR_LENGTHS: some are, and message and hol_error_location name the worst; HOL_ERR_NULL; HOL_ERR_VALUE
 *         (box); HOL_ERR_NOT_FINITE. Thread-safe on one handle. O(n_bonds). Since 0.2.
 */
HOL_API int hol_chains_check(const hol_chains *chains, const double *r, hol_which_box box);

/**
 * Number of threads that a call may use, >= 1. The default is 1. Without OpenMP at build time all calls use one.
 * Threads share pieces of 4000 bonds, whatever the molecules; a call with fewer than 4096 bonds per thread starts
 * fewer. One long chain is shared, too, and one large molecule. A call whose threads came late, because other programs
 * use their processors, makes the next ones use one thread for a while. Results do not depend on the number of threads.
 * @return HOL_OK; HOL_ERR_NULL; HOL_ERR_VALUE. Not thread-safe on one handle. Since 0.1.
 */
HOL_API int hol_chains_set_threads(hol_chains *chains, int n_threads);

/**
 * Whether calls keep a status and a number of iterations for each molecule, which hol_outcomes returns. By default they
 * keep none, and nothing is spent on it.
 *
 * If they are kept, molecules go through the kernels one by one, not several side by side: results for molecules are
 * the same, sums over them (virial, energy) may differ in the last digits, and calls with many small molecules take
 * several times as long. So set it to search for a fault, or after a call has failed: a failed call leaves bad
 * molecules as they were, and the same call made again names all of them. It takes 8 bytes per molecule and thread.
 * @param[in,out] chains
 * @param[in]     keep    0 or 1
 * @return HOL_OK; HOL_ERR_NULL; HOL_ERR_VALUE. Not thread-safe on one handle. Since 0.2.
 */
HOL_API int hol_chains_set_outcomes(hol_chains *chains, int keep);

/**
 * The outcome of each molecule in the calling thread's last call with this handle of hol_forces, hol_solve,
 * hol_project_velocities, hol_project_positions, hol_project_positions_along, hol_metric or hol_impose.
 * hol_error_location names the first bad molecule; this names all, and why each is bad. Outcomes are kept only while
 * hol_chains_set_outcomes says so.
 * @param[in]  chains
 * @param[out] status      [n_molecules] an hol_status each: HOL_OK, or the status that the call would have returned if
 *                         this were the only bad molecule. Or NULL
 * @param[out] iterations  [n_molecules] for positions: how many linear solves the molecule took (hol_impose: steps); 0
 *                         if it obeyed the tolerance. For forces, velocities and given right-hand sides: rounds of the
 *                         iteration of a network (docs/molecules.md); 0 for all other molecules, which are solved
 *                         directly. For a bad molecule: the number as far as it is known, or 0. Or NULL
 *
 * An inactive molecule has HOL_OK and 0. Where positions or forces were refused before anything was done
 * (in the first step, hol_chains_set_checks), all molecules that do not fit have that status.
 * @return HOL_OK; HOL_ERR_NULL (chains); HOL_ERR_STATE: the thread has made no such call since, it ended by a wrong
 *         argument or by HOL_ERR_MEMORY, molecules have been added after it, or this thread has called with another
 *         handle that keeps outcomes. Thread-safe on one handle. Since 0.2.
 */
HOL_API int hol_outcomes(const hol_chains *chains, int *status, int *iterations);

/**
 * Leaves molecules out: the data of an inactive molecule are neither read nor written, and it counts in no sum.
 * @param[in,out] chains
 * @param[in] active  [n_molecules], 0 = inactive, anything else = active; copied. NULL: all active (default). Molecules
 *                    added later are active. Half of them inactive: 0.5 to 0.8 of the time.
 * @return HOL_OK; HOL_ERR_NULL (chains); HOL_ERR_MEMORY. Not thread-safe on one handle. Since 0.1.
 */
HOL_API int hol_chains_set_active(hol_chains *chains, const unsigned char *active);

/**
 * Tolerance of hol_project_positions: a molecule is done when |d.d - a^2| / a^2 <= tolerance for each of its bonds.
 * @param[in,out] chains
 * @param[in] tolerance  > 0 and < 1, or 0 for the default: the rounding of the molecule's largest coordinate in the
 *                       element type of the caller's positions. A tolerance that is smaller than this rounding means
 *                       the default. A loose one lets the energy drift, and saves little: 1e-8 saves a fifth of the
 *                       time of chains, trees and rings, two fifths of that of frames of triangles, and nothing of
 *                       water and of atoms with three others, which are solved to the rounding at once (docs/recipes.md
 *                       has a table). A molecule that is within the tolerance already is left where it is.
 * @return HOL_OK; HOL_ERR_NULL; HOL_ERR_VALUE. Not thread-safe on one handle. Since 0.1.
 */
HOL_API int hol_chains_set_tolerance(hol_chains *chains, double tolerance);

/**
 * Bound on the iterations of hol_project_positions for a molecule of any shape, 1..1000. The default is 50; a
 * well-posed step needs 2 to 5. A molecule that needs more iterations is HOL_ERR_NO_CONVERGENCE; a smaller bound makes
 * no step faster that converges. A root that is followed from the reference (hol_project_positions) is looked at in up
 * to four times as many points of its path; with a bound below 20 no root is followed.
 * @return HOL_OK; HOL_ERR_NULL; HOL_ERR_VALUE. Not thread-safe on one handle. Since 0.1.
 */
HOL_API int hol_chains_set_max_iterations(hol_chains *chains, int max_iterations);

/** Number of atoms, molecules and bonds; 0 if chains is NULL. Since 0.1. */
HOL_API int64_t hol_chains_n_atoms(const hol_chains *chains);
HOL_API int64_t hol_chains_n_molecules(const hol_chains *chains);
HOL_API int64_t hol_chains_n_bonds(const hol_chains *chains);

/** What the bonds of a molecule look like, fixed atoms being ends. Values are never changed nor reused. Since 0.2. */
typedef enum hol_shape HOL_IS_INT {
    HOL_SHAPE_CHAIN = 0,    /**< linear */
    HOL_SHAPE_TREE = 1,     /**< branched, without a cycle */
    HOL_SHAPE_RING = 2,     /**< one cycle of at least four bonds and nothing else */
    HOL_SHAPE_TRIANGLE = 3, /**< three atoms and their three distances */
    HOL_SHAPE_OTHER = 4,    /**< anything else that has a cycle */
    HOL_SHAPE_RIGID = 5     /**< with rigid bodies, linear relations or images that are told */
} hol_shape;

/** Number of molecules of an hol_shape; 0 if chains is NULL or for any other number. O(n_molecules). Since 0.2. */
HOL_API int64_t hol_chains_n_of_shape(const hol_chains *chains, hol_shape shape);

/** Number of different kinds of molecules (shape, masses and lengths); 0 if chains is NULL. Since 0.2. */
HOL_API int64_t hol_chains_n_kinds(const hol_chains *chains);

/**
 * Shape and size of one molecule. Each output may be NULL.
 * @param[in] chains
 * @param[in]  molecule  its number
 * @param[out] shape     an hol_shape
 * @param[out] n_atoms   how many numbers hol_chains_atoms gives, at most n_bonds + 1
 * @param[out] n_bonds   how many numbers hol_chains_bonds gives
 * @return HOL_OK; HOL_ERR_NULL (chains); HOL_ERR_INDEX. Since 0.2.
 */
HOL_API int hol_chains_molecule(const hol_chains *chains, int64_t molecule, int *shape, int64_t *n_atoms,
                                int64_t *n_bonds);

/**
 * Atoms of one molecule: along a linear chain; ascending otherwise, each once.
 * @param[in] chains
 * @param[in]  molecule  its number
 * @param[out] atoms     [n_atoms of hol_chains_molecule], for a linear chain the number of its bonds + 1
 * @return HOL_OK; HOL_ERR_NULL; HOL_ERR_INDEX. Since 0.1.
 */
HOL_API int hol_chains_atoms(const hol_chains *chains, int64_t molecule, int64_t *atoms);

/**
 * Bonds of one molecule, in the order in which they are counted within it: hol_error_location, hol_report, hol_worst
 * and hol_inverse speak of bond k of the molecule, which is bond bonds[k] of the arrays per bond.
 * @param[in] chains
 * @param[in]  molecule  its number
 * @param[out] bonds     [n_bonds of hol_chains_molecule]
 * @return HOL_OK; HOL_ERR_NULL; HOL_ERR_INDEX. Since 0.2.
 */
HOL_API int hol_chains_bonds(const hol_chains *chains, int64_t molecule, int64_t *bonds);

/**
 * The molecule of every bond.
 * @param[in] chains
 * @param[out] molecules  [n_bonds]; -1 (whatever the index base) for a bond between two fixed atoms
 * @return HOL_OK; HOL_ERR_NULL. O(n_bonds). Since 0.2.
 */
HOL_API int hol_chains_molecules_of_bonds(const hol_chains *chains, int64_t *molecules);

/**
 * The two atoms of every bond: the first and the second as they were given, or, in molecules with rigid bodies, the
 * lower and the higher one.
 * @param[in]  chains
 * @param[out] pairs  [n_bonds][2] (Fortran: (2, n_bonds))
 * @return HOL_OK; HOL_ERR_NULL. O(n_bonds). Since 0.3.
 */
HOL_API int hol_chains_pairs(const hol_chains *chains, int64_t *pairs);

/**
 * The length of every bond.
 * @param[in]  chains
 * @param[out] lengths  [n_bonds]
 * @return HOL_OK; HOL_ERR_NULL. O(n_bonds). Since 0.3.
 */
HOL_API int hol_chains_lengths(const hol_chains *chains, double *lengths);

/**
 * The mass of every atom, as it was given.
 * @param[in]  chains
 * @param[out] masses  [n_atoms]
 * @return HOL_OK; HOL_ERR_NULL. O(n_atoms). Since 0.3.
 */
HOL_API int hol_chains_masses(const hol_chains *chains, double *masses);

/**
 * A box, as it was given.
 * @param[in]  chains
 * @param[in]  which  HOL_BOX; or HOL_REFERENCE_BOX: the box of the reference, which is HOL_BOX if no other was set
 * @param[out] box    [3][3], zeros if there is none
 * @return HOL_OK; HOL_ERR_NULL; HOL_ERR_VALUE (which). Since 0.3.
 */
HOL_API int hol_chains_box(const hol_chains *chains, hol_which_box which, double *box);

/**
 * Settings, as they were set or by default: the index base; hol_bodies; hol_when; threads; whether outcomes are kept (1
 * or 0); the two tolerances and the two bounds (0: the default). All are 0 if chains is NULL. Since 0.3.
 */
HOL_API int hol_chains_index_base(const hol_chains *chains);
HOL_API int hol_chains_bodies(const hol_chains *chains);
HOL_API int hol_chains_checks(const hol_chains *chains);
HOL_API int hol_chains_threads(const hol_chains *chains);
HOL_API int hol_chains_outcomes(const hol_chains *chains);
HOL_API double hol_chains_tolerance(const hol_chains *chains);
HOL_API double hol_chains_length_tolerance(const hol_chains *chains);
HOL_API int hol_chains_max_iterations(const hol_chains *chains);
HOL_API int64_t hol_chains_memory_limit(const hol_chains *chains);

/**
 * The rate of the box that was set.
 * @param[in]  chains
 * @param[out] L  [3][3], zeros if there is none
 * @return HOL_OK; HOL_ERR_NULL. Since 0.3.
 */
HOL_API int hol_chains_box_rate(const hol_chains *chains, double *L);

/**
 * Which molecules are active.
 * @param[in]  chains
 * @param[out] active  [n_molecules], 1 or 0
 * @return HOL_OK; HOL_ERR_NULL. Since 0.3.
 */
HOL_API int hol_chains_active(const hol_chains *chains, unsigned char *active);

/**
 * The labels that were set. An atom or molecule without a label has its number, counted from the index base. Each
 * output may be NULL.
 * @param[in]  chains
 * @param[out] atoms      [n_atoms]
 * @param[out] molecules  [n_molecules]
 * @return HOL_OK; HOL_ERR_NULL (chains). Since 0.3.
 */
HOL_API int hol_chains_labels(const hol_chains *chains, int64_t *atoms, int64_t *molecules);

/** What became of a bond that was given. Values are never changed nor reused. Since 0.3. */
typedef enum hol_role HOL_IS_INT {
    HOL_ROLE_OWN = 0,     /**< a constraint with a multiplier of its own */
    HOL_ROLE_BODY = 1,    /**< between two atoms of a rigid body, which holds it (hol_chains_add_bonds) */
    HOL_ROLE_IMPLIED = 2, /**< a consequence of other constraints. No bond has it in this release */
    HOL_ROLE_FIXED = 3    /**< between two fixed atoms: no constraint */
} hol_role;

/**
 * What became of every bond, and how many freedoms each molecule's constraints take from its atoms. Each output may be
 * NULL.
 * @param[in]  chains
 * @param[out] roles    [n_bonds], an hol_role each
 * @param[out] removed  [n_molecules], in three dimensions; a body of n atoms that have mass removes 3 n - 6 (on a line
 *                      3 n - 5). Inactive molecules too
 * @return HOL_OK; HOL_ERR_NULL (chains). O(n_bonds). Since 0.3.
 */
HOL_API int hol_chains_roles(const hol_chains *chains, int *roles, int64_t *removed);

/**
 * Where each molecule's bonds stand in the arrays per bond, if the bonds of one molecule follow those of the one
 * before. They do if all bonds came by hol_chains_add and hol_chains_add_block, and none of them is between fixed
 * atoms. hol_chains_bonds tells it in all cases.
 * @param[in] chains
 * @param[out] offsets  [n_molecules+1]: molecule m has the bonds offsets[m] .. offsets[m+1]-1; counted from the index
 *                      base. The order within a molecule is that of hol_chains_bonds
 * @return HOL_OK; HOL_ERR_NULL; HOL_ERR_VALUE (the bonds stand in another order; the message names the first such
 *         molecule; nothing is written). Since 0.1.
 */
HOL_API int hol_chains_offsets(const hol_chains *chains, int64_t *offsets);

/**
 * Degrees of freedom of all n_atoms atoms: dimensions times the number of atoms that can move, less one for each bond
 * of an active molecule; a rigid body has six, a linear one five, three in two dimensions. A conserved total momentum
 * is not subtracted.
 * @param[in] chains
 * @param[in] dimensions  3, or 2 for views without z
 * @return the number; -1 if chains is NULL or dimensions is neither. Since 0.1.
 */
HOL_API int64_t hol_chains_degrees_of_freedom(const hol_chains *chains, int dimensions);

/** Memory that the handle occupies, in bytes; 0 if chains is NULL. Since 0.1. */
HOL_API int64_t hol_chains_memory(const hol_chains *chains);

/**
 * How far the library has adjusted the lengths of distances that depend on each other (hol_chains_add_bonds): no places
 * in space have quite the lengths that a file gives with few decimals.
 * @param[in]  chains
 * @param[out] largest  largest change of a length, as a part of that length; 0 if none was changed
 * @param[out] bond     the bond with this change, or NULL; -1 if no length was changed. hol_chains_molecules_of_bonds
 *                      tells its molecule
 * @return HOL_OK; HOL_ERR_NULL (chains or largest). Since 0.3.
 */
HOL_API int hol_chains_adjustment(const hol_chains *chains, double *largest, int64_t *bond);

/**
 * Which distances follow from others (hol_chains_add_bonds): they are in no equation, and their multipliers are 0.
 * @param[in]  chains
 * @param[out] implied  [n_bonds], 1 or 0
 * @return HOL_OK; HOL_ERR_NULL. Since 0.3.
 */
HOL_API int hol_chains_implied(const hol_chains *chains, unsigned char *implied);

/**
 * Atoms of mass 0 that bonds tie to something rigid: to a body, or to an atom of a triangle of bonds. Each of them is
 * held in space, and so is its molecule. If a massless site was meant, as M of TIP4P, add it as an atom of a body
 * (hol_chains_add_rigid). Ask once after adding. A molecule may be tethered so on purpose; an atom of infinite mass
 * (hol_chains_create) is held on purpose, and is never named.
 * @param[in]  chains
 * @param[out] held  [n_atoms], 1 or 0
 * @return HOL_OK; HOL_ERR_NULL; HOL_ERR_MEMORY. O(n_atoms + n_bonds). Since 0.3.
 */
HOL_API int hol_chains_held_sites(const hol_chains *chains, unsigned char *held);

/**
 * How far the library may adjust the lengths of distances that depend on each other, as a part of each length, so that
 * places in space have these lengths. Lengths that need more are refused when they are added. It holds for what is
 * added later.
 * @param[in,out] chains
 * @param[in]     tolerance  0 .. 0.01; 1e-3 until it is set, 0: lengths must be right to rounding
 * @return HOL_OK; HOL_ERR_NULL; HOL_ERR_VALUE. Not thread-safe on one handle. Since 0.3.
 */
HOL_API int hol_chains_set_length_tolerance(hol_chains *chains, double tolerance);

/**
 * Bound on the memory that a set of molecules takes. The elimination of a molecule with many cycles (a lattice, a
 * sheet) fills its matrix. The call that adds the molecule counts this memory before it takes any. If it is more than
 * the bound, together with what the set has, the call returns HOL_ERR_MEMORY with both numbers in the message.
 * @param[in,out] chains
 * @param[in]     bytes  > 0, or 0 for the default: a quarter of the machine's memory. It holds for what is added later,
 *                       and for the scratch that calls need for it.
 * @return HOL_OK; HOL_ERR_NULL; HOL_ERR_VALUE. Not thread-safe on one handle. Since 0.2.
 */
HOL_API int hol_chains_set_memory_limit(hol_chains *chains, int64_t bytes);

/* --------------------------------------------------------------------------------------------------------- views */

/** Element type of a view. */
typedef enum hol_element HOL_IS_INT { HOL_DOUBLE = 0, HOL_FLOAT = 1 } hol_element;

/**
 * Where a vector per atom stands in the caller's memory: component x of atom i is the element at
 * (char *)x + i * stride, likewise y and z. Separate arrays, padded records, single precision, two dimensions.
 * Arithmetic is in double precision whatever the element type. Packed doubles cost least: other
 * layouts make calls 1.05 to 2.2 times as long, of water and groups XH3 up to 5 times.
 */
typedef struct hol_view {
    void *x, *y, *z;  /**< of atom 0; z == NULL: two dimensions, all z are zero (in every view of a call or in none) */
    int64_t stride;   /**< bytes from an atom to the next, a multiple of the element's size, not 0; may be negative */
    int32_t element;  /**< HOL_DOUBLE or HOL_FLOAT */
    int32_t reserved; /**< 0 */
} hol_view;

/** A view of an input, which is only read. Since 0.3. */
typedef struct hol_const_view {
    const void *x, *y, *z;
    int64_t stride;
    int32_t element;
    int32_t reserved;
} hol_const_view;

/** Views of packed doubles [n_atoms][3]. Since 0.3. */
static inline hol_view hol_view_rows(double *rows) {
    hol_view view = {rows, rows + 1, rows + 2, 3 * sizeof(double), HOL_DOUBLE, 0};
    return view;
}
static inline hol_const_view hol_const_view_rows(const double *rows) {
    hol_const_view view = {rows, rows + 1, rows + 2, 3 * sizeof(double), HOL_DOUBLE, 0};
    return view;
}

/** Views of three arrays [n_atoms]; z == NULL: two dimensions. Since 0.3. */
static inline hol_view hol_view_parts(double *x, double *y, double *z) {
    hol_view view = {x, y, z, sizeof(double), HOL_DOUBLE, 0};
    return view;
}
static inline hol_const_view hol_const_view_parts(const double *x, const double *y, const double *z) {
    hol_const_view view = {x, y, z, sizeof(double), HOL_DOUBLE, 0};
    return view;
}

/** An output as an input. Since 0.3. */
static inline hol_const_view hol_view_read(const hol_view *view) {
    hol_const_view read = {view->x, view->y, view->z, view->stride, view->element, view->reserved};
    return read;
}

/** hol_chains_check with positions of any layout. Since 0.2. */
HOL_API int hol_chains_check_view(const hol_chains *chains, const hol_const_view *r, hol_which_box box);

/* -------------------------------------------------------------------------------------------- acceleration level */

/** Whether an output per atom replaces what is there, or is added to it. */
typedef enum hol_mode HOL_IS_INT { HOL_WRITE = 0, HOL_ADD = 1 } hol_mode;

/**
 * Constraint forces that keep every bond's length constant at this instant.
 *
 * Finds the multipliers with which each bond obeys sigma'' = 0, that is
 *     d_k . (A_j - A_i) + |v_j - v_i|^2 = 0,   A_i = w_i (f_i + G_i),   bond k from atom i to atom j,
 * by one factorization per molecule, without iteration or tolerance. With hol_chains_set_box_rate v_j - v_i + L d_k
 * stands in place of v_j - v_i (since 0.2). docs/theory.md (5)-(12); Mazars 2007, Eqs. (6), (24).
 *
 * @param[in]  chains   which atoms are bonded
 * @param[in]  r        positions [n_atoms][3], length
 * @param[in]  v        velocities [n_atoms][3], or NULL: at rest
 * @param[in]  f        applied forces [n_atoms][3], or NULL: none
 * @param[out] lambda   multipliers [n_bonds], force/length, or NULL
 * @param[out] tension  T = 2 lambda |d| [n_bonds], force, > 0 under tension, or NULL
 * @param[out] g        constraint forces [n_atoms][3], force, or NULL. May be f itself
 * @param[in]  mode     HOL_WRITE: g = G for the atoms of the molecules; HOL_ADD: g = g + G
 * @param[out] virial   [3][3], energy, or NULL: sum_i r_i (x) G_i = - sum_k 2 lambda_k d_k (x) d_k over active ones
 * @return HOL_OK; HOL_ERR_NULL (chains or r); HOL_ERR_VALUE (mode); HOL_ERR_NOT_FINITE; HOL_ERR_DEGENERATE;
 *         HOL_ERR_MEMORY. Thread-safe on one handle. Since 0.1.
 */
HOL_API int hol_forces(const hol_chains *chains, const double *r, const double *v, const double *f, double *lambda,
                       double *tension, double *g, hol_mode mode, double *virial);

/** hol_forces with arrays per atom of any layout; views may be NULL as the arrays may. Since 0.1. */
HOL_API int hol_forces_view(const hol_chains *chains, const hol_const_view *r, const hol_const_view *v,
                            const hol_const_view *f, double *lambda, double *tension, const hol_view *g, hol_mode mode,
                            double *virial);

/**
 * Multipliers of given right-hand sides: solves
 *     Z lambda = rhs,   Z_kl = sum_i w_i grad_i sigma_k . grad_i sigma_l.
 * hol_forces solves the same equations with
 *     rhs_k = 2 d_k . (w_j f_j - w_i f_i) + 2 |v_j - v_i|^2.
 * With other right-hand sides the caller chooses sigma_k'': with forces f + G, sigma_k'' is its value without G, less
 * rhs_k. For terms that relax errors, prescribed rates, other thermostats.
 *
 * @param[in]     chains
 * @param[in]     r       positions [n_atoms][3]
 * @param[in]     rhs     [n_bonds]; not read for bonds between two fixed atoms
 * @param[out]    lambda  [n_bonds], or NULL; may be rhs itself
 * @param[in,out] g       G_i = - sum_k lambda_k grad_i sigma_k [n_atoms][3], or NULL
 * @param[in]     mode    HOL_WRITE or HOL_ADD, as in hol_forces
 * @param[out]    virial  [3][3], - sum_k 2 lambda_k d_k (x) d_k over active molecules, or NULL
 * @return HOL_OK; HOL_ERR_NULL (chains, r or rhs); HOL_ERR_VALUE (mode); HOL_ERR_NOT_FINITE; HOL_ERR_DEGENERATE;
 *         HOL_ERR_MEMORY. Thread-safe on one handle. Since 0.2.
 */
HOL_API int hol_solve(const hol_chains *chains, const double *r, const double *rhs, double *lambda, double *g,
                      hol_mode mode, double *virial);

/** hol_solve with arrays per atom of any layout. Since 0.2. */
HOL_API int hol_solve_view(const hol_chains *chains, const hol_const_view *r, const double *rhs, double *lambda,
                           const hol_view *g, hol_mode mode, double *virial);

/**
 * Factors of all molecules at one configuration, kept for any number of right-hand sides: force groups of several time
 * steps (r-RESPA), terms that relax errors, derivatives. A solve with them costs the two substitutions of hol_forces
 * and no elimination.
 */
typedef struct hol_factors hol_factors;

/**
 * Makes an object for the factors of a set, without any yet.
 * @param[in]  chains   has to live as long as the factors
 * @param[out] factors  the new object, to be given to hol_factors_destroy; NULL on an error
 * @return HOL_OK; HOL_ERR_NULL; HOL_ERR_MEMORY. Since 0.3.
 */
HOL_API int hol_factors_create(const hol_chains *chains, hol_factors **factors);

/** Frees the factors; NULL is allowed and does nothing. Since 0.3. */
HOL_API void hol_factors_destroy(hol_factors *factors);

/**
 * Makes the factors at these positions, in the box and with the rate of the box that the set has now. They hold for
 * these until the next update. An update costs about as much as hol_forces, allocates the first time and after a change
 * of the set, and keeps 5 to 20 doubles per bond and 4 per atom, more where cycles fill. So factors pay from about
 * three solves on.
 *
 * Factors are kept for chains, trees, rings and triangles, and for all molecules with cycles; forces of chains of more
 * than 256 bonds, and of trees of more than 2048, do not use them. Lattices gain most, gels of flexible strands least.
 * For all others only the positions are kept, and solves cost as much as hol_forces and hol_solve: rigid bodies, trees
 * with an atom of hundreds of bonds, molecules that need more than plain products, and all molecules of a set in which
 * molecules share fixed atoms. All results are as accurate as those of hol_forces and hol_solve.
 * @param[in,out] factors
 * @param[in]     r        positions [n_atoms][3]. Copied
 * @return HOL_OK; HOL_ERR_NULL; HOL_ERR_NOT_FINITE; HOL_ERR_DEGENERATE; HOL_ERR_MEMORY. After a bad molecule all others
 *         have their factors; solves then name it again. Not thread-safe on one object. Since 0.3.
 */
HOL_API int hol_factors_update(hol_factors *factors, const double *r);

/** hol_factors_update with positions of any layout. Since 0.3. */
HOL_API int hol_factors_update_view(hol_factors *factors, const hol_const_view *r);

/**
 * hol_forces at the positions of hol_factors_update.
 * @param[in]     factors
 * @param[in]     v        velocities [n_atoms][3], or NULL: at rest
 * @param[in]     f        applied forces [n_atoms][3], or NULL: none
 * @param[out]    lambda   multipliers [n_bonds], or NULL
 * @param[out]    tension  [n_bonds], or NULL
 * @param[in,out] g        constraint forces [n_atoms][3], or NULL. May be f itself
 * @param[in]     mode     HOL_WRITE or HOL_ADD
 * @param[out]    virial   [3][3], or NULL
 * @return as hol_forces; HOL_ERR_STATE (no update yet, or the set has been changed since). hol_outcomes knows nothing
 *         of this call. Thread-safe on one object. Since 0.3.
 */
HOL_API int hol_factors_forces(const hol_factors *factors, const double *v, const double *f, double *lambda,
                               double *tension, double *g, hol_mode mode, double *virial);

/** hol_factors_forces with arrays per atom of any layout. Since 0.3. */
HOL_API int hol_factors_forces_view(const hol_factors *factors, const hol_const_view *v, const hol_const_view *f,
                                    double *lambda, double *tension, const hol_view *g, hol_mode mode, double *virial);

/**
 * hol_solve at the positions of hol_factors_update, for several right-hand sides.
 * @param[in]     factors
 * @param[in]     n_rhs    >= 0
 * @param[in]     rhs      [n_rhs][n_bonds]
 * @param[out]    lambda   [n_rhs][n_bonds], or NULL; may be rhs itself
 * @param[in,out] g        [n_rhs][n_atoms][3], or NULL
 * @param[in]     mode     HOL_WRITE or HOL_ADD
 * @param[out]    virial   [n_rhs][3][3], or NULL
 * @return as hol_solve; HOL_ERR_VALUE (n_rhs, mode); HOL_ERR_STATE as hol_factors_forces. After a bad molecule in one
 *         right-hand side the following ones may not be solved for. Thread-safe on one object. Since 0.3.
 */
HOL_API int hol_factors_solve(const hol_factors *factors, int64_t n_rhs, const double *rhs, double *lambda, double *g,
                              hol_mode mode, double *virial);

/** hol_factors_solve with forces of any layout: g is [n_rhs] views. Since 0.3. */
HOL_API int hol_factors_solve_view(const hol_factors *factors, int64_t n_rhs, const double *rhs, double *lambda,
                                   const hol_view *g, hol_mode mode, double *virial);

/**
 * Forces or impulses on the atoms, tensions and virials of the bonds, for given multipliers: those that hol_forces,
 * hol_solve, hol_project_velocities or hol_project_positions found, or their means over steps.
 *
 * @param[in]     chains
 * @param[in]     r            positions [n_atoms][3] with which the multipliers were found: the r of that call; for
 *                             hol_project_positions its r_ref
 * @param[in]     box          HOL_BOX: r belongs to that of hol_chains_set_box; HOL_REFERENCE_BOX: to that of
 *                             hol_chains_set_reference_box, as r_ref does
 * @param[in]     lambda       [n_bonds]; not read for bonds between two fixed atoms
 * @param[out]    tension      2 lambda |d| [n_bonds], or NULL
 * @param[in,out] g            G_i = - sum_k lambda_k grad_i sigma_k [n_atoms][3], or NULL. With multipliers of
 *                             hol_forces it is the constraint force, with those of hol_project_velocities the impulse
 *                             m_i dv_i. With those of hol_project_positions it is the force over the step: times dt,
 *                             the impulse m_i dv_i; times dt^2 w_i, the displacement. Fixed atoms have it, too: it is
 *                             what their holder has to bear
 * @param[in]     mode         HOL_WRITE or HOL_ADD, as in hol_forces
 * @param[out]    bond_virial  [n_bonds][6] (Fortran: (6, n_bonds)), or NULL: xx xy xz yy yz zz of
 *                             - 2 lambda_k d_k (x) d_k. Their sum over bonds is the virial of the call that found
 *                             lambda; half of each at either atom is a virial per atom
 * @param[out]    virial       [3][3], their sum over active molecules, or NULL
 *
 * The multipliers of hol_project_velocities do not contain its last correction of rounding. So G agrees with m dv to
 * the rounding of v.
 * @return HOL_OK; HOL_ERR_NULL (chains, r or lambda); HOL_ERR_VALUE (box, mode); HOL_ERR_NOT_FINITE; HOL_ERR_MEMORY.
 *         Inactive molecules are neither read nor written. Thread-safe on one handle. O(n_bonds). Since 0.2.
 */
HOL_API int hol_reactions(const hol_chains *chains, const double *r, hol_which_box box, const double *lambda,
                          double *tension, double *g, hol_mode mode, double *bond_virial, double *virial);

/** hol_reactions with arrays per atom of any layout. Since 0.2. */
HOL_API int hol_reactions_view(const hol_chains *chains, const hol_const_view *r, hol_which_box box,
                               const double *lambda, double *tension, const hol_view *g, hol_mode mode,
                               double *bond_virial, double *virial);

/* ------------------------------------------------------------------------------------------------ velocity level */

/**
 * Projects velocities onto the constraints (the second half of RATTLE): after the call d_k . (v_j - v_i) = 0 for every
 * bond, or d_k . (v_j - v_i + L d_k) = 0 with hol_chains_set_box_rate (since 0.2). The change v_i += w_i G_i,
 * with G_i as above (hol_reactions gives it), is the one of least kinetic energy, and is found by one factorization.
 * docs/theory.md (13)-(14).
 *
 * @param[in]     chains
 * @param[in]     r       positions [n_atoms][3]
 * @param[in,out] v       velocities [n_atoms][3]
 * @param[out]    lambda  multipliers of the impulse [n_bonds], force time/length, or NULL:
 *                        m_i dv_i = - sum lambda grad sigma
 * @param[out]    virial  [3][3], energy time, or NULL: sum_i r_i (x) (m_i dv_i). Divide by the time over which the
 *                        impulse acts (docs/integrators.md).
 * @return HOL_OK; HOL_ERR_NULL (chains, r or v); HOL_ERR_NOT_FINITE; HOL_ERR_DEGENERATE; HOL_ERR_MEMORY.
 *         Thread-safe on one handle, each thread with velocities of its own. Since 0.1.
 */
HOL_API int hol_project_velocities(const hol_chains *chains, const double *r, double *v, double *lambda,
                                   double *virial);

/** hol_project_velocities with arrays per atom of any layout. Since 0.1. */
HOL_API int hol_project_velocities_view(const hol_chains *chains, const hol_const_view *r, const hol_view *v,
                                        double *lambda, double *virial);

/* ------------------------------------------------------------------------------------------------ position level */

/** What hol_project_positions did. */
typedef struct hol_report {
    int64_t iterations;  /**< largest number of linear solves that a molecule took */
    int64_t n_corrected; /**< molecules that were moved; the others already obeyed the tolerance */
    int64_t n_failed;    /**< molecules that were left as they were because they did not converge or had bad data */
    int64_t molecule;    /**< molecule with the largest error, of whatever shape; -1 if there is none */
    int64_t bond;        /**< its bond within the molecule */
    double max_error;    /**< largest |d.d - a^2| / a^2 left in a molecule that did not fail, before the positions are
                              rounded to the caller's element type. That of the reference: hol_reference_error */
} hol_report;

/**
 * Puts positions back on the constraints (SHAKE; the first half of RATTLE): finds G along the bonds of r_ref such that
 *     r_i + dt^2 w_i G_i,   G_i = - 2 sum_k s_ki lambda_k b_k,   b_k = r_ref,j - r_ref,i,
 * (s = +1 at atom j of bond k, -1 at atom i) has |d_k| = a_k for every bond, to the rounding of the coordinates, by
 * Newton's method with the exact Jacobian. docs/theory.md (15)-(19), docs/integrators.md.
 *
 * These equations are quadratic and may have several roots. The right one begins at the reference, where all lambda are
 * 0, and changes with r while r goes straight from r_ref to where it is. In ordinary steps Newton's method finds it. A
 * molecule is looked at alone if Newton's method fails, or if r has a bond with |d.d - a^2| > 0.15 a^2 (0.5 a^2 in a
 * linear chain): its root is tested, or followed from the reference. If the root ends before r, there is none
 * (HOL_ERR_NO_CONVERGENCE: halve the step), though the lengths might be reached by bonds that turn round.
 * docs/stability.md says what is guaranteed, and the cost.
 *
 * @param[in]     chains
 * @param[in]     r_ref   positions before the drift [n_atoms][3]; may be r itself (in Fortran: docs/fortran.md); long
 *                        chains and large trees then copy it first. Only differences within a molecule are used: each
 *                        molecule may stand anywhere, at an origin of its own
 * @param[in,out] r       positions after the drift [n_atoms][3]; in: unconstrained, out: constrained
 * @param[in,out] v       velocities [n_atoms][3], or NULL; v_i += dt w_i G_i, the displacement over dt. It is only
 *                        added to: its values are not checked, and a NaN stays a NaN
 * @param[in]     dt      time step, time, > 0 and finite
 * @param[in,out] lambda  multipliers [n_bonds], force/length, or NULL. The constraint force over a leap-frog step; half
 *                        of it for velocity Verlet, whose position update carries dt^2/2.
 * @param[in]     guess   0, or 1: lambda holds a first guess, the multipliers of the last step. It saves a solve in
 *                        steps that take four or more. In usual steps it costs more than it saves: the call takes 1.2
 *                        to 3 times as long. Coils of more than about 1000 bonds do not use it
 * @param[out]    virial  [3][3], energy, or NULL: sum_i r_ref,i (x) G_i = - sum_k 2 lambda_k b_k (x) b_k
 * @param[out]    report  or NULL; written whenever the arguments are valid, also if molecules fail
 * @return HOL_OK; HOL_ERR_NULL (chains, r_ref or r; lambda with guess = 1); HOL_ERR_VALUE (dt, guess);
 *         HOL_ERR_LENGTHS (hol_chains_set_checks); HOL_ERR_NOT_FINITE; HOL_ERR_DEGENERATE; HOL_ERR_NO_CONVERGENCE;
 *         HOL_ERR_MEMORY. A molecule already within the tolerance (hol_chains_set_tolerance) is not touched and has
 *         lambda = 0. A molecule that fails keeps r, v and lambda: r stays the trial, and r_ref is where to go on from.
 *         Thread-safe on one handle, each thread with arrays of its own. Since 0.1.
 */
HOL_API int hol_project_positions(const hol_chains *chains, const double *r_ref, double *r, double *v, double dt,
                                  double *lambda, int guess, double *virial, hol_report *report);

/** hol_project_positions with arrays per atom of any layout. Since 0.1. */
HOL_API int hol_project_positions_view(const hol_chains *chains, const hol_const_view *r_ref, const hol_view *r,
                                       const hol_view *v, double dt, double *lambda, int guess, double *virial,
                                       hol_report *report);

/**
 * hol_project_positions with bond vectors in place of reference positions, for programs that keep the bond vectors of
 * the beginning of a step: b_k = r_j - r_i, the nearest image, from the first atom of bond k to the second, as the bond
 * was given.
 *
 * @param[in]     chains
 * @param[in]     b        [n_bonds][3] (Fortran: (3, n_bonds)), in the order in which the bonds were given. Not read
 *                         for bonds between two fixed atoms. The reference box is used only for cycles that go round it
 * @param[in,out] r        this and all others as in hol_project_positions
 * @param[in,out] v        or NULL
 * @param[in]     dt       time step
 * @param[in,out] lambda   or NULL
 * @param[in]     guess    0 or 1
 * @param[out]    virial   or NULL
 * @param[out]    report   or NULL
 *
 * The vectors are added up from an origin at the first atom of each molecule, with one rounding each, as coordinates
 * there have. Results are those of hol_project_positions with such coordinates. In a molecule with cycles some vectors
 * follow from the others and are taken from these; they must agree to a thousandth of their length, except for sides of
 * the reference box where a cycle goes round it.
 * @return as hol_project_positions; HOL_ERR_UNSUPPORTED (molecules with rigid bodies); HOL_ERR_NOT_FINITE (a vector)
 *         and HOL_ERR_DEGENERATE (vectors that do not close their cycle) with nothing changed at all. It costs
 *         O(n_bonds) more, by one thread. Since 0.2.
 */
HOL_API int hol_project_positions_along(const hol_chains *chains, const double *b, double *r, double *v, double dt,
                                        double *lambda, int guess, double *virial, hol_report *report);

/** hol_project_positions_along with arrays of any layout: element k of the view of b is bond k. Since 0.2. */
HOL_API int hol_project_positions_along_view(const hol_chains *chains, const hol_const_view *b, const hol_view *r,
                                             const hol_view *v, double dt, double *lambda, int guess, double *virial,
                                             hol_report *report);

/**
 * The error of a reference, before anything is moved: of the last reference that a call at the position level has
 * compared with the lengths, with this handle, in any thread. Calls that compare (hol_chains_set_checks): with
 * HOL_AT_START the first one and the first after a change; with HOL_ALWAYS all; with HOL_NEVER those with a report.
 * Each output may be NULL.
 * @param[in]  chains
 * @param[out] error     largest |b.b - a^2| / a^2 over active molecules
 * @param[out] molecule  its number, -1 if there is none
 * @param[out] bond      its bond within the molecule
 * @return HOL_OK; HOL_ERR_NULL (chains); HOL_ERR_STATE (no reference has been compared yet; nothing is written).
 *         Thread-safe on one handle. Since 0.3, before without a handle.
 */
HOL_API int hol_reference_error(const hol_chains *chains, double *error, int64_t *molecule, int64_t *bond);

/** How far positions and velocities are from the constraints. */
typedef struct hol_worst {
    double length;           /**< largest |d.d - a^2| / a^2 */
    int64_t length_molecule; /**< its molecule, of whatever shape; -1 if there is no bond */
    int64_t length_bond;     /**< its bond within the molecule */
    double rate; /**< largest |d . (v_j - v_i + L d)|, length^2/time; 0 without v (L: hol_chains_set_box_rate) */
    int64_t rate_molecule;
    int64_t rate_bond;
} hol_worst;

/**
 * Largest violation of the constraints over the active molecules.
 * @param[in] chains
 * @param[in]  r      positions [n_atoms][3]
 * @param[in]  v      velocities [n_atoms][3], or NULL
 * @param[out] worst
 * @return HOL_OK; HOL_ERR_NULL (chains, r or worst); HOL_ERR_NOT_FINITE (worst is then not written). Since 0.1.
 */
HOL_API int hol_violation(const hol_chains *chains, const double *r, const double *v, hol_worst *worst);

/** hol_violation with arrays per atom of any layout. Since 0.1. */
HOL_API int hol_violation_view(const hol_chains *chains, const hol_const_view *r, const hol_const_view *v,
                               hol_worst *worst);

/**
 * What is left of each constraint.
 * @param[in] chains
 * @param[in]  r       positions [n_atoms][3]
 * @param[in]  v       velocities [n_atoms][3], or NULL
 * @param[out] length  (d.d - a^2) / a^2 [n_bonds], > 0 where a bond is too long, or NULL
 * @param[out] rate    d . (v_j - v_i + L d) [n_bonds], length^2/time, 0 without v, or NULL
 * @return HOL_OK; HOL_ERR_NULL (chains or r); HOL_ERR_NOT_FINITE. Entries of inactive and of bad molecules are not
 *         written; those of bonds between two fixed atoms are 0. Thread-safe on one handle. O(n_bonds). Since 0.2.
 */
HOL_API int hol_residuals(const hol_chains *chains, const double *r, const double *v, double *length, double *rate);

/** hol_residuals with arrays per atom of any layout. Since 0.2. */
HOL_API int hol_residuals_view(const hol_chains *chains, const hol_const_view *r, const hol_const_view *v,
                               double *length, double *rate);

/* --------------------------------------------------------------------------------------------- crude positions */

/**
 * Moves positions that lie anywhere onto the constraints: a model built by hand, coordinates of a builder, another
 * force field's lengths. Bonds may be several times too long or too short. (hol_project_positions with r_ref = r does
 * it where bonds are off by a third or less; above a tenth it needs HOL_NEVER, hol_chains_set_checks.) Each step of
 * Newton's method moves atoms by w G along the present bonds, and only so far that no bond changes by more than a
 * third. Near the end steps are whole, and the result is right to the rounding of the coordinates. A molecule that does
 * not get there begins again twice, after 100 and after 1000 rounds of SHAKE along the present bonds. Molecules with
 * rigid bodies are projected along their present positions.
 *
 * It is no projection: r ends on the constraints near where it was, not at the point that is nearest. Not for time
 * steps. hol_chains_set_checks does not matter. hol_project_velocities may follow.
 *
 * @param[in]     chains
 * @param[in,out] r       positions [n_atoms][3], in the box of hol_chains_set_box
 * @param[out]    report  or NULL: iterations is the largest number of steps of a molecule, most often some ten, in
 *                        each attempt at most 20 times that of hol_chains_set_max_iterations
 * @return HOL_OK; HOL_ERR_NULL; HOL_ERR_NOT_FINITE; HOL_ERR_DEGENERATE (atoms on each other, bonds that depend on each
 *         other in these positions, such as a triangle that has become a line: shift an atom, and call again);
 *         HOL_ERR_NO_CONVERGENCE (lengths that can't be reached); HOL_ERR_MEMORY. Molecules that fail stay as they
 *         were, all others are done; one that is within the tolerance (hol_chains_set_tolerance) already is not
 *         touched. Thread-safe on one handle, each thread with positions of its own. Allocates some 60 bytes per atom.
 *         Since 0.2.
 */
HOL_API int hol_impose(const hol_chains *chains, double *r, hol_report *report);

/** hol_impose with positions of any layout. Since 0.2. */
HOL_API int hol_impose_view(const hol_chains *chains, const hol_view *r, hol_report *report);

/* -------------------------------------------------------------------------- metric determinant and Fixman potential */

/**
 * The metric determinant of molecules with rigid bonds, and the Fixman potential that corrects for it.
 *
 * Z is the matrix that hol_forces solves; Z~ is Z scaled to ones on its diagonal, a function of the masses and of the
 * angles between neighbouring bonds only. A rigid molecule visits its conformations with the weight det Z~^(+1/2)
 * relative to a molecule with stiff springs (the freely jointed chain). The potential energy
 *     U_F = +(kT/2) sum over molecules of ln det Z~
 * added to the others makes it visit them as the molecule with springs does. docs/theory.md (24)-(32);
 * Mazars 2007, Eq. (19).
 *
 * @param[in]     chains
 * @param[in]     r          positions [n_atoms][3]
 * @param[in]     kT         thermal energy, >= 0 and finite; only energy and force depend on it
 * @param[out]    log_det    [n_molecules] ln det Z~, <= 0, or NULL. Relative error a few roundings, however straight a
 *                           chain or tree and however unequal its masses. 0 for a molecule of one bond.
 * @param[out]    log_det_z  [n_molecules] ln det Z, which contains masses and the bonds' actual lengths in the caller's
 *                           units (Z_kk = 4 (w_i + w_j) |d_k|^2), or NULL
 * @param[out]    energy     U_F, or NULL; summed over active molecules
 * @param[in,out] force      - grad U_F [n_atoms][3], or NULL
 * @param[in]     mode       HOL_WRITE: force = - grad U_F for the molecules' atoms; HOL_ADD: added to what is there
 *
 * Entries of inactive molecules are not written. The force on a fixed atom is reported too: minus what the others get.
 * Total force, total torque and the trace of the virial of the force are zero.
 * Trees of up to eight bonds at an atom and rings without side atoms cost up to twice what linear chains do. All others
 * are found in twice the precision, a hundred times as slowly: about a microsecond a bond, and more where many bonds
 * meet at an atom (20 with ten) or a network fills its factor; so are molecules whose images are told
 * (hol_chains_add_bonds_with_images, since 0.3).
 * @return HOL_OK; HOL_ERR_NULL (chains or r); HOL_ERR_VALUE (kT, mode); HOL_ERR_UNSUPPORTED (molecules with rigid
 *         bodies); HOL_ERR_NOT_FINITE; HOL_ERR_DEGENERATE; HOL_ERR_MEMORY. Thread-safe on one handle. Since 0.1.
 */
HOL_API int hol_metric(const hol_chains *chains, const double *r, double kT, double *log_det, double *log_det_z,
                       double *energy, double *force, hol_mode mode);

/** hol_metric with arrays per atom of any layout. Since 0.1. */
HOL_API int hol_metric_view(const hol_chains *chains, const hol_const_view *r, double kT, double *log_det,
                            double *log_det_z, double *energy, const hol_view *force, hol_mode mode);

/* ------------------------------------------------------------------------------------------------- inverse of Z */

/** The inverse of the matrix Z of one molecule in one conformation, prepared so that single elements are cheap. */
typedef struct hol_inverse hol_inverse;

/** Which inverse: of Z~ (ones on its diagonal, no units) or of Z, in 1/(length^2/mass). lambda = Z^-1 (K + C). */
typedef enum hol_scaling HOL_IS_INT { HOL_UNIT_DIAGONAL = 0, HOL_PHYSICAL = 1 } hol_scaling;

/**
 * Prepares the inverse for one molecule of N bonds. Time and memory are proportional to N for a linear chain, a tree or
 * a ring; for others they are those of the elimination of their cycles. docs/theory.md (33)-(37); Mazars 2007, Eqs.
 * (20) and (28). Everything is copied: the set of molecules and r may be changed or freed afterwards.
 *
 * In a linear chain elements are products along it, and cost as the functions below say. In other molecules (since 0.2)
 * a row is a solution of the equations, and so is an element: O(N) in trees and rings. The diagonal and the matrix take
 * O(N^2). All are solved for in twice the precision and are right to a few roundings: in trees however ill conditioned
 * Z is, in molecules with cycles as long as no pivot of Z~ is below 1e-17. These functions may then return
 * HOL_ERR_MEMORY.
 *
 * @param[in]  chains    an inactive molecule is allowed
 * @param[in]  molecule  its number, counted from the index base of `chains`, as bonds and atoms are in all the
 *                       functions below
 * @param[in]  r         positions [n_atoms][3]
 * @param[out] inverse   the new handle, to be given to hol_inverse_destroy; NULL on an error
 * @return HOL_OK; HOL_ERR_NULL; HOL_ERR_INDEX; HOL_ERR_UNSUPPORTED (a molecule with rigid bodies);
 *         HOL_ERR_NOT_FINITE; HOL_ERR_DEGENERATE; HOL_ERR_MEMORY. Thread-safe on one `chains`. Since 0.1.
 */
HOL_API int hol_inverse_create(const hol_chains *chains, int64_t molecule, const double *r, hol_inverse **inverse);

/** hol_inverse_create with positions of any layout. Since 0.1. */
HOL_API int hol_inverse_create_view(const hol_chains *chains, int64_t molecule, const hol_const_view *r,
                                    hol_inverse **inverse);

/** Frees a handle; NULL is allowed and does nothing. Since 0.1. */
HOL_API void hol_inverse_destroy(hol_inverse *inverse);

/** Number of bonds of the molecule, i.e. of rows; 0 if inverse is NULL. Since 0.1. */
HOL_API int64_t hol_inverse_n_bonds(const hol_inverse *inverse);

/**
 * One element; of a linear chain in a time proportional to |i - j| + 1. It is right to a few roundings plus one or two
 * for each step from i to j; it vanishes exactly where a right angle or a fixed atom lies between i and j, and
 * underflows only if the element does.
 * @param[in]  inverse
 * @param[in]  scaling  HOL_UNIT_DIAGONAL or HOL_PHYSICAL
 * @param[in]  i, j     numbers of bonds within the molecule
 * @param[out] value    (Z~^-1)_ij or (Z^-1)_ij
 * @return HOL_OK; HOL_ERR_NULL; HOL_ERR_VALUE (scaling); HOL_ERR_INDEX. Thread-safe, as all functions of a hol_inverse
 *         are. Since 0.1.
 */
HOL_API int hol_inverse_entry(const hol_inverse *inverse, hol_scaling scaling, int64_t i, int64_t j, double *value);

/**
 * Row i, which is column i too, in O(N).
 * @param[in]  inverse
 * @param[in]  scaling  HOL_UNIT_DIAGONAL or HOL_PHYSICAL
 * @param[in]  i        number of a bond within the molecule
 * @param[out] row  [N]
 * @return as hol_inverse_entry. Since 0.1.
 */
HOL_API int hol_inverse_row(const hol_inverse *inverse, hol_scaling scaling, int64_t i, double *row);

/**
 * The diagonal and `width` diagonals beside it, in O(N (width+1)); width 0 is the diagonal alone.
 * @param[in]  inverse
 * @param[in]  scaling  HOL_UNIT_DIAGONAL or HOL_PHYSICAL
 * @param[in]  width  >= 0; 0 for a molecule that is no linear chain, as the order of its bonds gives a band no meaning
 * @param[out] band   [N][width+1]: element (i, i+k) at band[i (width+1) + k], 0 where i+k is past the last bond
 * @return HOL_OK; HOL_ERR_NULL; HOL_ERR_VALUE (scaling, width). Since 0.1.
 */
HOL_API int hol_inverse_band(const hol_inverse *inverse, hol_scaling scaling, int64_t width, double *band);

/**
 * The whole inverse, in O(N^2).
 * @param[in]  inverse
 * @param[in]  scaling  HOL_UNIT_DIAGONAL or HOL_PHYSICAL
 * @param[out] matrix  [N][N], symmetric to the last bit
 * @return HOL_OK; HOL_ERR_NULL; HOL_ERR_VALUE (scaling). Since 0.1.
 */
HOL_API int hol_inverse_matrix(const hol_inverse *inverse, hol_scaling scaling, double *matrix);

/**
 * Condition number of Z~ in the infinity norm, |Z~| |Z~^-1|, in O(N): by how much relative errors in the matrix can
 * grow in the multipliers, at worst and in norm. About N^2/2 for a straight chain of equal masses. The library's own
 * rounding does not grow with it; the effect of errors in the caller's positions does.
 * @return HOL_OK; HOL_ERR_NULL. Since 0.1.
 */
HOL_API int hol_inverse_condition(const hol_inverse *inverse, double *condition);

/**
 * A guaranteed bound on how far given multipliers of the molecule are from the exact ones. It is |Z^-1| times the
 * residual K + C - Z lambda, evaluated in twice the precision, plus the rounding of this evaluation. O(N) for a linear
 * chain, O(N^2) otherwise. It says how far to trust multipliers from any source, this library or another solver.
 *
 * @param[in]  inverse  of the conformation to which the multipliers belong
 * @param[in]  v, f     velocities and applied forces as given to hol_forces, [n_atoms][3]; either may be NULL
 * @param[in]  lambda   [N], the molecule's part of the multipliers
 * @param[out] bound    [N] |lambda_k - exact lambda_k| <= bound_k, or NULL
 * @param[out] relative the largest bound_k over the largest |lambda_k|, or NULL; 0 if all bounds are 0, infinite if all
 *                      multipliers are 0 and a bound is not
 *
 * The equations are those without hol_chains_set_box_rate. "Exact" is for the given doubles of r, v, f and for the
 * inverse masses as rounded to doubles. The data's own errors come on top: at most their relative error times
 * hol_inverse_condition.
 * @return HOL_OK; HOL_ERR_NULL (inverse or lambda); HOL_ERR_NOT_FINITE (v, f or lambda; nothing is written). Since 0.1.
 */
HOL_API int hol_inverse_error_bound(const hol_inverse *inverse, const double *v, const double *f, const double *lambda,
                                    double *bound, double *relative);

/** hol_inverse_error_bound with arrays per atom of any layout. Since 0.1. */
HOL_API int hol_inverse_error_bound_view(const hol_inverse *inverse, const hol_const_view *v, const hol_const_view *f,
                                         const double *lambda, double *bound, double *relative);

/* ------------------------------------------------------------------------------------- the bare tridiagonal algebra */

/*
 * The symmetric tridiagonal matrix T of n rows with ones on its diagonal and -gamma beside it, T_{k-1,k} = -gamma_k, as
 * it appears in spin models, harmonic chains and other one-dimensional models. gamma is [n-1]: gamma[0] couples the
 * first two rows (gamma_2 in the paper), gamma[k] rows k and k+1 counted from 0.
 *
 * Accuracy. Results are those of the given doubles to a few roundings (plus one or two for each row between i and j in
 * inverse elements), up to a condition number of about 1e14. Solutions, pivots and determinants are computed in doubles
 * and corrected by what their rounding has done, which costs as much as a plain elimination. Where the corrections show
 * that this is not enough (condition numbers above some 1e6), and for inverse elements, the recursions run in twice the
 * precision and take 10 to 20 times as long.
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
 * @param[in]  n      rows
 * @param[in]  gamma  [n-1]; may be NULL if n = 1
 * @param[in]  b  [n]
 * @param[out] x  [n], may be b itself
 * Since 0.1.
 */
HOL_API int hol_tridiagonal_solve(int64_t n, const double *gamma, const double *b, double *x);

/**
 * One element of the inverse (Mazars 2007, Eq. 20). O(n) whatever i and j; for many elements use the band.
 * @param[in]  n      rows
 * @param[in]  gamma  [n-1]; may be NULL if n = 1
 * @param[in] i, j  rows, counted from 0
 * @param[out] value
 * Since 0.1.
 */
HOL_API int hol_tridiagonal_inverse_entry(int64_t n, const double *gamma, int64_t i, int64_t j, double *value);

/**
 * The diagonal of the inverse and `width` diagonals beside it. O(n (width+1)).
 * @param[in]  n      rows
 * @param[in]  gamma  [n-1]; may be NULL if n = 1
 * @param[in]  width  >= 0
 * @param[out] band  [n][width+1]: element (i, i+k) at band[i (width+1) + k], 0 where i+k is past the last row
 * Since 0.1.
 */
HOL_API int hol_tridiagonal_inverse_band(int64_t n, const double *gamma, int64_t width, double *band);

/* --------------------------------------------------------------------------------------------------- accelerators */

/**
 * For a program that keeps its atoms on a GPU: the constraints of a set of molecules as kernels solve them there. A
 * plan has the kernels' source, in the common subset of OpenCL C, CUDA and HIP, and the arrays that they read. It is
 * made once, when molecules are set up; the program compiles the source, copies the arrays and launches the kernels in
 * each step, where it called SHAKE. Nothing waits for the host, and results have the same bits in every run.
 * examples/device/steps.c is such a program; docs/device.md tells of macros for other layouts of arrays, and of boxes.
 */
typedef struct hol_device_plan hol_device_plan;

/** What the kernels calculate with. */
typedef enum hol_device_precision HOL_IS_INT {
    HOL_DEVICE_SINGLE = 0, /**< floats: bonds right to some 2e-7 */
    HOL_DEVICE_MIXED = 1,  /**< arrays and errors are doubles, the matrix is of floats: bonds right to 1e-15 */
    HOL_DEVICE_DOUBLE = 2  /**< doubles */
} hol_device_precision;

/** The arrays of a plan, in the order in which all its kernels take them. */
typedef enum hol_device_array HOL_IS_INT {
    HOL_DEVICE_INTEGERS = 0, /**< 32-bit integers: kinds of molecules, their atoms, orders of elimination */
    HOL_DEVICE_NUMBERS = 1,  /**< inverse masses and inverse squares of lengths; floats with HOL_DEVICE_SINGLE, else
                                  doubles */
    HOL_DEVICE_SCRATCH = 2,  /**< room for molecules that are too large for local memory; any contents */
    HOL_DEVICE_FAILURES = 3  /**< 32-bit integers, 0 at first: [0] is 1 if a molecule could not be solved, [1 + m] the
                                  number of the call in which molecule m (counted from 0) could not for the first time */
} hol_device_array;

/**
 * Makes a plan for all molecules of a set, active or not, with the masses and lengths that they have now; it knows
 * nothing of the set afterwards. Molecules that kernels can't solve are left to the host (hol_device_plan_left): those
 * with rigid bodies, relations or told images, and those whose elimination takes more than 200 products per bond
 * (hubs of dozens of bonds, lattices).
 *
 * @param[in]  chains       its box is not looked at: HOL_IMAGE in the source, docs/device.md
 * @param[in]  precision
 * @param[in]  max_entries  molecules whose matrix has up to so many entries above its diagonal once it is eliminated (a
 *                          tree of n bonds has n - 1 or more) are solved by a work-item each, larger ones by a
 *                          work-group. At most 1000; below 0: 70, as suits the registers of GPUs. For a processor's
 *                          OpenCL 300 is faster.
 * @param[out] plan         the new plan, to be given to hol_device_plan_destroy; NULL on an error
 * @return HOL_OK; HOL_ERR_NULL; HOL_ERR_VALUE (precision, max_entries); HOL_ERR_UNSUPPORTED (more atoms than 32 bits
 *         count); HOL_ERR_MEMORY. Thread-safe on one set. Since 0.3.
 */
HOL_API int hol_device_plan_create(const hol_chains *chains, hol_device_precision precision, int64_t max_entries,
                                   hol_device_plan **plan);

/** Frees the plan, and all that it has handed out; NULL is allowed and does nothing. Since 0.3. */
HOL_API void hol_device_plan_destroy(hol_device_plan *plan);

/**
 * The text of the plan's kernels, to be compiled at run time (clBuildProgram, NVRTC, hipRTC) or written to a file. It
 * depends on the kinds of molecules and the precision, not on how many there are. NULL if plan is. Since 0.3.
 *
 * Each launch has two kernels. Their first arguments are the four arrays of the plan and `int call`, any number but 0
 * by which failures are remembered. Unless macros say otherwise there follow, for positions, r_ref [n_atoms][3], r
 * [n_atoms][3], v [n_atoms][3], inverse_dt as in hol_project_positions: r is changed, and v by the change of r times
 * inverse_dt; 0: v is not touched and may be a null pointer. For velocities r [n_atoms][3], v [n_atoms][3] as in
 * hol_project_velocities: v is changed. All are floats with HOL_DEVICE_SINGLE, else doubles. A molecule that can't be
 * solved stays as it was.
 */
HOL_API const char *hol_device_plan_source(const hol_device_plan *plan);

/**
 * One array of the plan.
 * @param[in]  plan
 * @param[in]  which
 * @param[out] data   what is to be copied to the device, or NULL: nothing is. Valid until the plan is destroyed
 * @param[out] bytes  its size, at least 1
 * @return HOL_OK; HOL_ERR_NULL; HOL_ERR_VALUE (which). Thread-safe. Since 0.3.
 */
HOL_API int hol_device_plan_array(const hol_device_plan *plan, hol_device_array which, const void **data,
                                  int64_t *bytes);

/** How many launches cover all molecules of the plan: 0 to 4, in any order or at once. 0 if plan is NULL. Since 0.3. */
HOL_API int64_t hol_device_plan_n_launches(const hol_device_plan *plan);

/**
 * One launch of the plan; each output may be NULL.
 * @param[in]  plan
 * @param[in]  launch      0 .. n_launches - 1
 * @param[out] positions   name of the kernel that corrects positions. Valid until the plan is destroyed
 * @param[out] velocities  name of the kernel that corrects velocities
 * @param[out] n_groups    work-groups (CUDA's blocks) to start; fewer do, too
 * @param[out] group_size  work-items (CUDA's threads) of each: 64 or 256; fewer do, too
 * @return HOL_OK; HOL_ERR_NULL (plan); HOL_ERR_VALUE (launch). Thread-safe. Since 0.3.
 */
HOL_API int hol_device_plan_launch(const hol_device_plan *plan, int64_t launch, const char **positions,
                                   const char **velocities, int64_t *n_groups, int64_t *group_size);

/**
 * How many molecules are left to the host: the ordinary functions solve them, with hol_chains_set_active for these
 * alone. 0 if plan is NULL. Since 0.3.
 */
HOL_API int64_t hol_device_plan_n_left(const hol_device_plan *plan);

/**
 * Which molecules are left to the host.
 * @param[in]  plan
 * @param[out] molecules  [n_left] their numbers, counted as in the set; ascending
 * @return HOL_OK; HOL_ERR_NULL. Thread-safe. Since 0.3.
 */
HOL_API int hol_device_plan_left(const hol_device_plan *plan, int64_t *molecules);

/* -------------------------------------------------------------------------------------------- partition functions */

/**
 * Means of powers of the metric determinant over all conformations of the freely jointed chain of given masses, i.e.
 * over independent bond directions, each uniform on the sphere; as logarithms. With
 * x_n = m_n m_{n-2} / ((m_{n-1} + m_n) (m_{n-1} + m_{n-2})) and gamma_n uniform in 0 .. sqrt(x_n):
 *     log_he      ln < det Z~^(-1/2) >: the multiple hypergeometric function He(1/2; 3/2; x_2..x_N), the integral of
 *                 Mazars 2007, Eq. (31)
 *     log_rigid   ln < det Z~^(+1/2) >: the rigid chain's partition function over that of the freely jointed chain;
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
