/** Constraint forces of molecules of any shape: an independent solution, and what physics demands of them. */
#include "check.h"
#include "mixture_forces.h"
#include "molecule_solution.h"

static void assert_solution(const mixture *m, const double *v, const double *f)
{
    forces_results s = mixture_forces(m, v, f);
    assert_mixture_forces(m, v, f, &s);
    forces_results_free(&s);
}

static void forces_agree_with_a_dense_solution_for_molecules_of_every_shape(void **state)
{
    (void)state;
    for (int how = 0; how < 2; ++how) {
        mixture m = mixture_of_all(quick_run() ? 1 : 4, (mixing)how, 100);
        assert_solution(&m, m.v, m.f);
        assert_solution(&m, m.v, NULL);
        assert_solution(&m, NULL, m.f);
        mixture_free(&m);
    }
}

static void forces_agree_with_a_dense_solution_for_every_size_of_each_shape(void **state)
{
    (void)state;
    static const molecule_kind kinds[] = {MOLECULE_TREE, MOLECULE_RING, MOLECULE_TRIANGLES, MOLECULE_FUSED_RINGS,
                                          MOLECULE_COMB, MOLECULE_STAR, MOLECULE_CHAIN};
    for (size_t k = 0; k < sizeof kinds / sizeof *kinds; ++k) {
        /* many of a size share a block of lanes; a few do not fill one */
        mixture m = mixture_of_kind(kinds[k], quick_run() ? 12 : 100, 3, 14, MIXED, 200 + k);
        assert_solution(&m, m.v, m.f);
        mixture_free(&m);
    }
}

static void thousands_of_waters_in_one_call_are_each_right(void **state)
{
    (void)state;
    mixture m = mixture_of_kind(MOLECULE_WATER, quick_run() ? 50 : 1001, 3, 3, ONE_AFTER_THE_OTHER, 5);
    assert_solution(&m, m.v, m.f);
    mixture_free(&m);
}

/** d.(a_j - a_i) + |v_j - v_i|^2 = 0 with the accelerations that come out, for every bond that can move. */
static void second_derivatives_of_all_bonds_vanish(void **state)
{
    (void)state;
    mixture m = mixture_of_all(3, MIXED, 300);
    forces_results s = mixture_forces(&m, m.v, m.f);
    for (int64_t p = 0; p < m.n_parts; ++p) {
        const molecule *part = m.parts + p;
        const molecule_problem problem = molecule_problem_of(part);
        molecule_solution exact; /* for the sizes of the forces, whose rounding stays */
        assert_int_equal(molecule_forces(&problem, &exact), 0);
        double *g = untouched(3 * (size_t)part->n_atoms);
        mixture_take(&m, p, s.g, g);
        for (int64_t k = 0; k < part->n_bonds; ++k) {
            const int64_t i = part->pairs[2 * k], j = part->pairs[2 * k + 1];
            const double wi = part->inverse_mass[i], wj = part->inverse_mass[j];
            long double sum = 0, size = 0;
            if (wi == 0 && wj == 0) continue;
            for (int x = 0; x < 3; ++x) {
                const long double d = (long double)part->r[3 * j + x] - part->r[3 * i + x];
                const long double dv = (long double)part->v[3 * j + x] - part->v[3 * i + x];
                const long double ai = wi == 0 ? 0 : wi * ((long double)part->f[3 * i + x] + g[3 * i + x]);
                const long double aj = wj == 0 ? 0 : wj * ((long double)part->f[3 * j + x] + g[3 * j + x]);
                sum += d * (aj - ai) + dv * dv;
                size += fabsl(d) * (fabsl(ai) + fabsl(aj) + wi * exact.g_scale[i] + wj * exact.g_scale[j]) + dv * dv;
            }
            CHECK_AT_MOST(fabsl(sum), oracle_bound(part->n_bonds) * DBL_EPSILON * size);
        }
        free(g);
        molecule_solution_free(&exact);
    }
    forces_results_free(&s);
    mixture_free(&m);
}

/** Sum of G, sum of r x G, and the virial as sum of r (x) G, for each molecule by itself. */
static void internal_forces_give_no_total_force_and_no_torque(void **state)
{
    (void)state;
    mixture m = mixture_of_all(2, MIXED, 400);
    forces_results s = mixture_forces(&m, m.v, m.f);
    for (int64_t p = 0; p < m.n_parts; ++p) {
        const molecule *part = m.parts + p;
        double *g = untouched(3 * (size_t)part->n_atoms), *lambda = untouched((size_t)part->n_bonds);
        long double force[3] = {0}, torque[3] = {0}, size = 0, arm = 0;
        mixture_take(&m, p, s.g, g);
        mixture_take_bonds(&m, p, s.lambda, lambda);
        for (int64_t i = 0; i < part->n_atoms; ++i) {
            const double *r = part->r + 3 * i, *gi = g + 3 * i;
            if (isnan(gi[0])) continue; /* not written: an atom without a constraint */
            for (int x = 0; x < 3; ++x) {
                const int y = (x + 1) % 3, z = (x + 2) % 3;
                force[x] += gi[x];
                torque[x] += (long double)r[y] * gi[z] - (long double)r[z] * gi[y];
                arm = fmaxl(arm, fabs(r[x]));
            }
        }
        for (int64_t k = 0; k < part->n_bonds; ++k) size += 12 * fabs(lambda[k]) * part->length[k];
        for (int x = 0; x < 3; ++x) {
            CHECK_AT_MOST(fabsl(force[x]), DBL_EPSILON * size);
            CHECK_AT_MOST(fabsl(torque[x]), 4 * DBL_EPSILON * size * arm);
        }
        free(g), free(lambda);
    }
    forces_results_free(&s);
    mixture_free(&m);
}

static void virial_is_the_sum_of_positions_times_forces(void **state)
{
    (void)state;
    mixture m = mixture_of_all(1, ONE_AFTER_THE_OTHER, 500);
    forces_results s = mixture_forces(&m, m.v, m.f);
    long double sum[9] = {0}, size = 0;
    for (int64_t i = 0; i < m.n_atoms; ++i)
        for (int n = 0; n < 9; ++n) {
            if (isnan(s.g[3 * i])) continue;
            const long double term = (long double)m.r[3 * i + n / 3] * s.g[3 * i + n % 3];
            sum[n] += term;
            size += fabsl(term);
        }
    for (int n = 0; n < 9; ++n) {
        CHECK_AT_MOST(fabsl(s.virial[n] - sum[n]), 64 * DBL_EPSILON * size);
        assert_true(s.virial[n] == s.virial[3 * (n % 3) + n / 3]);
    }
    forces_results_free(&s);
    mixture_free(&m);
}

static void forces_are_added_to_what_is_there_and_may_replace_the_applied_ones(void **state)
{
    (void)state;
    mixture m = mixture_of_all(1, MIXED, 600);
    forces_results s = mixture_forces(&m, m.v, m.f);
    double *sum = copy_of(m.f, mixture_size(&m));
    CHECK(hol_forces(m.chains, m.r, m.v, sum, NULL, NULL, sum, HOL_ADD, NULL));
    for (size_t i = 0; i < mixture_size(&m); ++i)
        if (!isnan(m.f[i]) && !isnan(s.g[i])) assert_true(sum[i] == m.f[i] + s.g[i]);
    free(sum);
    forces_results_free(&s);
    mixture_free(&m);
}

static void at_rest_and_without_forces_all_multipliers_are_zero(void **state)
{
    (void)state;
    mixture m = mixture_of_all(1, MIXED, 700);
    forces_results s = mixture_forces(&m, NULL, NULL);
    for (int64_t k = 0; k < m.n_bonds; ++k) assert_true(s.lambda[k] == 0 && s.tension[k] == 0);
    for (int i = 0; i < 9; ++i) assert_true(s.virial[i] == 0);
    forces_results_free(&s);
    mixture_free(&m);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(forces_agree_with_a_dense_solution_for_molecules_of_every_shape),
        cmocka_unit_test(forces_agree_with_a_dense_solution_for_every_size_of_each_shape),
        cmocka_unit_test(thousands_of_waters_in_one_call_are_each_right),
        cmocka_unit_test(second_derivatives_of_all_bonds_vanish),
        cmocka_unit_test(internal_forces_give_no_total_force_and_no_torque),
        cmocka_unit_test(virial_is_the_sum_of_positions_times_forces),
        cmocka_unit_test(forces_are_added_to_what_is_there_and_may_replace_the_applied_ones),
        cmocka_unit_test(at_rest_and_without_forces_all_multipliers_are_zero),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
