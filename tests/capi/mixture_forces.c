#include "mixture_forces.h"

#include "check.h"
#include "molecule_solution.h"

forces_results mixture_forces(const mixture *m, const double *v, const double *f)
{
    forces_results s = {untouched((size_t)m->n_bonds), untouched((size_t)m->n_bonds), untouched(mixture_size(m)), {0}};
    CHECK(hol_forces(m->chains, m->r, v, f, s.lambda, s.tension, s.g, HOL_WRITE, s.virial));
    return s;
}

void assert_mixture_forces(const mixture *m, const double *v, const double *f, const forces_results *s)
{
    long double virial[9] = {0}, virial_allowed = 0;
    for (int64_t p = 0; p < m->n_parts; ++p) {
        const molecule *part = m->parts + p;
        molecule_problem problem = molecule_problem_of(part);
        const long double unit = oracle_bound(part->n_bonds) * DBL_EPSILON;
        double *lambda = untouched((size_t)part->n_bonds), *tension = untouched((size_t)part->n_bonds);
        double *g = untouched(3 * (size_t)part->n_atoms);
        molecule_solution exact;
        if (!v) problem.v = NULL;
        if (!f) problem.f = NULL;
        assert_int_equal(molecule_forces(&problem, &exact), 0);
        mixture_take_bonds(m, p, s->lambda, lambda);
        mixture_take_bonds(m, p, s->tension, tension);
        mixture_take(m, p, s->g, g);
        for (int64_t k = 0; k < part->n_bonds; ++k) {
            CHECK_AT_MOST(fabsl(lambda[k] - exact.lambda[k]), unit * exact.lambda_scale[k]);
            /* T = 2 lambda |d|: two more roundings than lambda */
            CHECK_AT_MOST(fabsl(tension[k] - exact.tension[k]), 2.4L * unit * exact.lambda_scale[k] * part->length[k]);
        }
        for (int64_t i = 0; i < 3 * part->n_atoms; ++i)
            if (exact.g_scale[i / 3] > 0) CHECK_AT_MOST(fabsl(g[i] - exact.g[i]), unit * exact.g_scale[i / 3]);
        for (int i = 0; i < 9; ++i) virial[i] += exact.virial[i];
        virial_allowed += unit * exact.virial_scale;
        free(lambda), free(tension), free(g);
        molecule_solution_free(&exact);
    }
    for (int i = 0; i < 9; ++i) CHECK_AT_MOST(fabsl(s->virial[i] - virial[i]), 2 * virial_allowed);
}
