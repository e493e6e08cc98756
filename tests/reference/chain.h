/**
 * @file chain.h
 * Chains to test with: the shapes that occur in practice, and those that break constraint solvers.
 */
#ifndef REFERENCE_CHAIN_H
#define REFERENCE_CHAIN_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/** One chain with the state of its atoms; mass 0 means held fixed, with zero velocity. */
typedef struct chain {
    int64_t n_bonds;
    double *mass;   /**< [n_bonds+1] */
    double *length; /**< [n_bonds], |d_k| of r, rounded */
    double *r;      /**< [n_bonds+1][3] */
    double *v;      /**< [n_bonds+1][3], from the Maxwell distribution at kT = 1; the constraints are not applied */
    double *f;      /**< [n_bonds+1][3], normal, times the square root of the mass */
} chain;

typedef enum chain_kind {
    CHAIN_COIL = 0,        /**< isotropic random walk, unit bonds and masses */
    CHAIN_HETEROGENEOUS,   /**< random walk, masses over two decades, lengths 0.7..1.5 */
    CHAIN_NEARLY_STRAIGHT, /**< each bond turned by 0..5 degrees from the one before */
    CHAIN_STRAIGHT,        /**< exactly straight along x, unit bonds and masses */
    CHAIN_LATTICE,         /**< steps along the axes, all angles 90 degrees */
    CHAIN_FOLDED,          /**< folded back on itself at every atom, up to angles of 1e-3 */
    CHAIN_MASSES_1E3,      /**< random walk, masses alternating 1 and 1e3 */
    CHAIN_MASSES_1E6,      /**< random walk, masses alternating 1 and 1e6 */
    CHAIN_FIXED_ENDS,      /**< random walk, both ends held fixed */
    CHAIN_BOND_RATIO_1E6,  /**< random walk, lengths alternating 1 and 1e-6 */
    CHAIN_OFFSET_1E6,      /**< nearly straight, coordinates shifted by 1e6 */
    CHAIN_ROD_MASSES_1E9,  /**< straight up to rounding along a general direction, masses alternating 1 and 1e9 */
    CHAIN_TAUT,            /**< straight up to angles of 1e-5, both ends held fixed */
    CHAIN_KINDS            /**< how many kinds there are */
} chain_kind;

/** Words for a kind. */
const char *chain_kind_name(chain_kind kind);

/** Makes a chain; the program ends if there is no memory. The same arguments give the same chain. */
chain chain_make(chain_kind kind, int64_t n_bonds, uint64_t seed);

/** Frees what chain_make allocated. */
void chain_free(chain *c);

#ifdef __cplusplus
}
#endif
#endif
