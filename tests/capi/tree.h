/**
 * @file tree.h
 * Trees with linear arms.
 */
#ifndef TESTS_TREE_H
#define TESTS_TREE_H

#include <holonomic.h>
#include <stdint.h>

#include "random.h"

/** A tree and its state, that grows. */
typedef struct tree {
    int64_t n_atoms, n_bonds, n_ends;
    int64_t *pairs, *end;
    int *neighbours; /* of each end */
    double *mass, *length, *r, *v, *f;
    random_stream stream;
} tree;

/** Arms of the lengths first .. last, each outwards and inwards; `bend` as in tree_grow. */
tree tree_of_lengths(int64_t first, int64_t last, double bend);

/** Straight arms beside coils, at least n atoms; some end at fixed atoms. */
tree tree_mixed(int64_t n);

void tree_fell(tree *t);

/** Chains that hold it. */
hol_chains *tree_chains(const tree *t);

#endif
