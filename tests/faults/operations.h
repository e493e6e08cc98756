/** Every calculation of the C interface as a call of one form. */
#ifndef FAULTS_OPERATIONS_H
#define FAULTS_OPERATIONS_H

#include "assembly.h"

/** One call: writes what it computes to `out`, which `prepare` fills before. */
typedef struct operation {
    const char *name;
    int (*call)(const assembly *a, double *out);
    int plans; /**< analyses molecules anew, where sorting does without the memory that it can't have */
} operation;

extern const operation operations[];
extern const size_t n_operations;

/** Two of them. */
int forces(const assembly *a, double *out);
int given_right_hand_sides(const assembly *a, double *out);

/** The atoms of the bonds, [n_bonds][2], if they do not follow each other along chains; else NULL. */
extern const int64_t *pairs_of_bonds;

/** Of the inverse's calls; to be made before allocations fail. */
extern hol_inverse *prepared;

/** Elements of `out`. */
size_t out_size(const assembly *a);
void prepare(const assembly *a, double *out);

#endif
