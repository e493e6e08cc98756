/**
 * @file molecule.h
 * Molecules to test with, of the shapes that real programs have and of those that break constraint solvers. A molecule
 * may be put together by hand, atom by atom and bond by bond, too.
 */
#ifndef REFERENCE_MOLECULE_H
#define REFERENCE_MOLECULE_H

#include <stdint.h>

#include "molecule_problem.h"
#include "random.h"

#ifdef __cplusplus
extern "C" {
#endif

/** One molecule with the state of its atoms; mass 0 means held fixed, with zero velocity. */
typedef struct molecule {
    int64_t n_atoms, n_bonds;
    double *mass;         /**< [n_atoms]; 1 / mass is exactly inverse_mass */
    double *inverse_mass; /**< [n_atoms] */
    double *r, *v, *f;    /**< [n_atoms][3]; v from the Maxwell distribution at kT = 1 */
    int64_t *pairs;       /**< [n_bonds][2] */
    double *length;       /**< [n_bonds], |d_k| of r, rounded */
    int64_t room_for_atoms, room_for_bonds;
} molecule;

typedef enum molecule_kind {
    MOLECULE_CHAIN = 0,            /**< linear, `size` bonds */
    MOLECULE_WATER,                /**< three distances */
    MOLECULE_XH2,                  /**< two bonds, no angle */
    MOLECULE_XH3,                  /**< a heavy atom with three light ones */
    MOLECULE_XH4,                  /**< and with four: methane */
    MOLECULE_NEOPENTANE,           /**< C(CH3)4 with all bonds */
    MOLECULE_ALKANE,               /**< `size` carbon atoms with their hydrogens */
    MOLECULE_COMB,                 /**< a backbone of `size` atoms, each with one side atom */
    MOLECULE_NEARLY_STRAIGHT_COMB, /**< the backbone turned by 1e-6 at each atom */
    MOLECULE_DENDRIMER,            /**< three arms that divide in two, `size` generations */
    MOLECULE_STAR,                 /**< `size` arms of two bonds */
    MOLECULE_TREE,                 /**< random, `size` bonds, valence up to 6 */
    MOLECULE_FIXED_ATOMS,          /**< a comb of which some atoms are held fixed, two of them neighbours */
    MOLECULE_LIGHT_JOINTS,         /**< a comb whose every other backbone atom has mass 1e-9 */
    MOLECULE_TAUT,                 /**< a branched path between fixed atoms, straight to 1e-6 */
    MOLECULE_COPLANAR_STAR,        /**< three bonds in a plane to 1e-8, heavy ends */
    MOLECULE_RING,                 /**< `size` atoms */
    MOLECULE_COLLAPSED_RING,       /**< pressed onto a line to 1e-3 */
    MOLECULE_BENZENE,              /**< C6H6 with all bonds, planar */
    MOLECULE_PUCKERED_BENZENE,     /**< with rigid C-C-C angles, out of plane by 0.02 */
    MOLECULE_TRIANGLES,            /**< a path of `size` atoms with rigid angles of 70..150 degrees */
    MOLECULE_ZIGZAG,               /**< the same in a plane with 109.5 degrees */
    MOLECULE_TRIANGLES_179,        /**< the same with rigid angles of 179.9 degrees */
    MOLECULE_BENT,                 /**< one triangle of 179.9 degrees with its three distances */
    MOLECULE_FUSED_RINGS,          /**< a ladder of `size` hexagons */
    MOLECULE_CUBE,                 /**< the edges of a cube */
    MOLECULE_LARIAT,               /**< a ring of `size` with branched tails of light atoms */
    MOLECULE_PEPTIDE,              /**< `size` residues with hydrogens, side chains and a phenyl ring in every third */
    MOLECULE_GOOD_KINDS,           /**< how many kinds there are that have an answer */
    MOLECULE_TEN_DISTANCES = MOLECULE_GOOD_KINDS, /**< methane with all of them: one more than its freedoms */
    MOLECULE_LINEAR,                              /**< three distances on a line */
    MOLECULE_PLANAR_SQUARE,                       /**< a square with both diagonals */
    MOLECULE_TAUT_EXACTLY,                        /**< straight between two fixed atoms */
    MOLECULE_REFUSED_END, /**< from here on again with an answer, of which a part is zero by symmetry alone */
    MOLECULE_CUBANE = MOLECULE_REFUSED_END, /**< C8H8 with all bonds */
    MOLECULE_NAPHTHALENE,                   /**< C10H8 with all bonds, in a plane */
    MOLECULE_KINDS                          /**< how many kinds there are */
} molecule_kind;

/** Words for a kind. */
const char *molecule_kind_name(molecule_kind kind);

/** Makes a molecule; the program ends if there is no memory. The same arguments give the same molecule. */
molecule molecule_make(molecule_kind kind, int64_t size, uint64_t seed);

/** An empty molecule, to which atoms and bonds are added; each atom's number is returned. */
molecule molecule_empty(void);
int64_t molecule_add_atom(molecule *m, double mass, const double r[3]);
void molecule_add_bond(molecule *m, int64_t i, int64_t j);

/** An atom bonded to `to`, at a distance `length` along the unit vector u. */
int64_t molecule_grow(molecule *m, int64_t to, double mass, double length, const double u[3]);

/** Lengths from positions; velocities and forces at random. */
void molecule_finish(molecule *m, random_stream *s);

/** A step after which all atoms have moved with their velocities; to be freed. */
double *molecule_drifted(const molecule *m, double dt);

molecule_problem molecule_problem_of(const molecule *m);

molecule molecule_copy(const molecule *m);

void molecule_free(molecule *m);

#ifdef __cplusplus
}
#endif
#endif
