/**
 * @file water.h
 * Rigid water on a lattice in a cubic box: a scene in which mistakes of set-up are made.
 */
#ifndef TESTS_WATER_H
#define TESTS_WATER_H

#include <stdint.h>

#define WATER_OH 1.0
#define WATER_HH 1.6329931618554521

typedef struct waters {
    int64_t n_molecules, n_atoms;
    double side, box[9]; /* of the cell */
    double *r, *mass;    /* whole molecules; O H H */
} waters;

/** per_side^3 molecules in random directions, 3.1 apart. */
waters make_waters(int per_side, uint64_t seed);

/** The same with every atom put back into the cell by itself: molecules at its faces are cut. */
void cut_by_the_faces(waters *w);

void free_waters(waters *w);

/** The three bonds of a molecule: O-H, O-H, H-H. */
extern const int64_t water_pairs[6];
extern const double water_lengths[3];

#endif
