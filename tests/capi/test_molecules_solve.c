/** hol_solve: multipliers of given right-hand sides, for molecules of any shape. */
#include "check.h"
#include "mixture.h"
#include "molecule_solution.h"
#include "random.h"

static double *right_hand_side(const mixture *m, uint64_t seed)
{
    random_stream s = random_seed(seed);
    double *rhs = untouched((size_t)m->n_bonds);
    for (int64_t k = 0; k < m->n_bonds; ++k) rhs[k] = m->length[k] * m->length[k] * random_normal(&s);
    return rhs;
}

static void solve_agrees_with_a_dense_solution(void **state)
{
    (void)state;
    mixture m = mixture_of_all(quick_run() ? 1 : 3, MIXED, 1);
    double *rhs = right_hand_side(&m, 2), *lambda = untouched((size_t)m.n_bonds), *g = untouched(mixture_size(&m));
    double virial[9];
    long double expected[9] = {0}, allowed = 0;
    CHECK(hol_solve(m.chains, m.r, rhs, lambda, g, HOL_WRITE, virial));
    for (int64_t p = 0; p < m.n_parts; ++p) {
        const molecule *part = m.parts + p;
        const molecule_problem problem = molecule_problem_of(part);
        const long double unit = oracle_bound(part->n_bonds) * DBL_EPSILON;
        double *of_part = untouched((size_t)part->n_bonds), *got = untouched((size_t)part->n_bonds);
        double *force = untouched(3 * (size_t)part->n_atoms);
        molecule_solution exact;
        mixture_take_bonds(&m, p, rhs, of_part);
        mixture_take_bonds(&m, p, lambda, got);
        mixture_take(&m, p, g, force);
        assert_int_equal(molecule_solve(&problem, of_part, &exact), 0);
        for (int64_t k = 0; k < part->n_bonds; ++k)
            CHECK_AT_MOST(fabsl(got[k] - exact.lambda[k]), unit * exact.lambda_scale[k]);
        for (int64_t i = 0; i < 3 * part->n_atoms; ++i)
            if (exact.g_scale[i / 3] > 0) CHECK_AT_MOST(fabsl(force[i] - exact.g[i]), unit * exact.g_scale[i / 3]);
        for (int i = 0; i < 9; ++i) expected[i] += exact.virial[i];
        allowed += unit * exact.virial_scale;
        free(of_part), free(got), free(force);
        molecule_solution_free(&exact);
    }
    for (int i = 0; i < 9; ++i) CHECK_AT_MOST(fabsl(virial[i] - expected[i]), 2 * allowed);
    free(rhs), free(lambda), free(g);
    mixture_free(&m);
}

static void multipliers_may_replace_the_right_hand_side(void **state)
{
    (void)state;
    mixture m = mixture_of_all(1, MIXED, 3);
    double *rhs = right_hand_side(&m, 4), *lambda = untouched((size_t)m.n_bonds);
    CHECK(hol_solve(m.chains, m.r, rhs, lambda, NULL, HOL_WRITE, NULL));
    CHECK(hol_solve(m.chains, m.r, rhs, rhs, NULL, HOL_WRITE, NULL));
    assert_same_bits(rhs, lambda, (size_t)m.n_bonds);
    free(rhs), free(lambda);
    mixture_free(&m);
}

/** rhs_k = 2 d.(w_j f_j - w_i f_i) + 2 |dv|^2 gives what hol_forces gives, to the rounding of this right-hand side. */
static void right_hand_side_of_the_forces_gives_their_multipliers(void **state)
{
    (void)state;
    mixture m = mixture_of_kind(MOLECULE_PEPTIDE, 6, 1, 2, ONE_AFTER_THE_OTHER, 5);
    double *rhs = untouched((size_t)m.n_bonds), *lambda = untouched((size_t)m.n_bonds),
           *expected = untouched((size_t)m.n_bonds);
    long double largest = 0;
    CHECK(hol_forces(m.chains, m.r, m.v, m.f, expected, NULL, NULL, HOL_WRITE, NULL));
    for (int64_t k = 0; k < m.n_bonds; ++k) {
        const int64_t i = m.pairs[2 * k], j = m.pairs[2 * k + 1];
        long double sum = 0;
        for (int x = 0; x < 3; ++x) {
            const long double d = (long double)m.r[3 * j + x] - m.r[3 * i + x],
                              dv = (long double)m.v[3 * j + x] - m.v[3 * i + x];
            sum += 2 * (d * (m.f[3 * j + x] / m.mass[j] - m.f[3 * i + x] / m.mass[i]) + dv * dv);
        }
        rhs[k] = (double)sum;
        largest = fmaxl(largest, fabs(expected[k]));
    }
    CHECK(hol_solve(m.chains, m.r, rhs, lambda, NULL, HOL_WRITE, NULL));
    /* the condition number is about 50 */
    for (int64_t k = 0; k < m.n_bonds; ++k) CHECK_AT_MOST(fabs(lambda[k] - expected[k]), 1000 * DBL_EPSILON * largest);
    free(rhs), free(lambda), free(expected);
    mixture_free(&m);
}

static void forces_of_a_right_hand_side_are_added_where_asked(void **state)
{
    (void)state;
    mixture m = mixture_of_kind(MOLECULE_TREE, 10, 3, 12, MIXED, 6);
    double *rhs = right_hand_side(&m, 7), *g = untouched(mixture_size(&m)), *sum = copy_of(m.f, mixture_size(&m));
    CHECK(hol_solve(m.chains, m.r, rhs, NULL, g, HOL_WRITE, NULL));
    CHECK(hol_solve(m.chains, m.r, rhs, NULL, sum, HOL_ADD, NULL));
    for (size_t i = 0; i < mixture_size(&m); ++i)
        if (!isnan(m.f[i])) assert_true(sum[i] == m.f[i] + g[i]);
    free(rhs), free(g), free(sum);
    mixture_free(&m);
}

static void solve_rejects_null_and_a_wrong_mode(void **state)
{
    (void)state;
    mixture m = mixture_of_kind(MOLECULE_WATER, 2, 3, 3, ONE_AFTER_THE_OTHER, 8);
    double rhs[6] = {0}, *lambda = untouched(6);
    CHECK_FAILS(HOL_ERR_NULL, hol_solve(NULL, m.r, rhs, lambda, NULL, HOL_WRITE, NULL));
    CHECK_FAILS(HOL_ERR_NULL, hol_solve(m.chains, NULL, rhs, lambda, NULL, HOL_WRITE, NULL));
    CHECK_FAILS(HOL_ERR_NULL, hol_solve(m.chains, m.r, NULL, lambda, NULL, HOL_WRITE, NULL));
    CHECK_FAILS(HOL_ERR_VALUE, hol_solve(m.chains, m.r, rhs, lambda, NULL, 7, NULL));
    assert_untouched(lambda, 6);
    rhs[4] = INFINITY;
    CHECK_FAILS(HOL_ERR_NOT_FINITE, hol_solve(m.chains, m.r, rhs, lambda, NULL, HOL_WRITE, NULL));
    assert_untouched(lambda + 3, 3);
    for (int k = 0; k < 3; ++k) assert_true(lambda[k] == 0);
    free(lambda);
    mixture_free(&m);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(solve_agrees_with_a_dense_solution),
        cmocka_unit_test(multipliers_may_replace_the_right_hand_side),
        cmocka_unit_test(right_hand_side_of_the_forces_gives_their_multipliers),
        cmocka_unit_test(forces_of_a_right_hand_side_are_added_where_asked),
        cmocka_unit_test(solve_rejects_null_and_a_wrong_mode),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
