/** The tridiagonal algebra from gamma alone: closed forms, long double solutions, the limit of definiteness, errors. */
#include "check.h"
#include "random.h"

/** The closed forms of the appendix of Mazars 2007 (A.1, A.3.2, A.4.2, A.5.2), corrected, and Omega of any n. */
static void small_matrices_have_the_closed_forms_of_the_appendix(void **state)
{
    (void)state;
    random_stream random = random_seed(1);
    for (int trial = 0; trial < (quick_run() ? 50 : 1000); ++trial) {
        double g[4], omega2[5], inverse[25], log_det;
        long double s[4];
        for (int k = 0; k < 4; ++k) g[k] = random_uniform(&random) - 0.5, s[k] = (long double)g[k] * g[k];
        const long double d2 = 1 - s[0], d3 = d2 - s[1], d4 = d3 - s[2] * d2, d5 = d4 - s[3] * d3;
        const long double pivots[5] = {1, d2, d3 / d2, d4 / d3, d5 / d4};
        /* the cancellation in long double leaves 64 - 53 = 11 bits to spare, det is above 1/16 */
        CHECK(hol_tridiagonal_pivots(5, g, omega2));
        for (int k = 0; k < 5; ++k) CHECK_AT_MOST(fabsl(omega2[k] - pivots[k]), DBL_EPSILON * pivots[k]);
        CHECK(hol_tridiagonal_log_det(5, g, &log_det));
        CHECK_AT_MOST(fabsl(log_det - logl(d5)), 4 * DBL_EPSILON * fabsl(logl(d5)) + 100 * long_double_rounding());
        CHECK(hol_tridiagonal_inverse_band(5, g, 4, inverse));
        const long double g2 = g[0], g3 = g[1], g4 = g[2], g5 = g[3];
        const long double exact[5][5] = {{1 - s[3] - s[2] - s[1] * (1 - s[3]), g2 * (1 - s[3] - s[2]),
                                          g2 * g3 * (1 - s[3]), g2 * g3 * g4, g2 * g3 * g4 * g5},
                                         {1 - s[3] - s[2], g3 * (1 - s[3]), g3 * g4, g3 * g4 * g5, 0},
                                         {d2 * (1 - s[3]), g4 * d2, g4 * g5 * d2, 0, 0},
                                         {d3, g5 * d3, 0, 0, 0},
                                         {d4, 0, 0, 0, 0}};
        for (int i = 0; i < 5; ++i)
            for (int k = 0; k < 5; ++k) {
                const long double z = exact[i][k] / d5;
                CHECK_AT_MOST(fabsl(inverse[5 * i + k] - z),
                              (4 + 2 * k) * DBL_EPSILON * fabsl(z) + 100 * long_double_rounding());
            }
    }
}

static void equal_gammas_of_one_half_have_the_closed_form_up_to_a_million_rows(void **state)
{
    (void)state;
    double *g = malloc(sizeof(double) * 999999), *x = malloc(sizeof(double) * 1000000), value;
    assert_true(g && x);
    for (int k = 0; k < 999999; ++k) g[k] = 0.5;
    for (int64_t n = 1; n <= (quick_run() ? 1000 : 1000000); n *= 10) {
        const long double exact = logl((long double)(n + 1)) - (long double)n * logl(2);
        CHECK(hol_tridiagonal_log_det(n, g, &value));
        CHECK_AT_MOST(fabsl(value - exact), 4 * DBL_EPSILON * fabsl(exact));
        CHECK(hol_tridiagonal_pivots(n, g, x));
        for (int64_t k = 1; k <= n; ++k)
            CHECK_AT_MOST(fabsl(x[k - 1] - (long double)(k + 1) / (2 * (long double)k)), DBL_EPSILON);
        for (int64_t i = 0; i < n; i += n / 3 + 1)
            for (int64_t j = i; j < n; j += n / 4 + 1) {
                const long double z = 2.0L * (long double)(i + 1) * (long double)(n - j) / (long double)(n + 1);
                CHECK(hol_tridiagonal_inverse_entry(n, g, i, j, &value));
                CHECK_AT_MOST(fabsl(value - z), 4 * DBL_EPSILON * z);
            }
    }
    free(g), free(x);
}

/** The residual tells, as it does not know the solution: each x is rounded once. */
static void check_solution(int64_t n, const double *g, const double *b, const double *x)
{
    for (int64_t k = 0; k < n; ++k) {
        long double rest = b[k] - (long double)x[k], size = fabs(b[k]) + fabs(x[k]);
        if (k > 0) rest += (long double)g[k - 1] * x[k - 1], size += fabs(g[k - 1] * x[k - 1]);
        if (k + 1 < n) rest += (long double)g[k] * x[k + 1], size += fabs(g[k] * x[k + 1]);
        CHECK_AT_MOST(fabsl(rest), DBL_EPSILON * size);
    }
}

/** From far from singular, where plain products with a correction do, to as near as the note in the header allows. */
static void solutions_are_exact_for_the_given_doubles(void **state)
{
    (void)state;
    random_stream random = random_seed(2);
    const double below[] = {0.4, 1e-2, 1e-4, 1e-6, 1e-9}, scales[] = {1, 1e-150, 1e150};
    for (int64_t n = 1; n <= 400; n = 2 * n + 1)
        for (int way = 0; way < 45; ++way) {
            double *g = malloc(sizeof(double) * (size_t)n), *b = malloc(sizeof(double) * (size_t)n),
                   *x = untouched((size_t)n);
            assert_true(g && b);
            for (int64_t k = 0; k < n; ++k) {
                g[k] = 0.5 - below[way % 5] * random_uniform(&random);
                if (way % 2 && random_uniform(&random) < 0.5) g[k] = -g[k];
                b[k] = way / 15 && random_uniform(&random) < 0.3 ? 0 : scales[way / 5 % 3] * random_normal(&random);
            }
            CHECK(hol_tridiagonal_solve(n, g, b, x));
            check_solution(n, g, b, x);
            double *in_place = copy_of(b, (size_t)n);
            CHECK(hol_tridiagonal_solve(n, g, in_place, in_place));
            assert_same_bits(x, in_place, (size_t)n);
            free(g), free(b), free(x), free(in_place);
        }
}

/** One row with a pivot of `small`, between rows that are far from singular. */
static void one_small_pivot_is_found_wherever_it_stands(void **state)
{
    (void)state;
    random_stream random = random_seed(4);
    enum { N = 41 };
    double g[N - 1], b[N], x[N], pivots[N], log_det;
    for (int row = 1; row < N; ++row)
        for (double small = 1e-2; small > 1e-12; small /= 100) {
            for (int k = 0; k < N - 1; ++k) g[k] = 0.3 * random_uniform(&random);
            if (row > 1) g[row - 2] = 0;
            if (row < N - 1) g[row] = 0;
            g[row - 1] = 1 - small;
            for (int k = 0; k < N; ++k) b[k] = random_normal(&random);
            CHECK(hol_tridiagonal_solve(N, g, b, x));
            check_solution(N, g, b, x);
            CHECK(hol_tridiagonal_pivots(N, g, pivots));
            CHECK(hol_tridiagonal_log_det(N, g, &log_det));
            long double pivot = 1, sum = 0;
            for (int k = 1; k < N; ++k) {
                const long double c = g[k - 1];
                sum += k == row ? logl((1 - c) * (1 + c)) : logl(1 - c * c / pivot);
                pivot = k == row ? (1 - c) * (1 + c) : 1 - c * c / pivot;
                CHECK_AT_MOST(fabsl(pivots[k] - pivot), DBL_EPSILON * pivot);
            }
            CHECK_AT_MOST(fabsl(log_det - sum), 4 * DBL_EPSILON * fabsl(sum));
        }
}

static void elements_solve_for_unit_vectors(void **state)
{
    (void)state;
    enum { N = 24 };
    random_stream random = random_seed(3);
    double g[N - 1], band[N * N], unit[N], x[N], value;
    for (int k = 0; k < N - 1; ++k) g[k] = (random_uniform(&random) - 0.5) * (k % 3 ? 0.99 : 0.3);
    CHECK(hol_tridiagonal_inverse_band(N, g, N - 1, band));
    for (int j = 0; j < N; ++j) {
        memset(unit, 0, sizeof unit);
        unit[j] = 1;
        CHECK(hol_tridiagonal_solve(N, g, unit, x));
        for (int i = 0; i < N; ++i) {
            CHECK(hol_tridiagonal_inverse_entry(N, g, i, j, &value));
            const int low = i < j ? i : j, distance = abs(i - j);
            CHECK_AT_MOST(fabs(value - x[i]), 4 * DBL_EPSILON * fabs(x[i]));
            CHECK_AT_MOST(fabs(band[low * N + distance] - x[i]), (4 + 2 * distance) * DBL_EPSILON * fabs(x[i]));
        }
        for (int k = N - j; k < N; ++k) assert_true(band[j * N + k] == 0);
    }
    CHECK(hol_tridiagonal_inverse_entry(1, NULL, 0, 0, &value));
    assert_true(value == 1);
}

/** Condition 1e12: gamma^2 as one double would leave four digits of the pivots. */
static void nearly_singular_matrices_keep_all_digits(void **state)
{
    (void)state;
    for (double small = 1e-3; small > 1e-13; small /= 8) {
        const double g = 1 - small;
        double omega2[2], log_det, inverse[4];
        const long double exact = (1 - (long double)g) * (1 + (long double)g);
        CHECK(hol_tridiagonal_pivots(2, &g, omega2));
        CHECK(hol_tridiagonal_log_det(2, &g, &log_det));
        CHECK(hol_tridiagonal_inverse_band(2, &g, 1, inverse));
        CHECK_AT_MOST(fabsl(omega2[1] - exact), DBL_EPSILON * exact);
        CHECK_AT_MOST(fabsl(log_det - logl(exact)), 4 * DBL_EPSILON * fabsl(logl(exact)));
        CHECK_AT_MOST(fabsl(inverse[0] * exact - 1), 4 * DBL_EPSILON);
        CHECK_AT_MOST(fabsl(inverse[1] * exact / g - 1), 4 * DBL_EPSILON);
    }
}

static void indefinite_matrices_are_refused_with_the_row(void **state)
{
    (void)state;
    double g[9], b[10] = {1}, *out = untouched(100);
    for (int row = 1; row <= 9; ++row)
        for (int how = 0; how < 3; ++how) {
            const double above[] = {1, 1.5, 1e300};
            for (int k = 0; k < 9; ++k) g[k] = 0.3;
            g[row - 1] = above[how];
            int64_t bond = -5, chain = -5;
            CHECK_FAILS(HOL_ERR_NOT_DEFINITE, hol_tridiagonal_pivots(10, g, out));
            hol_error_location(&chain, &bond, NULL, NULL);
            assert_int_equal(bond, row);
            assert_int_equal(chain, -1);
            char words[16];
            snprintf(words, sizeof words, "row %d", row);
            assert_message_names(words);
            CHECK_FAILS(HOL_ERR_NOT_DEFINITE, hol_tridiagonal_log_det(10, g, out));
            CHECK_FAILS(HOL_ERR_NOT_DEFINITE, hol_tridiagonal_solve(10, g, b, out));
            CHECK_FAILS(HOL_ERR_NOT_DEFINITE, hol_tridiagonal_inverse_entry(10, g, 0, 0, out));
            CHECK_FAILS(HOL_ERR_NOT_DEFINITE, hol_tridiagonal_inverse_band(10, g, 0, out));
        }
    assert_untouched(out, 100);
    free(out);
}

static void wrong_arguments_write_nothing(void **state)
{
    (void)state;
    double g[4] = {0.1, 0.2, 0.3, 0.4}, bad[4] = {0.1, 0.2, NAN, 0.4}, b[5] = {1, 2, 3, 4, 5}, *out = untouched(25);
    CHECK_FAILS(HOL_ERR_NULL, hol_tridiagonal_pivots(5, NULL, out));
    CHECK_FAILS(HOL_ERR_NULL, hol_tridiagonal_pivots(5, g, NULL));
    CHECK_FAILS(HOL_ERR_VALUE, hol_tridiagonal_pivots(0, g, out));
    CHECK_FAILS(HOL_ERR_VALUE, hol_tridiagonal_pivots(INT64_MAX, g, out));
    CHECK_FAILS(HOL_ERR_NOT_FINITE, hol_tridiagonal_pivots(5, bad, out));
    CHECK_FAILS(HOL_ERR_NULL, hol_tridiagonal_log_det(5, NULL, out));
    CHECK_FAILS(HOL_ERR_NULL, hol_tridiagonal_log_det(5, g, NULL));
    CHECK_FAILS(HOL_ERR_VALUE, hol_tridiagonal_log_det(-3, g, out));
    CHECK_FAILS(HOL_ERR_NULL, hol_tridiagonal_solve(5, NULL, b, out));
    CHECK_FAILS(HOL_ERR_NULL, hol_tridiagonal_solve(5, g, NULL, out));
    CHECK_FAILS(HOL_ERR_NULL, hol_tridiagonal_solve(5, g, b, NULL));
    CHECK_FAILS(HOL_ERR_VALUE, hol_tridiagonal_solve(0, g, b, out));
    b[3] = INFINITY;
    CHECK_FAILS(HOL_ERR_NOT_FINITE, hol_tridiagonal_solve(5, g, b, out));
    CHECK_FAILS(HOL_ERR_NULL, hol_tridiagonal_inverse_entry(5, g, 0, 0, NULL));
    CHECK_FAILS(HOL_ERR_INDEX, hol_tridiagonal_inverse_entry(5, g, 0, 5, out));
    CHECK_FAILS(HOL_ERR_INDEX, hol_tridiagonal_inverse_entry(5, g, -1, 0, out));
    CHECK_FAILS(HOL_ERR_NULL, hol_tridiagonal_inverse_band(5, g, 0, NULL));
    CHECK_FAILS(HOL_ERR_VALUE, hol_tridiagonal_inverse_band(5, g, -1, out));
    assert_untouched(out, 25);
    free(out);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(small_matrices_have_the_closed_forms_of_the_appendix),
        cmocka_unit_test(equal_gammas_of_one_half_have_the_closed_form_up_to_a_million_rows),
        cmocka_unit_test(solutions_are_exact_for_the_given_doubles),
        cmocka_unit_test(one_small_pivot_is_found_wherever_it_stands),
        cmocka_unit_test(elements_solve_for_unit_vectors),
        cmocka_unit_test(nearly_singular_matrices_keep_all_digits),
        cmocka_unit_test(indefinite_matrices_are_refused_with_the_row),
        cmocka_unit_test(wrong_arguments_write_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
