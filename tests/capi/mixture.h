/**
 * @file mixture.h
 * Molecules of any shape over one set of atom arrays, with a handle: what a caller of the library has.
 */
#ifndef TESTS_MIXTURE_H
#define TESTS_MIXTURE_H

#include <holonomic.h>
#include <stddef.h>

#include "molecule.h"

typedef enum mixing {
    ONE_AFTER_THE_OTHER = 0, /**< atoms and bonds */
    MIXED /**< atoms interleaved with each other's and with others that hold NaN, their order within a molecule kept;
             bonds in any order, either atom first */
} mixing;

typedef struct mixture {
    hol_chains *chains;
    int64_t n_parts, n_atoms, n_bonds;
    molecule *parts;     /**< copies */
    int64_t *first_atom; /**< [n_parts+1], where the numbers of a part's atoms begin in `atoms` */
    int64_t *atoms;      /**< number of each atom of each part */
    int64_t *first_bond; /**< [n_parts+1], where a part's bonds begin in `bonds` */
    int64_t *bonds;      /**< place in the arrays per bond of each bond of each part */
    int64_t *pairs;      /**< [n_bonds][2] as given to the library */
    double *mass;        /**< [n_atoms] */
    double *length;      /**< [n_bonds] as given to the library */
    double *r, *v, *f;   /**< [n_atoms][3] */
} mixture;

/** Puts copies of the parts together; the test fails if the library does not take them. */
mixture mixture_make(const molecule *parts, int64_t n_parts, mixing how, uint64_t seed);

/** `each` of every kind that has an answer, of various sizes. */
mixture mixture_of_all(int64_t each, mixing how, uint64_t seed);

/** n of one kind, of sizes low to high in turn. */
mixture mixture_of_kind(molecule_kind kind, int64_t n, int64_t low, int64_t high, mixing how, uint64_t seed);

/** Size of an array per atom, in numbers. */
size_t mixture_size(const mixture *m);

/** Copies a part out of an array per atom, or per bond. */
void mixture_take(const mixture *m, int64_t part, const double *per_atom, double *out);
void mixture_take_bonds(const mixture *m, int64_t part, const double *per_bond, double *out);

/** Positions after a drift with the velocities; to be freed. */
double *mixture_drifted(const mixture *m, double dt);

void mixture_free(mixture *m);

#endif
