/** Constraint forces of large molecules of repeating units, and multipliers of given right-hand sides. */
#include "equations.h"
#include "residue_checks.h"

enum { DENSE = 330, LARGE = 2400 };

typedef struct results {
    double *lambda, *tension, *g, virial[9];
} results;

static results compute(const residues *s, const double *v, const double *f)
{
    const size_t n = (size_t)s->m.n_bonds;
    results x = {untouched(n), untouched(n), untouched(3 * (size_t)s->m.n_atoms), {0}};
    CHECK(hol_forces(s->chains, s->m.r, v, f, x.lambda, x.tension, x.g, HOL_WRITE, x.virial));
    return x;
}

static void release(results *x)
{
    free(x->lambda), free(x->tension), free(x->g);
}

static void agree(const residues *s, const double *v, const double *f)
{
    results x = compute(s, v, f);
    molecule_problem p = residues_problem(s);
    molecule_solution exact;
    p.v = v, p.f = f;
    assert_int_equal(molecule_forces(&p, &exact), 0);
    for (int64_t i = 0; i < 3 * s->m.n_atoms; ++i)
        CHECK_AT_MOST(fabsl(x.g[i] - exact.g[i]), residue_unit(s) * exact.g_scale[i / 3]);
    for (int n = 0; n < 9; ++n)
        CHECK_AT_MOST(fabsl(x.virial[n] - exact.virial[n]), residue_unit(s) * exact.virial_scale);
    check_solution(s, x.lambda, NULL, &exact);
    check_pulls(s, x.lambda, x.g, x.tension, x.virial);
    release(&x);
}

static void agree_at_rest_and_moving(residues *s)
{
    agree(s, s->m.v, s->m.f);
    if (quick_run()) return;
    agree(s, NULL, s->m.f);
    residues_project(s);
    agree(s, s->m.v, NULL);
}
static void forces_agree_with_a_solution_in_many_digits(void **state)
{
    (void)state;
    for_each_residues(DENSE, 1, agree_at_rest_and_moving);
}

static void leave_roundings(residues *s)
{
    const double *const v[3] = {s->m.v, NULL, s->m.v}, *const f[3] = {s->m.f, s->m.f, NULL};
    for (int how = 0; how < 3; ++how) {
        results x = compute(s, v[how], f[how]);
        leave_roundings_in_box(&s->m, residues_box(s), x.lambda, v[how], f[how], 0, NULL);
        check_pulls(s, x.lambda, x.g, x.tension, x.virial);
        release(&x);
    }
}
static void forces_of_large_ones_leave_roundings_of_their_equations(void **state)
{
    (void)state;
    for_each_residues(LARGE, 1, leave_roundings);
}

/** Any of the outputs by itself has the bits that it has beside the others. */
static void give_each_output_alone(residues *s)
{
    const size_t n = (size_t)s->m.n_bonds, size = 3 * (size_t)s->m.n_atoms;
    for (int moving = 0; moving < 2; ++moving) {
        const double *const v = moving ? s->m.v : NULL;
        results x = compute(s, v, s->m.f);
        double *lambda = untouched(n), *tension = untouched(n), *g = untouched(size), *sum = copy_of(s->m.f, size);
        double virial[9];
        CHECK(hol_forces(s->chains, s->m.r, v, s->m.f, lambda, NULL, NULL, HOL_WRITE, NULL));
        CHECK(hol_forces(s->chains, s->m.r, v, s->m.f, NULL, tension, NULL, HOL_WRITE, NULL));
        CHECK(hol_forces(s->chains, s->m.r, v, s->m.f, NULL, NULL, g, HOL_WRITE, NULL));
        CHECK(hol_forces(s->chains, s->m.r, v, s->m.f, NULL, NULL, NULL, HOL_WRITE, virial));
        CHECK(hol_forces(s->chains, s->m.r, v, sum, NULL, NULL, sum, HOL_ADD, NULL));
        assert_same_bits(lambda, x.lambda, n);
        assert_same_bits(tension, x.tension, n);
        assert_same_bits(g, x.g, size);
        assert_same_bits(virial, x.virial, 9);
        for (size_t i = 0; i < size; ++i) assert_true(sum[i] == s->m.f[i] + x.g[i]);
        free(lambda), free(tension), free(g), free(sum);
        release(&x);
    }
}
static void each_output_is_the_same_alone_and_forces_are_added(void **state)
{
    (void)state;
    for_each_residues(LARGE / 2, 1, give_each_output_alone);
}

/** Multipliers of free fall are what rounding of the forces leaves; at rest without forces they are zero. */
static void feel_nothing(residues *s)
{
    const double gravity[3] = {0.3, -9.8, 1.7};
    if (s->recipe->fixed > 0) return;
    double largest = 0;
    for (int64_t i = 0; i < 3 * s->m.n_atoms; ++i) s->m.f[i] = gravity[i % 3] * s->m.mass[i / 3];
    for (int64_t i = 0; i < s->m.n_atoms; ++i) largest = fmax(largest, s->m.mass[i] * 10);
    results x = compute(s, NULL, s->m.f);
    leave_roundings_in_box(&s->m, residues_box(s), x.lambda, NULL, s->m.f, 0, NULL);
    for (int64_t k = 0; k < s->m.n_bonds; ++k) CHECK_AT_MOST(fabs(x.tension[k]), 1e4 * DBL_EPSILON * largest);
    check_pulls(s, x.lambda, x.g, x.tension, x.virial);
    release(&x);
    x = compute(s, NULL, NULL);
    for (int64_t k = 0; k < s->m.n_bonds; ++k) assert_true(x.lambda[k] == 0 && x.tension[k] == 0);
    for (int n = 0; n < 9; ++n) assert_true(x.virial[n] == 0);
    release(&x);
}
static void in_free_fall_and_at_rest_nothing_is_felt(void **state)
{
    (void)state;
    for_each_residues(LARGE / 2, 1, feel_nothing);
}

/** Right-hand sides everywhere, at links alone, and at one bond within a residue. */
static void solve_equations(residues *s, int64_t dense)
{
    const int64_t n = s->m.n_bonds;
    double *rhs = calloc((size_t)n, sizeof *rhs), *lambda = untouched((size_t)n);
    double *g = untouched(3 * (size_t)s->m.n_atoms), virial[9];
    for (int which = 0; which < 3; ++which) {
        random_stream random = random_seed((uint64_t)which);
        for (int64_t k = 0; k < n; ++k) {
            const double any = s->m.length[k] * s->m.length[k] * random_normal(&random);
            const int here = which == 0 || (which == 1 ? residues_link(s, k) : k == n / 2);
            rhs[k] = here ? any : 0;
        }
        CHECK(hol_solve(s->chains, s->m.r, rhs, lambda, g, HOL_WRITE, virial));
        check_pulls(s, lambda, g, NULL, virial);
        leave_roundings_in_box(&s->m, residues_box(s), lambda, NULL, NULL, 0, rhs);
        if (n > dense || which == 1) continue;
        const molecule_problem p = residues_problem(s);
        molecule_solution exact;
        assert_int_equal(molecule_solve(&p, rhs, &exact), 0);
        check_solution(s, lambda, NULL, &exact);
    }
    CHECK(hol_solve(s->chains, s->m.r, rhs, rhs, NULL, HOL_WRITE, NULL)); /* in place, and the multipliers alone */
    assert_same_bits(rhs, lambda, (size_t)n);
    free(rhs), free(lambda), free(g);
}
static void solve_small(residues *s)
{
    solve_equations(s, quick_run() ? 0 : 2 * DENSE);
}
static void solve_large(residues *s)
{
    solve_equations(s, 0);
}
static void given_right_hand_sides_are_solved(void **state)
{
    (void)state;
    for_each_residues(DENSE, 1, solve_small);
    for_each_residues(LARGE, 1, solve_large);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(forces_agree_with_a_solution_in_many_digits),
        cmocka_unit_test(forces_of_large_ones_leave_roundings_of_their_equations),
        cmocka_unit_test(each_output_is_the_same_alone_and_forces_are_added),
        cmocka_unit_test(in_free_fall_and_at_rest_nothing_is_felt),
        cmocka_unit_test(given_right_hand_sides_are_solved),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
