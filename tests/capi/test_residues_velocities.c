/** Velocities of large molecules of repeating units: projected onto the constraints, and in a box that changes. */
#include "box_rate.h"
#include "equations.h"
#include "residue_checks.h"

enum { DENSE = 330, LARGE = 2400 };

/** Twice: when velocities are projected already, multipliers are what rounding has left. */
static void project(residues *s)
{
    const int64_t n = s->m.n_bonds, size = 3 * s->m.n_atoms;
    double *lambda = untouched((size_t)n), *alone = untouched((size_t)n), virial[9];
    for (int turn = 0; turn < 2; ++turn) {
        double *v = copy_of(s->m.v, (size_t)size), *only = copy_of(s->m.v, (size_t)size);
        CHECK(hol_project_velocities(s->chains, s->m.r, v, lambda, virial));
        check_rates(s, NULL, v, NULL);
        check_moves(s, s->m.v, v, lambda);
        check_pulls(s, lambda, NULL, NULL, virial);
        leave_roundings_in_box(&s->m, residues_box(s), lambda, s->m.v, NULL, 1, NULL);
        CHECK(hol_project_velocities(s->chains, s->m.r, only, NULL, NULL));
        assert_same_bits(only, v, (size_t)size);
        memcpy(only, s->m.v, (size_t)size * sizeof *v);
        CHECK(hol_project_velocities(s->chains, s->m.r, only, alone, NULL));
        assert_same_bits(alone, lambda, (size_t)n);
        memcpy(s->m.v, v, (size_t)size * sizeof *v);
        free(v), free(only);
    }
    free(lambda), free(alone);
}
static void velocities_of_large_ones_obey_the_constraints(void **state)
{
    (void)state;
    for_each_residues(LARGE, 1, project);
}

static void agree(residues *s)
{
    const molecule_problem p = residues_problem(s);
    const size_t n = (size_t)s->m.n_bonds, size = 3 * (size_t)s->m.n_atoms;
    double *lambda = untouched(n), *v = copy_of(s->m.v, size);
    for (int turn = 0; turn < (quick_run() ? 1 : 2); ++turn) {
        molecule_solution exact;
        double virial[9];
        assert_int_equal(molecule_velocities(&p, &exact), 0);
        CHECK(hol_project_velocities(s->chains, s->m.r, v, lambda, virial));
        for (int c = 0; c < 9; ++c)
            CHECK_AT_MOST(fabsl(virial[c] - exact.virial[c]), residue_unit(s) * exact.virial_scale);
        check_solution(s, lambda, v, &exact);
        memcpy(s->m.v, v, size * sizeof *v);
    }
    free(lambda), free(v);
}
static void velocities_agree_with_a_solution_in_many_digits(void **state)
{
    (void)state;
    for_each_residues(DENSE, 1, agree);
}

static void stay_at_rest(residues *s)
{
    const size_t n = (size_t)s->m.n_bonds, size = 3 * (size_t)s->m.n_atoms;
    double *v = calloc(size, sizeof *v), *lambda = untouched(n), virial[9];
    CHECK(hol_project_velocities(s->chains, s->m.r, v, lambda, virial));
    for (size_t i = 0; i < size; ++i) assert_true(v[i] == 0);
    for (size_t k = 0; k < n; ++k) assert_true(lambda[k] == 0);
    for (int c = 0; c < 9; ++c) assert_true(virial[c] == 0);
    if (s->recipe->fixed == 0) {
        const double drift[3] = {3, -1,
                                 0.5}; /* of all atoms together: no bond changes, but for rounding of light ones */
        for (size_t i = 0; i < size; ++i) v[i] = drift[i % 3];
        CHECK(hol_project_velocities(s->chains, s->m.r, v, NULL, NULL));
        for (size_t i = 0; i < size; ++i) CHECK_AT_MOST(fabs(v[i] - drift[i % 3]), 1e-13);
    }
    free(v), free(lambda);
}
static void what_is_at_rest_or_moves_as_a_whole_goes_on(void **state)
{
    (void)state;
    for_each_residues(LARGE / 2, 1, stay_at_rest);
}

/** |u|^2 of u = v_j - v_i + L d in the forces, d.u = 0 for the velocities; the same as a molecule whose velocities are
 * v + L r, in long double. */
static void follow_the_box(residues *s)
{
    const molecule *m = &s->m;
    const size_t n = (size_t)m->n_bonds, size = 3 * (size_t)m->n_atoms;
    double *lambda = untouched(n), *g = untouched(size), *v = copy_of(m->v, size), *mu = untouched(n), virial[9];
    double *rhs = calloc(n, sizeof *rhs), *expected = untouched(n);
    CHECK(hol_chains_set_box_rate(s->chains, L));
    CHECK(hol_project_velocities(s->chains, m->r, v, mu, virial));
    check_rates(s, NULL, v, L);
    check_moves(s, s->m.v, v, mu);
    check_pulls(s, mu, NULL, NULL, virial);
    CHECK(hol_forces(s->chains, m->r, m->v, m->f, lambda, NULL, g, HOL_WRITE, virial));
    check_pulls(s, lambda, g, NULL, virial);
    double largest = 0;
    for (size_t k = 0; k < n; ++k) {
        const int64_t i = m->pairs[2 * k], j = m->pairs[2 * k + 1];
        long double d[3], Ld[3], sum = 0;
        bond_in_box(m->r, m->pairs + 2 * k, residues_box(s), d);
        rate_times(L, d, Ld);
        for (int c = 0; c < 3; ++c) {
            const long double u = (long double)m->v[3 * j + c] - m->v[3 * i + c] + Ld[c];
            sum += 2 * d[c] *
                       ((long double)m->inverse_mass[j] * m->f[3 * j + c] -
                        (long double)m->inverse_mass[i] * m->f[3 * i + c]) +
                   2 * u * u;
        }
        rhs[k] = (double)sum;
        largest = fmax(largest, fabs(lambda[k]));
    }
    CHECK(hol_solve(s->chains, m->r, rhs, expected, NULL, HOL_WRITE, NULL));
    const double conditioned = s->recipe->bridges + s->recipe->closed ? 1e5 : 1e4;
    for (size_t k = 0; k < n; ++k) CHECK_AT_MOST(fabs(lambda[k] - expected[k]), conditioned * DBL_EPSILON * largest);
    CHECK(hol_chains_set_box_rate(s->chains, NULL));
    free(lambda), free(g), free(v), free(mu), free(rhs), free(expected);
}
static void in_a_box_that_changes_bonds_keep_their_lengths(void **state)
{
    (void)state;
    for_each_residues(LARGE / 2, 0, follow_the_box);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(velocities_of_large_ones_obey_the_constraints),
        cmocka_unit_test(velocities_agree_with_a_solution_in_many_digits),
        cmocka_unit_test(what_is_at_rest_or_moves_as_a_whole_goes_on),
        cmocka_unit_test(in_a_box_that_changes_bonds_keep_their_lengths),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
