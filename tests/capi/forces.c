#include "forces.h"

#include "check.h"

forces_results forces_of(const assembly *a, const double *v, const double *f)
{
    forces_results s = {untouched((size_t)a->n_bonds), untouched((size_t)a->n_bonds), untouched(assembly_size(a)), {0}};
    CHECK(hol_forces(a->chains, a->r, v, f, s.lambda, s.tension, s.g, HOL_WRITE, s.virial));
    return s;
}

void forces_results_free(forces_results *s)
{
    free(s->lambda);
    free(s->tension);
    free(s->g);
}
