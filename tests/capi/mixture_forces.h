/** Forces of molecules of any shape beside an independent solution. */
#ifndef TESTS_MIXTURE_FORCES_H
#define TESTS_MIXTURE_FORCES_H

#include "forces.h"
#include "mixture.h"

/** By hol_forces; v, f: or NULL. */
forces_results mixture_forces(const mixture *m, const double *v, const double *f);

/** Every number of every molecule within the bound of tests/oracle/molecules/README.md. */
void assert_mixture_forces(const mixture *m, const double *v, const double *f, const forces_results *s);

#endif
