/** Partition functions: reference values, series, quadrature, symmetries, errors. */
#include "check.h"
#include "partition_reference.h"
#include "random.h"

/**
 * Rounding of a mean of n bonds computed in long double and of its logarithm as a double. Emulators that compute long
 * double in 53 bits get what that gives: a rounding per bond.
 */
static long double bound(int64_t n, long double logarithm)
{
    return 4 * (long double)n * long_double_rounding() + DBL_EPSILON * fabsl(logarithm) + DBL_EPSILON;
}

static double value(int64_t n, const double *masses, int p)
{
    double he, rigid;
    CHECK(hol_partition_function(n, masses, &he, &rigid, NULL));
    return p < 0 ? he : rigid;
}

static void reference_values_are_met(void **state)
{
    (void)state;
    char line[4096], *rest;
    int count = 0;
    FILE *file = fopen(ORACLE_DIR "/partition.txt", "r");
    assert_non_null(file);
    while (fgets(line, sizeof line, file)) {
        if (line[0] == '#') continue;
        double masses[201];
        int64_t n = strtol(line, &rest, 10), given = 0;
        const int p = (int)strtol(rest, &rest, 10);
        const long double exact = logl(strtold(rest, &rest));
        for (char *word = strtok(rest, " \n"); word; word = strtok(NULL, " \n"))
            if (strcmp(word, "equal") != 0) masses[given++] = strcmp(word, "fixed") == 0 ? 0 : strtod(word, NULL);
        assert_true(given == 0 || given == n + 1);
        CHECK_AT_MOST(fabsl(value(n, given ? masses : NULL, p) - exact), bound(n, exact));
        ++count;
    }
    fclose(file);
    assert_true(count >= 38);
}

static void short_chains_have_closed_forms(void **state)
{
    (void)state;
    const double fixed_ends[] = {0, 1, INFINITY}, pi = acos(-1);
    assert_true(value(1, NULL, -1) == 0 && value(1, NULL, 1) == 0);
    CHECK_AT_MOST(fabsl(value(2, NULL, -1) - logl(2 * asinl(0.5L))), 2 * DBL_EPSILON); /* Mazars 2007, Eq. (32) */
    CHECK_AT_MOST(fabs(value(2, fixed_ends, -1) - log(pi / 2)), 2 * DBL_EPSILON);
    CHECK_AT_MOST(fabs(value(2, fixed_ends, 1) - log(pi / 4)), 2 * DBL_EPSILON);
    random_stream random = random_seed(1);
    for (int t = 0; t < 200; ++t) { /* N = 2: asin(s)/s and (sqrt(1-x) + asin(s)/s) / 2, s = sqrt(x) */
        double m[3];
        for (int i = 0; i < 3; ++i) m[i] = exp(8 * random_normal(&random));
        const long double x = m[2] / ((long double)m[1] + m[2]) * (m[0] / ((long double)m[1] + m[0]));
        /* 1 - x = m_1 (m_0 + m_1 + m_2) / ((m_1 + m_2) (m_1 + m_0)) */
        const long double y =
            m[1] / ((long double)m[1] + m[2]) * (((long double)m[0] + m[1] + m[2]) / ((long double)m[1] + m[0]));
        const long double angle = atan2l(sqrtl(x), sqrtl(y)) / sqrtl(x);
        CHECK_AT_MOST(fabsl(value(2, m, -1) - logl(angle)), bound(2, 0));
        CHECK_AT_MOST(fabsl(value(2, m, 1) - logl((sqrtl(y) + angle) / 2)), bound(2, 0));
    }
}

static void series_of_he_agrees_for_short_and_long_chains(void **state)
{
    (void)state;
    const int64_t sizes[] = {2, 3, 5, 20, 1000, 10000}, terms[2] = {420, 40}, few[2] = {200, 200};
    static double masses[10001];
    for (int s = 0; s < 6; ++s) {
        const int64_t n = sizes[s];
        for (int64_t i = 0; i <= n; ++i) masses[i] = i % 2 ? 10 : 1; /* x_n = 1/121, 100/121, .. */
        for (int p = -1; p <= 1; p += 2) {
            const long double exact = partition_series(n, masses, p, terms);
            CHECK_AT_MOST(fabsl(value(n, masses, p) - exact), bound(n, exact));
        }
        for (int64_t i = 0; i <= n; ++i) masses[i] = pow(4, (double)(i % 200)); /* x_n = 0.16 */
        if (n <= 20)
            for (int p = -1; p <= 1; p += 2) {
                const long double exact = partition_series(n, masses, p, few);
                CHECK_AT_MOST(fabsl(value(n, masses, p) - exact), bound(n, exact));
            }
    }
}

static void quadrature_agrees_for_masses_over_many_decades(void **state)
{
    (void)state;
    random_stream random = random_seed(2);
    for (int t = 0; t < 60; ++t) {
        double m[5];
        for (int i = 0; i < 5; ++i) m[i] = exp((t % 4 + 1) * 2.5 * random_normal(&random)); /* up to about 1:1e12 */
        if (t % 5 == 3) m[0] = 0;
        if (t % 5 == 4) m[0] = m[4] = 0;
        for (int64_t n = 3; n <= 4; ++n)
            for (int p = -1; p <= 1; p += 2) {
                const long double exact = partition_quadrature(n, m, p);
                /* the quadrature itself, with differences 1 - x in 64 bits, has 1e-16 */
                CHECK_AT_MOST(fabsl(value(n, m, p) - exact), bound(n, exact) + 1e-15L);
            }
    }
}

static void direction_of_the_chain_does_not_matter(void **state)
{
    (void)state;
    random_stream random = random_seed(3);
    for (int t = 0; t < 40; ++t) {
        const int64_t n = random_integer(&random, 2, 60);
        double m[61], back[61];
        for (int64_t i = 0; i <= n; ++i) m[i] = exp((t % 5) * 3 * random_normal(&random));
        if (t % 7 == 3) m[0] = 0;
        if (t % 7 == 5) m[n] = m[0] = 0;
        for (int64_t i = 0; i <= n; ++i) back[i] = m[n - i];
        for (int p = -1; p <= 1; p += 2) {
            const double there = value(n, m, p), again = value(n, back, p);
            CHECK_AT_MOST(fabs(there - again), 2 * bound(n, there));
        }
    }
}

static void fixed_atom_inside_separates_two_chains(void **state)
{
    (void)state;
    const double whole[] = {1, 3, 2, 0, 1, 5, 0.1, 2}, left[] = {1, 3, 2, 0}, right[] = {0, 1, 5, 0.1, 2};
    for (int p = -1; p <= 1; p += 2)
        CHECK_AT_MOST(fabs(value(7, whole, p) - value(3, left, p) - value(4, right, p)), 4 * DBL_EPSILON);
}

static void unit_of_mass_does_not_matter(void **state)
{
    (void)state;
    double m[9], scaled[9];
    for (int i = 0; i < 9; ++i) m[i] = 1 + (i * 5) % 7;
    for (int e = -900; e <= 900; e += 300) {
        for (int i = 0; i < 9; ++i) scaled[i] = ldexp(m[i], e);
        assert_true(value(8, m, -1) == value(8, scaled, -1) && value(8, m, 1) == value(8, scaled, 1));
    }
}

static void volume_is_the_product_of_inertia_parameters(void **state)
{
    (void)state;
    const double m[] = {1, 3, 0.5, 2, 5}, fixed[] = {1, 1, 0, 1};
    double volume, he, rigid;
    CHECK(hol_partition_function(4, m, NULL, NULL, &volume));
    const long double x2 = 0.5L / 3.5L * (1 / 4.0L), x3 = 2 / 2.5L * (3 / 3.5L), x4 = 5 / 7.0L * (0.5L / 2.5L);
    CHECK_AT_MOST(fabsl(volume - logl(x2 * x3 * x4) / 2), 2 * DBL_EPSILON * fabs(volume));
    CHECK(hol_partition_function(3, fixed, &he, &rigid, &volume));
    assert_true(isinf(volume) && volume < 0);
    assert_true(he > 0 && rigid < 0); /* two pieces with a fixed end */
    CHECK(hol_partition_function(3, NULL, NULL, &rigid, NULL));
}

static void wrong_arguments_write_nothing(void **state)
{
    (void)state;
    double m[4] = {1, 2, 3, 4}, *out = untouched(3);
    CHECK_FAILS(HOL_ERR_NULL, hol_partition_function(3, m, NULL, NULL, NULL));
    CHECK_FAILS(HOL_ERR_VALUE, hol_partition_function(0, m, out, out + 1, out + 2));
    CHECK_FAILS(HOL_ERR_VALUE, hol_partition_function(INT64_MAX, m, out, out + 1, out + 2));
    m[2] = -1;
    CHECK_FAILS(HOL_ERR_VALUE, hol_partition_function(3, m, out, out + 1, out + 2));
    assert_message_names("atom 2");
    m[2] = NAN;
    CHECK_FAILS(HOL_ERR_VALUE, hol_partition_function(3, m, out, out + 1, out + 2));
    m[2] = 0, m[3] = INFINITY;
    CHECK_FAILS(HOL_ERR_DEGENERATE, hol_partition_function(3, m, out, out + 1, out + 2));
    assert_message_names("bond 2");
    assert_untouched(out, 3);
    free(out);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(reference_values_are_met),
        cmocka_unit_test(short_chains_have_closed_forms),
        cmocka_unit_test(series_of_he_agrees_for_short_and_long_chains),
        cmocka_unit_test(quadrature_agrees_for_masses_over_many_decades),
        cmocka_unit_test(direction_of_the_chain_does_not_matter),
        cmocka_unit_test(fixed_atom_inside_separates_two_chains),
        cmocka_unit_test(unit_of_mass_does_not_matter),
        cmocka_unit_test(volume_is_the_product_of_inertia_parameters),
        cmocka_unit_test(wrong_arguments_write_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
