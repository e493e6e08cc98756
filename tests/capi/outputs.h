/** All outputs of the three verbs for an assembly. */
#ifndef TESTS_OUTPUTS_H
#define TESTS_OUTPUTS_H

#include "assembly.h"

enum { VERBS = 3 };

typedef struct outputs {
    double *lambda[VERBS]; /* per bond: forces, velocities, positions */
    double *atoms[VERBS];  /* per atom: g; v; r */
    double *moved;         /* v after hol_project_positions */
    double *tension;
    double virial[VERBS][9];
} outputs;

outputs outputs_of(const assembly *a, double dt);
void outputs_free(outputs *o);
void assert_same_outputs(const assembly *a, const outputs *p, const outputs *q, int sums_too);

#endif
