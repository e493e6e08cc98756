/** What a position projection is told beside the step: tolerance, first guess, fixed atoms, one array for two. */
#include "assembly.h"
#include "check.h"
#include "positions.h"

static void check_satisfied(int is_long)
{
    assembly a = short_or_long(CHAIN_HETEROGENEOUS, is_long, SCATTERED, 85);
    double *q = drift(&a, 0.004, 0), *lambda = untouched((size_t)a.n_bonds), virial[9];
    hol_report report;
    CHECK(hol_project_positions(a.chains, a.r, q, NULL, 0.004, NULL, 0, NULL, NULL));
    double *again = copy_of(q, assembly_size(&a)), *v = copy_of(a.v, assembly_size(&a));
    CHECK(hol_project_positions(a.chains, a.r, again, v, 0.004, lambda, 0, virial, &report));
    assert_same_bits(again, q, assembly_size(&a));
    assert_same_bits(v, a.v, assembly_size(&a));
    for (int64_t k = 0; k < a.n_bonds; ++k) assert_true(lambda[k] == 0);
    for (int i = 0; i < 9; ++i) assert_true(virial[i] == 0);
    assert_int_equal(report.n_corrected, 0);
    assert_int_equal(report.n_failed, 0);
    assert_int_equal(report.iterations, 0);
    free(q), free(lambda), free(again), free(v);
    assembly_free(&a);
}

static void a_chain_within_the_tolerance_is_not_touched(void **state)
{
    (void)state;
    for (int is_long = 0; is_long < 2; ++is_long) check_satisfied(is_long);
}

static void a_long_chain_of_which_a_part_is_satisfied_ends_on_its_lengths(void **state)
{
    (void)state;
    assembly a = assembly_of_kind(CHAIN_COIL, 1, 5000, 5000, IN_ORDER, 89);
    double *q = copy_of(a.r, assembly_size(&a));
    hol_report report;
    hol_worst worst;
    for (size_t i = assembly_size(&a) - 300; i < assembly_size(&a); ++i) q[i] += 0.004 * a.v[i];
    CHECK(hol_project_positions(a.chains, a.r, q, NULL, 0.004, NULL, 0, NULL, &report));
    assert_int_equal(report.n_corrected, 1);
    CHECK(hol_violation(a.chains, q, NULL, &worst));
    CHECK_AT_MOST(worst.length, rounding_of_a_bond(200, 1));
    free(q);
    assembly_free(&a);
}

/** A chain put back on its lengths along its own bonds. */
static void the_reference_may_be_the_array_that_is_corrected(void **state)
{
    (void)state;
    for (int is_long = 0; is_long < 2; ++is_long) {
        assembly a = short_or_long(CHAIN_COIL, is_long, IN_ORDER, 90);
        double *start = drift(&a, 0.02, 1), *q = copy_of(start, assembly_size(&a)),
               *both = copy_of(start, assembly_size(&a));
        hol_worst worst;
        CHECK(hol_project_positions(a.chains, start, q, NULL, 0.02, NULL, 0, NULL, NULL));
        CHECK(hol_project_positions(a.chains, both, both, NULL, 0.02, NULL, 0, NULL, NULL));
        CHECK(hol_violation(a.chains, both, NULL, &worst));
        CHECK_AT_MOST(worst.length, rounding_of_a_bond(200, 1));
        for (size_t i = 0; i < assembly_size(&a); ++i) CHECK_AT_MOST(fabs(q[i] - both[i]), 20 * DBL_EPSILON * 200);
        free(start), free(q), free(both);
        assembly_free(&a);
    }
}

static void check_guess(int is_long)
{
    const double dt = 0.004;
    assembly a = short_or_long(CHAIN_COIL, is_long, IN_ORDER, 86);
    const size_t size = assembly_size(&a);
    CHECK(hol_project_velocities(a.chains, a.r, a.v, NULL, NULL));
    double *r = copy_of(a.r, size), *q = copy_of(a.r, size), *lambda = untouched((size_t)a.n_bonds), *first = NULL;
    const double extent = is_long ? 200 : 20;
    hol_report cold, warm;
    int64_t cold_sum = 0, warm_sum = 0;
    for (int step = 0; step < 20; ++step) {
        for (size_t i = 0; i < size; ++i) q[i] = r[i] + dt * a.v[i];
        first = copy_of(q, size);
        CHECK(hol_project_positions(a.chains, r, first, NULL, dt, NULL, 0, NULL, &cold));
        CHECK(hol_project_positions(a.chains, r, q, a.v, dt, lambda, step > 0, NULL, &warm));
        for (size_t i = 0; i < size; ++i) CHECK_AT_MOST(fabs(q[i] - first[i]), 20 * DBL_EPSILON * extent);
        if (step > 0) {
            cold_sum += cold.iterations;
            warm_sum += warm.iterations;
        }
        memcpy(r, q, sizeof *r * size);
        CHECK(hol_project_velocities(a.chains, r, a.v, NULL, NULL));
        free(first);
    }
    print_message("iterations in 19 steps: %lld without a guess, %lld with\n", (long long)cold_sum,
                  (long long)warm_sum);
    if (!is_long) assert_true(warm_sum + 9 <= cold_sum); /* at least every other step one less */
    if (is_long) assert_true(warm_sum <= cold_sum);
    free(r), free(q), free(lambda);
    assembly_free(&a);
}

static void a_guess_saves_an_iteration_and_changes_the_result_by_rounding_only(void **state)
{
    (void)state;
    for (int is_long = 0; is_long < 2; ++is_long) check_guess(is_long);
}

static void check_tolerance(int is_long)
{
    assembly a = short_or_long(CHAIN_COIL, is_long, IN_ORDER, 87);
    double *start = drift(&a, 0.01, 1);
    int64_t first = 100, last = 100;
    for (double tolerance = 1e-14; tolerance < 1e-1; tolerance *= 1e4) {
        double *q = copy_of(start, assembly_size(&a));
        hol_report report;
        hol_worst worst;
        CHECK(hol_chains_set_tolerance(a.chains, tolerance));
        CHECK(hol_project_positions(a.chains, a.r, q, NULL, 0.01, NULL, 0, NULL, &report));
        CHECK(hol_violation(a.chains, q, NULL, &worst));
        CHECK_AT_MOST(worst.length, tolerance + rounding_of_a_bond(is_long ? 200 : 25, 1));
        /* A solve more where its factors are those of the one before, which a tighter tolerance makes anew. */
        last = report.iterations;
        if (tolerance < 1e-13) first = last;
        if (last > first + (tolerance < 1e-9)) fail_msg("tolerance %g: %lld iterations", tolerance, (long long)last);
        free(q);
    }
    assert_true(last <= 2);
    free(start);
    assembly_free(&a);
}

static void a_larger_tolerance_is_obeyed_and_costs_less(void **state)
{
    (void)state;
    for (int is_long = 0; is_long < 2; ++is_long) check_tolerance(is_long);
}

/** Without a report the errors that are left need not be known, and the last solve is not looked at. */
static void check_report(chain_kind kind, int64_t n_chains, int64_t low, int64_t high)
{
    const double dt = 0.004;
    assembly a = assembly_of_kind(kind, n_chains, low, high, IN_ORDER, 91);
    const size_t size = assembly_size(&a), n = (size_t)a.n_bonds;
    double *q = drift(&a, dt, 1), *told = copy_of(q, size), *v = copy_of(a.v, size), *v_told = copy_of(a.v, size);
    double *lambda = untouched(n), *lambda_told = untouched(n);
    hol_report report;
    hol_worst worst;
    CHECK(hol_project_positions(a.chains, a.r, q, v, dt, lambda, 0, NULL, NULL));
    CHECK(hol_project_positions(a.chains, a.r, told, v_told, dt, lambda_told, 0, NULL, &report));
    assert_same_bits(q, told, size);
    assert_same_bits(v, v_told, size);
    assert_same_bits(lambda, lambda_told, n);
    CHECK(hol_violation(a.chains, q, NULL, &worst));
    const long double rounding = rounding_of_a_bond(high > 1000 ? 200 : 40, 0.5L);
    CHECK_AT_MOST(worst.length, report.max_error + rounding);
    CHECK_AT_MOST(report.max_error, rounding);
    assert_true(report.iterations > 0);
    free(q), free(told), free(v), free(v_told), free(lambda), free(lambda_told);
    assembly_free(&a);
}

static void a_report_changes_nothing(void **state)
{
    (void)state;
    for (int heterogeneous = 0; heterogeneous < 2; ++heterogeneous) {
        const chain_kind kind = heterogeneous ? CHAIN_HETEROGENEOUS : CHAIN_COIL;
        for (int64_t n = 1; n <= 6; ++n) check_report(kind, 50, n, n);
        check_report(kind, 40, 1, 60);
        check_report(kind, 9, 100, 100);
        check_report(kind, 2, 3000, 3000);
    }
}

static void check_worst_bond(int64_t n_chains, int64_t n_bonds)
{
    assembly a = assembly_of_kind(CHAIN_COIL, n_chains, n_bonds, n_bonds, IN_ORDER, 95);
    double *r = drift(&a, 0.004, 0);
    hol_report report;
    hol_worst worst;
    CHECK(hol_chains_set_tolerance(a.chains, 1e-3));
    CHECK(hol_project_positions(a.chains, a.r, r, NULL, 0.004, NULL, 0, NULL, &report));
    CHECK(hol_violation(a.chains, r, NULL, &worst));
    assert_int_equal(report.molecule, worst.length_molecule);
    assert_int_equal(report.bond, worst.length_bond);
    /* before the positions are rounded, which is far less than the error */
    CHECK_AT_MOST(fabs(report.max_error - worst.length), (n_bonds > 1000 ? 2000 : 100) * DBL_EPSILON);
    assert_true(report.max_error <= 1e-3);
    free(r);
    assembly_free(&a);
}

static void the_report_names_the_bond_with_the_largest_error(void **state)
{
    (void)state;
    check_worst_bond(7, 12);
    check_worst_bond(1, 5000);
    check_worst_bond(3, 2100);
}

static void check_fixed_atoms(int is_long)
{
    assembly a = short_or_long(CHAIN_FIXED_ENDS, is_long, SCATTERED, 88);
    double *start = drift(&a, 0.004, 1), *q = copy_of(start, assembly_size(&a)), *v = copy_of(a.v, assembly_size(&a));
    CHECK(hol_project_positions(a.chains, a.r, q, v, 0.004, NULL, 0, NULL, NULL));
    for (int64_t i = 0; i < a.n_atoms; ++i)
        if (a.mass[i] == 0) {
            assert_same_bits(q + 3 * i, start + 3 * i, 3);
            assert_same_bits(v + 3 * i, a.v + 3 * i, 3);
        }
    free(start), free(q), free(v);
    assembly_free(&a);
}

static void fixed_atoms_keep_every_bit(void **state)
{
    (void)state;
    for (int is_long = 0; is_long < 2; ++is_long) check_fixed_atoms(is_long);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_chain_within_the_tolerance_is_not_touched),
        cmocka_unit_test(a_long_chain_of_which_a_part_is_satisfied_ends_on_its_lengths),
        cmocka_unit_test(the_reference_may_be_the_array_that_is_corrected),
        cmocka_unit_test(a_guess_saves_an_iteration_and_changes_the_result_by_rounding_only),
        cmocka_unit_test(a_larger_tolerance_is_obeyed_and_costs_less),
        cmocka_unit_test(a_report_changes_nothing),
        cmocka_unit_test(the_report_names_the_bond_with_the_largest_error),
        cmocka_unit_test(fixed_atoms_keep_every_bit),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
