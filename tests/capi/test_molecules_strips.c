/** Chains whose angles are all rigid: strips of triangles. */
#include "check.h"
#include "mixture.h"
#include "molecule_solution.h"

/** A molecule without its bond k, or all its bonds with k = -1; atom `held` is held fixed, -1: none. */
static molecule altered(const molecule *m, int64_t k, int64_t held)
{
    molecule out = molecule_empty();
    for (int64_t i = 0; i < m->n_atoms; ++i) molecule_add_atom(&out, i == held ? 0 : m->mass[i], m->r + 3 * i);
    for (int64_t b = 0; b < m->n_bonds; ++b)
        if (b != k) molecule_add_bond(&out, m->pairs[2 * b], m->pairs[2 * b + 1]);
    random_stream stream = random_seed(5);
    molecule_finish(&out, &stream);
    return out;
}

/** Multipliers of forces, and velocities and positions as projected, within the bounds of tests/oracle/molecules. */
static void assert_right(const mixture *m, double dt)
{
    double *lambda = untouched((size_t)m->n_bonds), *v = copy_of(m->v, mixture_size(m));
    CHECK(hol_forces(m->chains, m->r, m->v, m->f, lambda, NULL, NULL, HOL_WRITE, NULL));
    CHECK(hol_project_velocities(m->chains, m->r, v, NULL, NULL));
    double *r = copy_of(m->r, mixture_size(m));
    for (size_t i = 0; i < mixture_size(m); ++i) r[i] += dt * v[i];
    double *drifted = copy_of(r, mixture_size(m));
    CHECK(hol_project_positions(m->chains, m->r, r, NULL, dt, NULL, 0, NULL, NULL));
    for (int64_t p = 0; p < m->n_parts; ++p) {
        const molecule *part = m->parts + p;
        const molecule_problem problem = molecule_problem_of(part);
        const size_t size = 3 * (size_t)part->n_atoms;
        const long double unit = oracle_bound(part->n_bonds) * DBL_EPSILON;
        double *multiplier = untouched((size_t)part->n_bonds), *start = untouched(size), *got = untouched(size);
        molecule_solution exact;
        assert_int_equal(molecule_forces(&problem, &exact), 0);
        mixture_take_bonds(m, p, lambda, multiplier);
        for (int64_t k = 0; k < part->n_bonds; ++k)
            CHECK_AT_MOST(fabsl(multiplier[k] - exact.lambda[k]), unit * exact.lambda_scale[k]);
        molecule_solution_free(&exact);
        assert_int_equal(molecule_velocities(&problem, &exact), 0);
        mixture_take(m, p, v, got);
        for (size_t i = 0; i < size; ++i)
            CHECK_AT_MOST(fabsl(got[i] - exact.moved[i]), unit * exact.moved_scale[i / 3]);
        molecule_solution_free(&exact);
        mixture_take(m, p, drifted, start);
        mixture_take(m, p, r, got);
        assert_int_equal(molecule_positions(&problem, start, NULL, part->length, dt, &exact), 0);
        for (size_t i = 0; i < size; ++i)
            CHECK_AT_MOST(fabsl(got[i] - exact.moved[i]), unit * exact.moved_scale[i / 3]);
        molecule_solution_free(&exact);
        free(multiplier), free(start), free(got);
    }
    free(lambda), free(v), free(r), free(drifted);
}

static void strips_of_every_size_agree_with_a_solution_in_many_digits(void **state)
{
    (void)state;
    static const molecule_kind kinds[] = {MOLECULE_TRIANGLES, MOLECULE_ZIGZAG, MOLECULE_TRIANGLES_179};
    for (size_t k = 0; k < sizeof kinds / sizeof *kinds; ++k) {
        mixture m = mixture_of_kind(kinds[k], quick_run() ? 12 : 60, 4, 40, MIXED, 300 + k);
        assert_right(&m, kinds[k] == MOLECULE_TRIANGLES_179 ? 1e-5 : 1e-3);
        mixture_free(&m);
    }
}

static void nearly_strips_are_right_too(void **state)
{
    (void)state;
    enum { N = 8 };
    molecule parts[N], strip = molecule_make(MOLECULE_TRIANGLES, 12, 7);
    for (int64_t k = 0; k < N; ++k) parts[k] = k % 2 ? altered(&strip, 2 + k, -1) : altered(&strip, -1, k);
    mixture m = mixture_make(parts, N, MIXED, 8);
    assert_right(&m, 1e-3);
    mixture_free(&m);
    for (int64_t k = 0; k < N; ++k) molecule_free(parts + k);
    molecule_free(&strip);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(strips_of_every_size_agree_with_a_solution_in_many_digits),
        cmocka_unit_test(nearly_strips_are_right_too),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
