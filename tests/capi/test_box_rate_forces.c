/** What else than velocities knows that a box changes: forces, violations; what a rate does not touch. */
#include "box_rate.h"
#include "check.h"
#include "mixture.h"
#include "molecule_solution.h"

static void violation_measures_the_whole_motion(void **state)
{
    (void)state;
    mixture m = mixture_of_kind(MOLECULE_XH3, 5, 3, 3, MIXED, 9);
    hol_worst worst;
    long double largest = 0;
    CHECK(hol_chains_set_box_rate(m.chains, L));
    CHECK(hol_violation(m.chains, m.r, m.v, &worst));
    for (int64_t k = 0; k < m.n_bonds; ++k) {
        long double terms;
        const long double rate = fabsl(rate_of_bond(m.r, m.v, m.pairs[2 * k], m.pairs[2 * k + 1], NULL, &terms));
        if (rate > largest) largest = rate;
    }
    CHECK_AT_MOST(fabsl(worst.rate - largest), 16 * DBL_EPSILON * largest);
    CHECK(hol_violation(m.chains, m.r, NULL, &worst));
    assert_true(worst.rate == 0 && worst.rate_molecule == -1);
    mixture_free(&m);
}

/** sigma''/2 = d.(A_j - A_i) + |v_j - v_i + L d|^2 = 0 with A = w (f + G). */
static void forces_keep_the_lengths_of_the_whole_motion(void **state)
{
    (void)state;
    mixture m = mixture_of_all(1, MIXED, 11);
    const size_t size = mixture_size(&m), n = (size_t)m.n_bonds;
    double *lambda = untouched(n), *tension = untouched(n), *g = untouched(size), virial[9];
    CHECK(hol_chains_set_box_rate(m.chains, L));
    CHECK(hol_forces(m.chains, m.r, m.v, m.f, lambda, tension, g, HOL_WRITE, virial));
    for (int64_t p = 0; p < m.n_parts; ++p) {
        const molecule *part = m.parts + p;
        const molecule_problem problem = molecule_problem_of(part);
        const long double unit = 2 * oracle_bound(part->n_bonds) * DBL_EPSILON;
        double *rhs = untouched((size_t)part->n_bonds), *got = untouched(3 * (size_t)part->n_atoms),
               *mu = untouched((size_t)part->n_bonds), *T = untouched((size_t)part->n_bonds);
        molecule_solution exact;
        for (int64_t k = 0; k < part->n_bonds; ++k) {
            const int64_t i = part->pairs[2 * k], j = part->pairs[2 * k + 1];
            long double d[3], Ld[3], sum = 0;
            for (int x = 0; x < 3; ++x) d[x] = (long double)part->r[3 * j + x] - part->r[3 * i + x];
            rate_times(L, d, Ld);
            for (int x = 0; x < 3; ++x) {
                const long double u = (long double)part->v[3 * j + x] - part->v[3 * i + x] + Ld[x];
                sum += u * u + d[x] * ((long double)part->inverse_mass[j] * part->f[3 * j + x] -
                                       (long double)part->inverse_mass[i] * part->f[3 * i + x]);
            }
            rhs[k] = (double)(2 * sum);
        }
        assert_int_equal(molecule_solve(&problem, rhs, &exact), 0);
        mixture_take(&m, p, g, got);
        mixture_take_bonds(&m, p, lambda, mu);
        mixture_take_bonds(&m, p, tension, T);
        /* the right-hand sides lose digits where d.w f cancels, up to a factor of their condition */
        for (int64_t k = 0; k < part->n_bonds; ++k) {
            CHECK_AT_MOST(fabsl(mu[k] - exact.lambda[k]), 64 * unit * exact.lambda_scale[k]);
            if (part->mass[part->pairs[2 * k]] == 0 && part->mass[part->pairs[2 * k + 1]] == 0) continue;
            const double *ri = part->r + 3 * part->pairs[2 * k], *rj = part->r + 3 * part->pairs[2 * k + 1];
            const double expected =
                2 * mu[k] * sqrt(pow(rj[0] - ri[0], 2) + pow(rj[1] - ri[1], 2) + pow(rj[2] - ri[2], 2));
            CHECK_AT_MOST(fabs(T[k] - expected), 8 * DBL_EPSILON * fabs(expected));
        }
        for (int64_t i = 0; i < 3 * part->n_atoms; ++i)
            if (exact.g_scale[i / 3] > 0) CHECK_AT_MOST(fabsl(got[i] - exact.g[i]), 64 * unit * exact.g_scale[i / 3]);
        free(rhs), free(got), free(mu), free(T);
        molecule_solution_free(&exact);
    }
    free(lambda), free(tension), free(g);
    mixture_free(&m);
}

static void bad_and_inactive_molecules_are_left_alone(void **state)
{
    (void)state;
    const double not_finite[9] = {0, 0, 0, 0, INFINITY, 0, 0, 0, 0};
    mixture m = mixture_of_kind(MOLECULE_CHAIN, 30, 1, 7, ONE_AFTER_THE_OTHER, 12);
    const size_t size = mixture_size(&m);
    double *v = copy_of(m.v, size), *good = copy_of(m.v, size), *bad, *lambda = untouched((size_t)m.n_bonds);
    unsigned char active[30];
    CHECK_FAILS(HOL_ERR_NULL, hol_chains_set_box_rate(NULL, L));
    CHECK(hol_chains_set_box_rate(m.chains, L));
    CHECK_FAILS(HOL_ERR_VALUE, hol_chains_set_box_rate(m.chains, not_finite));
    assert_message_names("(2,2)");
    CHECK(hol_project_velocities(m.chains, m.r, good, NULL, NULL));
    v[3 * m.first_atom[17] + 1] = NAN;
    bad = copy_of(v, size);
    CHECK_FAILS(HOL_ERR_NOT_FINITE, hol_project_velocities(m.chains, m.r, v, lambda, NULL));
    char name[40];
    snprintf(name, sizeof name, "velocity of atom %lld", (long long)m.first_atom[17]);
    assert_message_names(name);
    for (int64_t p = 0; p < 30; ++p) {
        const size_t at = 3 * (size_t)m.first_atom[p], n = 3 * (size_t)m.parts[p].n_atoms;
        assert_same_bits(v + at, (p == 17 ? bad : good) + at, n);
    }
    assert_untouched(lambda + m.first_bond[17], (size_t)m.parts[17].n_bonds);
    memset(active, 1, sizeof active);
    active[17] = 0;
    CHECK(hol_chains_set_active(m.chains, active));
    CHECK(hol_project_velocities(m.chains, m.r, v, NULL, NULL));
    free(v), free(good), free(bad), free(lambda);
    mixture_free(&m);
}

static void zeros_are_no_rate(void **state)
{
    (void)state;
    const double none[9] = {0};
    mixture m = mixture_of_all(1, MIXED, 7);
    const size_t size = mixture_size(&m);
    double *v = copy_of(m.v, size), *u = copy_of(m.v, size), *g = untouched(size), *h = untouched(size);
    CHECK(hol_project_velocities(m.chains, m.r, v, NULL, NULL));
    CHECK(hol_forces(m.chains, m.r, m.v, m.f, NULL, NULL, g, HOL_WRITE, NULL));
    CHECK(hol_chains_set_box_rate(m.chains, L));
    CHECK(hol_chains_set_box_rate(m.chains, none));
    CHECK(hol_project_velocities(m.chains, m.r, u, NULL, NULL));
    assert_same_bits(v, u, size);
    CHECK(hol_chains_set_box_rate(m.chains, L));
    CHECK(hol_chains_set_box_rate(m.chains, NULL));
    CHECK(hol_forces(m.chains, m.r, m.v, m.f, NULL, NULL, h, HOL_WRITE, NULL));
    assert_same_bits(g, h, size);
    free(v), free(u), free(g), free(h);
    mixture_free(&m);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(violation_measures_the_whole_motion),
        cmocka_unit_test(forces_keep_the_lengths_of_the_whole_motion),
        cmocka_unit_test(bad_and_inactive_molecules_are_left_alone),
        cmocka_unit_test(zeros_are_no_rate),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
