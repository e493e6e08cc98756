/** All that hol_forces computes. */
#ifndef TESTS_FORCES_H
#define TESTS_FORCES_H

#include "assembly.h"

typedef struct forces_results {
    double *lambda, *tension, *g, virial[9];
} forces_results;

/** Of all chains; v, f: or NULL. */
forces_results forces_of(const assembly *a, const double *v, const double *f);

void forces_results_free(forces_results *s);

#endif
