/** Velocity projection of molecules of any shape. */
#include "check.h"
#include "equations.h"
#include "mixture.h"
#include "molecule_solution.h"

static void assert_projected(const mixture *m)
{
    double *v = copy_of(m->v, mixture_size(m)), *lambda = untouched((size_t)m->n_bonds), virial[9];
    long double expected[9] = {0}, allowed = 0;
    CHECK(hol_project_velocities(m->chains, m->r, v, lambda, virial));
    for (int64_t p = 0; p < m->n_parts; ++p) {
        const molecule *part = m->parts + p;
        const molecule_problem problem = molecule_problem_of(part);
        const long double unit = oracle_bound(part->n_bonds) * DBL_EPSILON;
        double *got = untouched(3 * (size_t)part->n_atoms), *mu = untouched((size_t)part->n_bonds);
        molecule_solution exact;
        assert_int_equal(molecule_velocities(&problem, &exact), 0);
        mixture_take(m, p, v, got);
        mixture_take_bonds(m, p, lambda, mu);
        for (int64_t k = 0; k < part->n_bonds; ++k)
            CHECK_AT_MOST(fabsl(mu[k] - exact.lambda[k]), unit * exact.lambda_scale[k]);
        leave_roundings_of_rates(part, got, &exact);
        for (int64_t i = 0; i < 3 * part->n_atoms; ++i)
            CHECK_AT_MOST(fabsl(got[i] - exact.moved[i]), unit * exact.moved_scale[i / 3]);
        for (int i = 0; i < 9; ++i) expected[i] += exact.virial[i];
        allowed += unit * exact.virial_scale;
        free(got), free(mu);
        molecule_solution_free(&exact);
    }
    for (int i = 0; i < 9; ++i) CHECK_AT_MOST(fabsl(virial[i] - expected[i]), 2 * allowed);
    free(v), free(lambda);
}

static void velocities_agree_with_a_dense_solution_and_obey_the_constraints(void **state)
{
    (void)state;
    mixture m = mixture_of_all(quick_run() ? 1 : 4, MIXED, 10);
    assert_projected(&m);
    mixture_free(&m);
}

/** Their multipliers are what rounding left of the first projection, and as right as any. */
static void velocities_that_are_projected_already_agree_with_a_dense_solution(void **state)
{
    (void)state;
    mixture m = mixture_of_all(quick_run() ? 1 : 4, MIXED, 10);
    CHECK(hol_project_velocities(m.chains, m.r, m.v, NULL, NULL));
    for (int64_t p = 0; p < m.n_parts; ++p) mixture_take(&m, p, m.v, m.parts[p].v);
    assert_projected(&m);
    mixture_free(&m);
}

/** Of all velocities that obey the constraints the projection is the nearest: what it removes is orthogonal to them. */
static void projection_keeps_momentum_and_removes_kinetic_energy_alone(void **state)
{
    (void)state;
    mixture m = mixture_of_kind(MOLECULE_PEPTIDE, 20, 1, 2, MIXED, 20);
    double *v = copy_of(m.v, mixture_size(&m));
    CHECK(hol_project_velocities(m.chains, m.r, v, NULL, NULL));
    for (int64_t p = 0; p < m.n_parts; ++p) {
        const molecule *part = m.parts + p;
        double *got = untouched(3 * (size_t)part->n_atoms);
        long double before = 0, after = 0, removed = 0, momentum[3] = {0}, size = 0;
        mixture_take(&m, p, v, got);
        for (int64_t i = 0; i < 3 * part->n_atoms; ++i) {
            const long double mass = part->mass[i / 3], dv = (long double)part->v[i] - got[i];
            before += mass * part->v[i] * part->v[i];
            after += mass * got[i] * got[i];
            removed += mass * dv * dv;
            momentum[i % 3] += mass * dv;
            size += mass * (fabs(part->v[i]) + fabs(got[i]));
        }
        for (int x = 0; x < 3; ++x) CHECK_AT_MOST(fabsl(momentum[x]), 8 * DBL_EPSILON * size);
        CHECK_AT_MOST(fabsl(before - after - removed), 64 * DBL_EPSILON * before);
        assert_true(after < before);
        free(got);
    }
    free(v);
    mixture_free(&m);
}

static void a_second_projection_changes_velocities_by_rounding_alone(void **state)
{
    (void)state;
    mixture m = mixture_of_kind(MOLECULE_WATER, 40, 3, 3, MIXED, 30);
    double *v = copy_of(m.v, mixture_size(&m));
    CHECK(hol_project_velocities(m.chains, m.r, v, NULL, NULL));
    double *again = copy_of(v, mixture_size(&m));
    CHECK(hol_project_velocities(m.chains, m.r, again, NULL, NULL));
    for (size_t i = 0; i < mixture_size(&m); ++i)
        if (!isnan(v[i]))
            CHECK_AT_MOST(fabs(again[i] - v[i]), 64 * DBL_EPSILON * 8); /* speeds of up to 4, eight terms */
    free(v), free(again);
    mixture_free(&m);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(velocities_agree_with_a_dense_solution_and_obey_the_constraints),
        cmocka_unit_test(velocities_that_are_projected_already_agree_with_a_dense_solution),
        cmocka_unit_test(projection_keeps_momentum_and_removes_kinetic_energy_alone),
        cmocka_unit_test(a_second_projection_changes_velocities_by_rounding_alone),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
