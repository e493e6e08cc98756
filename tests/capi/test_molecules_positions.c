/** Position projection of molecules of any shape. */
#include "check.h"
#include "mixture.h"
#include "molecule_solution.h"

/** Velocities that obey the constraints: with others a stiff molecule leaves what it can reach. */
static mixture consistent_mixture(int64_t each, uint64_t seed)
{
    mixture m = mixture_of_all(each, MIXED, seed);
    CHECK(hol_project_velocities(m.chains, m.r, m.v, NULL, NULL));
    for (int64_t p = 0; p < m.n_parts; ++p) mixture_take(&m, p, m.v, m.parts[p].v);
    return m;
}

/** A step in which no bond's ends move by more than a part of its length relative to each other. */
static double time_step(const mixture *m, double part)
{
    double dt = HUGE_VAL;
    for (int64_t k = 0; k < m->n_bonds; ++k) {
        double square = 0;
        for (int x = 0; x < 3; ++x) {
            const double dv = m->v[3 * m->pairs[2 * k + 1] + x] - m->v[3 * m->pairs[2 * k] + x];
            square += dv * dv;
        }
        if (square > 0) dt = fmin(dt, part * m->length[k] / sqrt(square));
    }
    return dt;
}

static long double length_error(const molecule *part, const double *r, int64_t k)
{
    const long double square = (long double)part->length[k] * part->length[k];
    long double sum = -square;
    for (int x = 0; x < 3; ++x) {
        const long double d = (long double)r[3 * part->pairs[2 * k + 1] + x] - r[3 * part->pairs[2 * k] + x];
        sum += d * d;
    }
    return fabsl(sum / square);
}

static void positions_agree_with_newton_in_many_digits(void **state)
{
    (void)state;
    mixture m = consistent_mixture(quick_run() ? 1 : 3, 10);
    const double dt = time_step(&m, 0.02);
    double *drifted = mixture_drifted(&m, dt), *r = copy_of(drifted, mixture_size(&m));
    double *v = copy_of(m.v, mixture_size(&m)), *lambda = untouched((size_t)m.n_bonds);
    CHECK(hol_project_positions(m.chains, m.r, r, v, dt, lambda, 0, NULL, NULL));
    for (int64_t p = 0; p < m.n_parts; ++p) {
        const molecule *part = m.parts + p;
        const molecule_problem problem = molecule_problem_of(part);
        const size_t size = 3 * (size_t)part->n_atoms;
        const long double unit = oracle_bound(part->n_bonds) * DBL_EPSILON;
        double *start = untouched(size), *got = untouched(size), *speed = untouched(size);
        double *multiplier = untouched((size_t)part->n_bonds);
        molecule_solution exact;
        mixture_take(&m, p, drifted, start);
        mixture_take(&m, p, r, got);
        mixture_take(&m, p, v, speed);
        mixture_take_bonds(&m, p, lambda, multiplier);
        assert_int_equal(molecule_positions(&problem, start, NULL, part->length, dt, &exact), 0);
        long double extent = 0, shortest = HUGE_VALL;
        for (size_t i = 0; i < size; ++i) {
            extent = fmaxl(extent, fabs(got[i]));
            CHECK_AT_MOST(fabsl(got[i] - exact.moved[i]), unit * exact.moved_scale[i / 3]);
            /* v + (r - drifted) / dt */
            const long double after = part->v[i] + (exact.moved[i] - start[i]) / dt;
            CHECK_AT_MOST(fabsl(speed[i] - after), unit * (fabs(part->v[i]) + exact.moved_scale[i / 3] / dt));
        }
        for (int64_t k = 0; k < part->n_bonds; ++k) {
            CHECK_AT_MOST(fabsl(multiplier[k] - exact.lambda[k]), unit * exact.lambda_scale[k]);
            shortest = fminl(shortest, part->length[k]);
        }
        for (int64_t k = 0; k < part->n_bonds; ++k) {
            const int64_t *pair = part->pairs + 2 * k;
            if (part->mass[pair[0]] == 0 && part->mass[pair[1]] == 0) continue;
            CHECK_AT_MOST(length_error(part, got, k), 8 * DBL_EPSILON * (1 + extent / shortest));
        }
        free(start), free(got), free(speed), free(multiplier);
        molecule_solution_free(&exact);
    }
    free(drifted), free(r), free(v), free(lambda);
    mixture_free(&m);
}

static void positions_keep_the_centre_of_mass_and_move_along_the_old_bonds(void **state)
{
    (void)state;
    const double dt = 0.004;
    mixture m = mixture_of_kind(MOLECULE_PEPTIDE, 12, 1, 2, MIXED, 20);
    CHECK(hol_project_velocities(m.chains, m.r, m.v, NULL, NULL));
    double *drifted = mixture_drifted(&m, dt), *r = copy_of(drifted, mixture_size(&m));
    double *lambda = untouched((size_t)m.n_bonds);
    CHECK(hol_project_positions(m.chains, m.r, r, NULL, dt, lambda, 0, NULL, NULL));
    double *shift = calloc(mixture_size(&m), sizeof *shift);
    for (int64_t k = 0; k < m.n_bonds; ++k)
        for (int x = 0; x < 3; ++x) {
            const int64_t i = m.pairs[2 * k], j = m.pairs[2 * k + 1];
            const double pull = 2 * lambda[k] * (m.r[3 * j + x] - m.r[3 * i + x]);
            shift[3 * i + x] += dt * dt / m.mass[i] * pull;
            shift[3 * j + x] -= dt * dt / m.mass[j] * pull;
        }
    for (size_t i = 0; i < mixture_size(&m); ++i)
        if (!isnan(m.r[i])) CHECK_AT_MOST(fabs(r[i] - drifted[i] - shift[i]), 64 * DBL_EPSILON * (1 + fabs(r[i])));
    for (int64_t p = 0; p < m.n_parts; ++p)
        for (int x = 0; x < 3; ++x) {
            long double sum = 0, size = 0;
            for (int64_t a = m.first_atom[p]; a < m.first_atom[p + 1]; ++a) {
                const int64_t i = m.atoms[a];
                sum += m.mass[i] * ((long double)r[3 * i + x] - drifted[3 * i + x]);
                size += m.mass[i] * (1 + fabs(r[3 * i + x]));
            }
            CHECK_AT_MOST(fabsl(sum), 8 * DBL_EPSILON * size);
        }
    free(drifted), free(r), free(lambda), free(shift);
    mixture_free(&m);
}

static void a_guess_of_the_last_multipliers_leads_to_the_same_positions(void **state)
{
    (void)state;
    const double dt = 0.004;
    mixture m = mixture_of_kind(MOLECULE_WATER, 30, 3, 3, MIXED, 30);
    double *drifted = mixture_drifted(&m, dt), *r = copy_of(drifted, mixture_size(&m));
    double *again = copy_of(drifted, mixture_size(&m)), *lambda = untouched((size_t)m.n_bonds);
    hol_report first, second;
    CHECK(hol_project_positions(m.chains, m.r, r, NULL, dt, lambda, 0, NULL, &first));
    CHECK(hol_project_positions(m.chains, m.r, again, NULL, dt, lambda, 1, NULL, &second));
    assert_true(second.iterations <= first.iterations);
    assert_int_equal(first.n_corrected, 30);
    assert_int_equal(first.n_failed, 0);
    CHECK_AT_MOST(first.max_error, 16 * DBL_EPSILON);
    for (size_t i = 0; i < mixture_size(&m); ++i)
        if (!isnan(r[i])) CHECK_AT_MOST(fabs(r[i] - again[i]), 64 * DBL_EPSILON);
    free(drifted), free(r), free(again), free(lambda);
    mixture_free(&m);
}

static void molecules_within_the_tolerance_are_not_touched(void **state)
{
    (void)state;
    mixture m = mixture_of_kind(MOLECULE_BENZENE, 9, 6, 6, MIXED, 40);
    double *r = copy_of(m.r, mixture_size(&m)), *lambda = untouched((size_t)m.n_bonds), virial[9];
    hol_report report;
    CHECK(hol_project_positions(m.chains, m.r, r, NULL, 1, lambda, 0, virial, &report));
    assert_same_bits(r, m.r, mixture_size(&m));
    for (int64_t k = 0; k < m.n_bonds; ++k) assert_true(lambda[k] == 0);
    for (int i = 0; i < 9; ++i) assert_true(virial[i] == 0);
    assert_int_equal(report.n_corrected, 0);
    free(r), free(lambda);
    mixture_free(&m);
}

static void violation_names_the_molecule_and_the_bond_that_is_farthest_off(void **state)
{
    (void)state;
    mixture m = mixture_of_kind(MOLECULE_XH3, 20, 3, 3, ONE_AFTER_THE_OTHER, 50);
    hol_worst worst;
    int64_t molecules[60], bonds[3];
    CHECK(hol_chains_molecules_of_bonds(m.chains, molecules));
    CHECK(hol_violation(m.chains, m.r, NULL, &worst));
    CHECK_AT_MOST(worst.length, 16 * DBL_EPSILON);
    const int64_t k = 40;
    for (int x = 0; x < 3; ++x) { /* the bond's light end, which has no other bond, a tenth of its length out */
        const int64_t i = m.pairs[2 * k], j = m.pairs[2 * k + 1];
        m.r[3 * j + x] += 0.1 * (m.r[3 * j + x] - m.r[3 * i + x]);
    }
    CHECK(hol_violation(m.chains, m.r, NULL, &worst));
    CHECK_AT_MOST(fabs(worst.length - 0.21), 1e-12);
    assert_int_equal(worst.length_molecule, molecules[k]);
    CHECK(hol_chains_bonds(m.chains, worst.length_molecule, bonds));
    assert_int_equal(bonds[worst.length_bond], k);
    mixture_free(&m);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(positions_agree_with_newton_in_many_digits),
        cmocka_unit_test(positions_keep_the_centre_of_mass_and_move_along_the_old_bonds),
        cmocka_unit_test(a_guess_of_the_last_multipliers_leads_to_the_same_positions),
        cmocka_unit_test(molecules_within_the_tolerance_are_not_touched),
        cmocka_unit_test(violation_names_the_molecule_and_the_bond_that_is_farthest_off),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
