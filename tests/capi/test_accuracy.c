/**
 * The accuracy promised for the time step: one long or short chain, unit bonds and masses, kT = 1, velocities
 * projected, positions drifted by dt v. The bounds are those of docs: what the rounding of the coordinates leaves.
 */
#include "assembly.h"
#include "check.h"

/** Counts what is above its bound, so that the whole table is printed before the test fails. */
static int over;

static void count_above(double error, double bound)
{
    if (error <= bound) return;
    print_message("  above its bound %.2g\n", bound);
    ++over;
}

typedef struct outcome {
    double error;   /* largest |d.d - 1| afterwards */
    double typical; /* of several chains, the median of that */
    int64_t iterations;
    int status;
} outcome;

static outcome step(chain_kind kind, int64_t n, double dt, uint64_t seed)
{
    chain one = chain_make(kind, n, seed);
    for (int64_t k = 0; k < n; ++k)
        if (kind != CHAIN_BOND_RATIO_1E6) one.length[k] = 1;
    assembly a = assembly_make(&one, 1, IN_ORDER, 0);
    hol_report report;
    outcome o = {0, 0, 0, HOL_OK};
    /* A bond of 1e-6 between others: a step is many times its length. */
    if (kind == CHAIN_BOND_RATIO_1E6) CHECK(hol_chains_set_checks(a.chains, HOL_NEVER));
    CHECK(hol_project_velocities(a.chains, a.r, a.v, NULL, NULL));
    double *q = copy_of(a.r, assembly_size(&a)), *v = copy_of(a.v, assembly_size(&a));
    for (size_t i = 0; i < assembly_size(&a); ++i) q[i] += dt * a.v[i];
    double *before = copy_of(q, assembly_size(&a));
    o.status = hol_project_positions(a.chains, a.r, q, v, dt, NULL, 0, NULL, &report);
    o.iterations = report.iterations;
    if (o.status != HOL_OK) {
        assert_same_bits(q, before, assembly_size(&a));
        assert_same_bits(v, a.v, assembly_size(&a));
    }
    for (int64_t k = 0; o.status == HOL_OK && k < n; ++k) {
        long double square = 0;
        for (int x = 0; x < 3; ++x)
            square += ((long double)q[3 * k + 3 + x] - q[3 * k + x]) * ((long double)q[3 * k + 3 + x] - q[3 * k + x]);
        const long double a2 = (long double)one.length[k] * one.length[k];
        o.error = fmax(o.error, (double)(fabsl(square - a2) / a2));
    }
    free(q), free(v), free(before);
    assembly_free(&a);
    chain_free(&one);
    return o;
}

static int compare(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/** The worst and the median of several chains. */
static outcome worst_of(chain_kind kind, int64_t n, double dt)
{
    outcome worst = {0, 0, 0, HOL_OK};
    double errors[50];
    const uint64_t count = n < 1000 ? 50 : n < 100000 ? 8 : 2;
    for (uint64_t seed = 0; seed < count; ++seed) {
        const outcome o = step(kind, n, dt, seed);
        if (o.status != HOL_OK) worst.status = o.status;
        errors[seed] = o.error;
        worst.error = fmax(worst.error, o.error);
        if (o.iterations > worst.iterations) worst.iterations = o.iterations;
    }
    qsort(errors, (size_t)count, sizeof *errors, compare);
    worst.typical = errors[count / 2];
    print_message("%-16s N = %6lld, dt = %-6g error %.2g, typically %.2g, %lld iterations%s%s\n", chain_kind_name(kind),
                  (long long)n, dt, worst.error, worst.typical, (long long)worst.iterations, worst.status ? ", " : "",
                  worst.status ? hol_status_name(worst.status) : "");
    return worst;
}

static void coils_end_at_the_rounding_of_their_coordinates(void **state)
{
    (void)state;
    over = 0;
    static const int64_t lengths[] = {1, 3, 10, 100, 1000, 10000, 100000};
    for (int i = 0; i < 7; ++i)
        for (int large = 0; large < 2; ++large) {
            const outcome o = worst_of(CHAIN_COIL, lengths[i], large ? 0.02 : 0.005);
            assert_int_equal(o.status, HOL_OK);
            /* a walk of N steps has coordinates of the order of sqrt(N), and so is the rounding: about 3e-16 at 1,
               3e-15 at 100, 1e-13 at 1e5. The worst of several is beyond it: 1.3e-16, 3.2e-15 and 7e-14 for the exact
               solution rounded to doubles. */
            count_above(o.typical, 3e-16 * sqrt((double)lengths[i]));
            count_above(o.error, 4.5e-16 * sqrt((double)lengths[i]));
            assert_in_range(o.iterations, 1, large ? 5 : 4);
        }
    assert_int_equal(over, 0);
}

static void nearly_straight_chains_end_at_the_rounding_of_their_coordinates(void **state)
{
    (void)state;
    over = 0;
    static const int64_t lengths[] = {1, 10, 100, 1000, 10000, 100000};
    static const double bounds[] = {3.5e-16, 3e-15, 3.5e-14, 2.5e-13, 1.5e-12, 4e-12};
    /* the exact solution rounded to doubles: 1.1e-16, 2.3e-15, 3e-14, 2.1e-13, 8.4e-13 on these chains */
    for (int i = 0; i < 6; ++i) {
        const outcome o = worst_of(CHAIN_NEARLY_STRAIGHT, lengths[i], 0.005);
        assert_int_equal(o.status, HOL_OK);
        count_above(o.error, bounds[i]);
    }
    assert_int_equal(over, 0);
}

static void hostile_chains_converge_to_the_rounding_or_are_refused(void **state)
{
    (void)state;
    over = 0;
    static const chain_kind hostile[] = {CHAIN_MASSES_1E3, CHAIN_MASSES_1E6,     CHAIN_FIXED_ENDS,
                                         CHAIN_FOLDED,     CHAIN_BOND_RATIO_1E6, CHAIN_OFFSET_1E6,
                                         CHAIN_TAUT,       CHAIN_ROD_MASSES_1E9};
    for (size_t i = 0; i < sizeof hostile / sizeof *hostile; ++i)
        for (int64_t n = 3; n <= 1000; n = n * 10 + 2) {
            const outcome o = worst_of(hostile[i], n, 0.005);
            assert_true(o.status == HOL_OK || o.status == HOL_ERR_NO_CONVERGENCE || o.status == HOL_ERR_DEGENERATE);
            /* of the chains that were done: rounding of coordinates up to n + 3e6, over the shortest bond */
            const double extent = hostile[i] == CHAIN_OFFSET_1E6 ? 3e6 + (double)n : (double)n,
                         shortest = hostile[i] == CHAIN_BOND_RATIO_1E6 ? 1e-6 : 1;
            count_above(o.error, DBL_EPSILON * (2 * sqrt(3) * extent / shortest + 8));
            if (hostile[i] == CHAIN_MASSES_1E3 || hostile[i] == CHAIN_MASSES_1E6) assert_int_equal(o.status, HOL_OK);
        }
    assert_int_equal(over, 0);
}

static void bonds_of_very_different_lengths_converge_when_the_step_suits_the_shortest(void **state)
{
    (void)state;
    over = 0;
    for (int64_t n = 3; n <= 1000; n = n * 10 + 2) {
        const outcome o = worst_of(CHAIN_BOND_RATIO_1E6, n, 1e-9);
        assert_int_equal(o.status, HOL_OK);
        count_above(o.error, DBL_EPSILON * (2 * sqrt(3) * sqrt((double)n) * 3 / 1e-6 + 8));
    }
    assert_int_equal(over, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(coils_end_at_the_rounding_of_their_coordinates),
        cmocka_unit_test(nearly_straight_chains_end_at_the_rounding_of_their_coordinates),
        cmocka_unit_test(hostile_chains_converge_to_the_rounding_or_are_refused),
        cmocka_unit_test(bonds_of_very_different_lengths_converge_when_the_step_suits_the_shortest),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
