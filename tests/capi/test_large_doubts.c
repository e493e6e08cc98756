/**
 * Large molecules of whose equations a few are in doubt: what multipliers leave of each, found with more digits, is
 * what is promised, and what their own rounding does.
 */
#include <stdlib.h>

#include "check.h"
#include "large.h"
#include "molecule_solution.h"
#include "random.h"

/** Nearly straight strands between nodes anywhere, four at each. */
static molecule straight_gel(int64_t nodes, int64_t bonds)
{
    molecule m = molecule_empty();
    random_stream random = random_seed(2);
    int64_t *stub = malloc(4 * (size_t)nodes * sizeof *stub);
    for (int64_t i = 0; i < nodes; ++i) {
        double r[3];
        for (int c = 0; c < 3; ++c) r[c] = 20 * random_uniform(&random);
        molecule_add_atom(&m, 1, r);
        for (int e = 0; e < 4; ++e) stub[4 * i + e] = i;
    }
    for (int64_t i = 4 * nodes - 1; i > 0; --i) {
        const int64_t j = (int64_t)((double)(i + 1) * random_uniform(&random)), kept = stub[i];
        stub[i] = stub[j], stub[j] = kept;
    }
    for (int64_t s = 0; s < 2 * nodes; ++s) {
        const int64_t first = stub[2 * s], end = stub[2 * s + 1];
        int64_t last = first;
        for (int64_t k = 1; k <= bonds && first != end; ++k) {
            double r[3];
            for (int c = 0; c < 3; ++c)
                r[c] = m.r[3 * first + c] + (double)k / (double)bonds * (m.r[3 * end + c] - m.r[3 * first + c]) +
                       0.3 * random_uniform(&random);
            const int64_t next = k < bonds ? molecule_add_atom(&m, 1, r) : end;
            molecule_add_bond(&m, last, next);
            last = next;
        }
    }
    free(stub);
    molecule_finish(&m, &random);
    return m;
}

/** Two rails and rungs between them, anywhere. */
static molecule ladder(int64_t rungs)
{
    molecule m = molecule_empty();
    random_stream random = random_seed(2);
    double at[3] = {0, 0, 0}, u[3];
    for (int64_t k = 0; k < rungs; ++k) {
        random_direction(&random, u);
        for (int c = 0; c < 3; ++c) at[c] += u[c];
        const int64_t i = molecule_add_atom(&m, 1, at);
        random_direction(&random, u);
        molecule_grow(&m, i, 1, 1, u);
        for (int side = 0; side < 2 && k > 0; ++side) molecule_add_bond(&m, i - 2 + side, i + side);
    }
    molecule_finish(&m, &random);
    return m;
}

/** The most that is left of an equation, beyond what the rounding of multipliers does, over half of what counts as
 * right and half of that again. Without corrections it is 2.4 of the gel, 1.3 of the ladder. */
static long double most_left(const molecule *m, const double *lambda)
{
    long double *a = calloc(3 * (size_t)m->n_atoms, sizeof *a), worst = 0;
    double *tension = calloc((size_t)m->n_atoms, sizeof *tension);
    for (int64_t i = 0; i < 3 * m->n_atoms; ++i) a[i] = m->f[i];
    for (int64_t k = 0; k < m->n_bonds; ++k) {
        const int64_t i = m->pairs[2 * k], j = m->pairs[2 * k + 1];
        for (int c = 0; c < 3; ++c) {
            const long double pull = 2 * lambda[k] * ((long double)m->r[3 * j + c] - m->r[3 * i + c]);
            a[3 * i + c] += pull;
            a[3 * j + c] -= pull;
        }
        tension[i] += fabs(2 * lambda[k]) * m->length[k] * m->inverse_mass[i];
        tension[j] += fabs(2 * lambda[k]) * m->length[k] * m->inverse_mass[j];
    }
    for (int64_t i = 0; i < 3 * m->n_atoms; ++i) a[i] *= m->inverse_mass[i / 3];
    const long double right = 0.75L * DBL_EPSILON * fminl(128, 16 + sqrtl((long double)m->n_bonds));
    for (int64_t k = 0; k < m->n_bonds; ++k) {
        const int64_t i = m->pairs[2 * k], j = m->pairs[2 * k + 1];
        long double left = 0, terms = 0, at_i = 0, at_j = 0;
        for (int c = 0; c < 3; ++c) {
            const long double d = (long double)m->r[3 * j + c] - m->r[3 * i + c],
                              dv = m->v[3 * j + c] - m->v[3 * i + c];
            left += d * (a[3 * j + c] - a[3 * i + c]) + dv * dv;
            at_i += d * a[3 * i + c];
            at_j += d * a[3 * j + c];
            terms +=
                fabsl(d) * (fabsl(m->inverse_mass[i] * m->f[3 * i + c]) + fabsl(m->inverse_mass[j] * m->f[3 * j + c])) +
                dv * dv;
        }
        terms += fabsl(at_i) + fabsl(at_j);
        const long double rounding = 0.5L * DBL_EPSILON * m->length[k] * (tension[i] + tension[j]);
        worst = fmaxl(worst, (fabsl(left) - rounding) / (right * terms));
    }
    free(a), free(tension);
    return worst;
}

static void check_equations_are_solved(molecule m)
{
    hol_chains *chains = large_chains(&m);
    double *lambda = untouched((size_t)m.n_bonds), *again = untouched((size_t)m.n_bonds);
    CHECK(hol_forces(chains, m.r, m.v, m.f, lambda, NULL, NULL, HOL_WRITE, NULL));
    CHECK_AT_MOST(most_left(&m, lambda), 1);
    CHECK(hol_chains_set_threads(chains, 3));
    CHECK(hol_forces(chains, m.r, m.v, m.f, again, NULL, NULL, HOL_WRITE, NULL));
    assert_same_bits(lambda, again, (size_t)m.n_bonds);
    hol_chains_destroy(chains);
    free(lambda), free(again);
    molecule_free(&m);
}

static void straight_strands_are_solved(void **state)
{
    (void)state;
    check_equations_are_solved(straight_gel(quick_run() ? 60 : 400, 8));
}

static void a_ladder_is_solved(void **state)
{
    (void)state;
    check_equations_are_solved(ladder(quick_run() ? 2000 : 40000));
}

/** An atom of many arms, of two bonds each, and a tree on the last of them whose first atoms have ten children and
 * more. Masses over seven decades. */
static molecule crowded_atom(int64_t arms, int64_t branches)
{
    molecule m = molecule_empty();
    random_stream random = random_seed(6);
    double at[3] = {0, 0, 0}, u[3];
    int64_t end = molecule_add_atom(&m, exp(8 - 16 * random_uniform(&random)), at);
    for (int64_t k = 0; k < 2 * arms; ++k) {
        random_direction(&random, u);
        end = molecule_grow(&m, k % 2 ? end : 0, exp(8 - 16 * random_uniform(&random)), 1, u);
    }
    const int64_t first = end;
    for (int64_t k = 0; k < branches; ++k) {
        const int64_t from = first + (int64_t)((double)(k + 1) * random_uniform(&random));
        random_direction(&random, u);
        molecule_grow(&m, from, exp(8 - 16 * random_uniform(&random)), 1, u);
    }
    molecule_finish(&m, &random);
    return m;
}

/** Twice the precision beside an atom of more bonds than have a table of their products (64). */
static void what_hangs_on_a_crowded_atom_is_solved(void **state)
{
    (void)state;
    for (int64_t branches = 300; branches <= (quick_run() ? 300 : 3000); branches *= 10) {
        molecule m = crowded_atom(70, branches);
        const size_t n = 3 * (size_t)m.n_atoms;
        hol_chains *chains = large_chains(&m);
        hol_worst worst;
        double *r = untouched(n), *v = untouched(n);
        for (size_t i = 0; i < n; ++i) v[i] = m.v[i], r[i] = m.r[i] + 1e-5 * m.v[i];
        CHECK(hol_project_positions(chains, m.r, r, NULL, 1e-5, NULL, 0, NULL, NULL));
        CHECK(hol_violation(chains, r, NULL, &worst));
        CHECK_AT_MOST(worst.length, 1e-12);
        CHECK(hol_project_velocities(chains, m.r, v, NULL, NULL));
        CHECK(hol_violation(chains, m.r, v, &worst));
        CHECK_AT_MOST(worst.rate, 1e-11);
        hol_chains_destroy(chains);
        free(r), free(v);
        check_equations_are_solved(m);
    }
}

/** Three arms that divide in two, level by level. */
static molecule dendrimer(int levels)
{
    molecule m = molecule_empty();
    random_stream random = random_seed(3);
    double at[3] = {0, 0, 0}, u[3];
    int64_t first = molecule_add_atom(&m, 12, at), end = first + 1;
    for (int level = 0; level < levels; ++level) {
        const int64_t last = end;
        for (int64_t i = first; i < last; ++i)
            for (int arm = 0; arm < (level == 0 ? 3 : 2); ++arm) {
                random_direction(&random, u);
                end = molecule_grow(&m, i, 12, 1, u) + 1;
            }
        first = last;
    }
    molecule_finish(&m, &random);
    return m;
}

/** A third of the sides is a thousandth of the others: multipliers that are small differences, whose scales only a row
 * of the inverse tells. */
static void uneven_sides_of_a_large_dendrimer_are_solved(void **state)
{
    (void)state;
    molecule m = dendrimer(quick_run() ? 5 : 10);
    const size_t n = (size_t)m.n_bonds;
    hol_chains *chains = large_chains(&m);
    double *rhs = untouched(n), *lambda = untouched(n), *again = untouched(n);
    const long double unit = oracle_bound(m.n_bonds) * DBL_EPSILON;
    random_stream random = random_seed(5);
    for (size_t k = 0; k < n; ++k) rhs[k] = random_normal(&random) * (random_uniform(&random) < 0.3 ? 1e-3 : 1);
    const molecule_problem problem = molecule_problem_of(&m);
    molecule_solution exact;
    assert_int_equal(molecule_solve(&problem, rhs, &exact), 0);
    CHECK(hol_solve(chains, m.r, rhs, lambda, NULL, HOL_WRITE, NULL));
    for (size_t k = 0; k < n; ++k) CHECK_AT_MOST(fabsl(lambda[k] - exact.lambda[k]), unit * exact.lambda_scale[k]);
    CHECK(hol_chains_set_threads(chains, 3));
    CHECK(hol_solve(chains, m.r, rhs, again, NULL, HOL_WRITE, NULL));
    assert_same_bits(lambda, again, n);
    molecule_solution_free(&exact);
    hol_chains_destroy(chains);
    free(rhs), free(lambda), free(again);
    molecule_free(&m);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(straight_strands_are_solved),
        cmocka_unit_test(a_ladder_is_solved),
        cmocka_unit_test(what_hangs_on_a_crowded_atom_is_solved),
        cmocka_unit_test(uneven_sides_of_a_large_dendrimer_are_solved),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
