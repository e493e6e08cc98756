/**
 * @file assembly.h
 * Many chains over one set of atom arrays, with a handle: what a caller of the library has.
 */
#ifndef TESTS_ASSEMBLY_H
#define TESTS_ASSEMBLY_H

#include <holonomic.h>
#include <stddef.h>

#include "chain.h"

typedef enum arrangement {
    IN_ORDER = 0, /**< chain after chain, atoms consecutive */
    SCATTERED     /**< atoms in random order, with others between them that belong to no chain and hold NaN */
} arrangement;

typedef struct assembly {
    hol_chains *chains;
    int64_t n_chains, n_atoms, n_bonds;
    int64_t *first_bond; /**< [n_chains+1] */
    int64_t *first;      /**< [n_chains], where the chain's atoms begin in `atoms` */
    int64_t *atoms;      /**< atom numbers of all chains, one chain after the other */
    double *mass;        /**< [n_atoms] */
    double *length;      /**< [n_bonds] */
    double *r, *v, *f;   /**< [n_atoms][3] */
} assembly;

/** Puts copies of the parts together; the test fails if the library does not take them. */
assembly assembly_make(const chain *parts, int64_t n_parts, arrangement how, uint64_t seed);

/** n chains of one kind with lengths between low and high. */
assembly assembly_of_kind(chain_kind kind, int64_t n, int64_t low, int64_t high, arrangement how, uint64_t seed);

/** Size of an array per atom, in numbers. */
size_t assembly_size(const assembly *a);

/** Copies chain c out of an array per atom into [n_bonds+1][3]. */
void assembly_take(const assembly *a, int64_t c, const double *per_atom, double *out);

/** Number of bonds of chain c. */
int64_t assembly_bonds(const assembly *a, int64_t c);

/** A chain with the data of chain c, to be freed with chain_free. */
chain assembly_chain(const assembly *a, int64_t c);

void assembly_free(assembly *a);

#endif
