/** The inverse of Z: against 113-bit solutions and closed forms, and its error bounds against true errors. */
#include "chain.h"
#include "check.h"
#include "inverse.h"
#include "random.h"
#include "solution.h"

static int64_t fewest(int kind)
{
    return kind == CHAIN_FIXED_ENDS || kind == CHAIN_TAUT ? 2 : 1;
}

static double bond_length(const chain *c, int64_t k)
{
    const double *r = c->r + 3 * k;
    return sqrt((r[3] - r[0]) * (r[3] - r[0]) + (r[4] - r[1]) * (r[4] - r[1]) + (r[5] - r[2]) * (r[5] - r[2]));
}

static double inverse_mass(const chain *c, int64_t i)
{
    return c->mass[i] == 0 ? 0 : 1 / c->mass[i];
}

static void elements_agree_with_113_bits_for_every_kind_of_chain(void **state)
{
    (void)state;
    const int64_t sizes[] = {1, 2, 3, 7, 40, quick_run() ? 60 : 300};
    for (int kind = 0; kind < CHAIN_KINDS; ++kind)
        for (int s = quick_run() ? 3 : 0; s < 6; ++s) {
            const int64_t n = sizes[s];
            if (n < fewest(kind)) continue;
            chain c = chain_make((chain_kind)kind, n, (uint64_t)(50 + s));
            double *w = malloc(sizeof(double) * ((size_t)n + 1)), *row = untouched((size_t)n);
            long double *exact = malloc(sizeof(long double) * (size_t)n);
            assert_true(w && exact);
            for (int64_t i = 0; i <= n; ++i) w[i] = inverse_mass(&c, i);
            const solution_problem p = {n, c.mass, w, c.r, NULL, NULL, NULL};
            hol_inverse *inverse = inverse_of(&c);
            assert_int_equal(hol_inverse_n_bonds(inverse), n);
            for (int64_t i = 0; i<n; i += n> 40 ? 37 : 1) {
                assert_int_equal(solution_inverse_column(&p, i, exact), 0);
                CHECK(hol_inverse_row(inverse, HOL_UNIT_DIAGONAL, i, row));
                for (int64_t j = 0; j < n; ++j) {
                    const long double bound = oracle_bound(n) + 2 * (long double)llabs((long long)(i - j));
                    double value, physical;
                    CHECK(hol_inverse_entry(inverse, HOL_UNIT_DIAGONAL, i, j, &value));
                    CHECK(hol_inverse_entry(inverse, HOL_PHYSICAL, i, j, &physical));
                    /* elements below the normal numbers keep what digits those have */
                    const long double tiny = DBL_MIN * DBL_EPSILON * 4;
                    CHECK_AT_MOST(fabsl(value - exact[j]), bound * DBL_EPSILON * fabsl(exact[j]) + tiny);
                    CHECK_AT_MOST(fabsl(row[j] - exact[j]), bound * DBL_EPSILON * fabsl(exact[j]) + tiny);
                    /* Z^-1 = D Z~^-1 D with D_k = 1 / (2 |d_k| sqrt(w + w')); its own ten roundings on top */
                    const long double mi = (long double)w[i] + w[i + 1], mj = (long double)w[j] + w[j + 1];
                    const long double z = exact[j] / (4 * sqrtl(mi * mj) * bond_length(&c, i) * bond_length(&c, j));
                    const long double tiny_z = tiny / (bond_length(&c, i) * bond_length(&c, j) * sqrtl(mi * mj));
                    CHECK_AT_MOST(fabsl(physical - z), (bound + 10) * DBL_EPSILON * fabsl(z) + tiny_z);
                }
            }
            hol_inverse_destroy(inverse);
            free(w), free(row), free(exact);
            chain_free(&c);
        }
}

static void band_and_matrix_hold_the_same_elements(void **state)
{
    (void)state;
    const int64_t n = 23;
    for (int scaling = HOL_UNIT_DIAGONAL; scaling <= HOL_PHYSICAL; ++scaling) {
        chain c = chain_make(CHAIN_HETEROGENEOUS, n, 9);
        hol_inverse *inverse = inverse_of(&c);
        double matrix[23 * 23], band[23 * 31], value;
        CHECK(hol_inverse_matrix(inverse, scaling, matrix));
        for (int64_t width = 0; width <= 30; width += 5) {
            CHECK(hol_inverse_band(inverse, scaling, width, band));
            for (int64_t i = 0; i < n; ++i)
                for (int64_t k = 0; k <= width; ++k) {
                    const double element = band[i * (width + 1) + k];
                    assert_true(element == (i + k < n ? matrix[i * n + i + k] : 0));
                }
        }
        for (int64_t i = 0; i < n; ++i)
            for (int64_t j = 0; j < n; ++j) {
                CHECK(hol_inverse_entry(inverse, scaling, i, j, &value));
                assert_true(value == matrix[i * n + j] && value == matrix[j * n + i]);
            }
        hol_inverse_destroy(inverse);
        chain_free(&c);
    }
}

/** Z from its definition in the scaling asked for, in long double. */
static long double element_of_z(const chain *c, int scaling, int64_t k, int64_t l)
{
    if (llabs((long long)(k - l)) > 1) return 0;
    const long double mk = (long double)inverse_mass(c, k) + inverse_mass(c, k + 1);
    const long double ml = (long double)inverse_mass(c, l) + inverse_mass(c, l + 1);
    long double kl = 0, kk = 0, ll = 0;
    for (int x = 0; x < 3; ++x) {
        const long double dk = (long double)c->r[3 * k + 3 + x] - c->r[3 * k + x];
        const long double dl = (long double)c->r[3 * l + 3 + x] - c->r[3 * l + x];
        kl += dk * dl, kk += dk * dk, ll += dl * dl;
    }
    if (k == l) return scaling == HOL_PHYSICAL ? 4 * mk * kk : 1;
    const long double beside = -4 * inverse_mass(c, k > l ? k : l) * kl;
    return scaling == HOL_PHYSICAL ? beside : beside / (4 * sqrtl(mk * ml * kk * ll));
}

static void inverse_times_matrix_is_the_identity(void **state)
{
    (void)state;
    for (int kind = 0; kind < CHAIN_KINDS; ++kind)
        for (int scaling = HOL_UNIT_DIAGONAL; scaling <= HOL_PHYSICAL; ++scaling) {
            const int64_t n = 30;
            chain c = chain_make((chain_kind)kind, n, 12);
            hol_inverse *inverse = inverse_of(&c);
            double matrix[900];
            CHECK(hol_inverse_matrix(inverse, scaling, matrix));
            for (int64_t i = 0; i < n; ++i)
                for (int64_t j = 0; j < n; ++j) {
                    long double sum = 0, size = 0;
                    for (int64_t k = j > 0 ? j - 1 : 0; k <= j + 1 && k < n; ++k) {
                        const long double term = matrix[i * n + k] * element_of_z(&c, scaling, k, j);
                        sum += term;
                        size += fabsl(term);
                    }
                    /* each of three terms carries the bound of its element */
                    CHECK_AT_MOST(fabsl(sum - (i == j)), (oracle_bound(n) + 2 * 30) * DBL_EPSILON * size);
                }
            hol_inverse_destroy(inverse);
            chain_free(&c);
        }
}

static void straight_chain_has_the_closed_form_up_to_a_million_bonds(void **state)
{
    (void)state;
    for (int64_t n = 1; n <= (quick_run() ? 1000 : 1000000); n *= 10) {
        chain c = chain_make(CHAIN_STRAIGHT, n, 1);
        hol_inverse *inverse = inverse_of(&c);
        random_stream random = random_seed(3);
        double value, condition;
        for (int t = 0; t < 40; ++t) {
            const int64_t i = random_integer(&random, 1, n), j = random_integer(&random, 1, n);
            const int64_t low = i < j ? i : j, high = i < j ? j : i;
            const long double exact = 2.0L * (long double)low * (long double)(n + 1 - high) / (long double)(n + 1);
            CHECK(hol_inverse_entry(inverse, HOL_UNIT_DIAGONAL, i - 1, j - 1, &value));
            CHECK_AT_MOST(fabsl(value - exact),
                          (oracle_bound(n) + 2 * (long double)(high - low)) * DBL_EPSILON * exact);
        }
        /* |Z~| = 2, largest row of the inverse: sum_j 2 min(i,j)(N+1-max)/(N+1) = i (N+1-i) at the middle */
        const long double middle = (long double)((n + 1) / 2);
        const long double exact = (n == 1 ? 1 : n == 2 ? 1.5L : 2) * middle * ((long double)(n + 1) - middle);
        CHECK(hol_inverse_condition(inverse, &condition));
        /* sums of elements, each within its own bound */
        CHECK_AT_MOST(fabsl(condition - exact), (oracle_bound(n) + 2 * (long double)n) * DBL_EPSILON * exact);
        hol_inverse_destroy(inverse);
        chain_free(&c);
    }
}

static void condition_number_is_that_of_the_dense_matrices(void **state)
{
    (void)state;
    for (int kind = 0; kind < CHAIN_KINDS; ++kind)
        for (int64_t n = 2; n <= 32; n += 10) {
            chain c = chain_make((chain_kind)kind, n, 31);
            const solution_problem p = {n, c.mass, NULL, c.r, NULL, NULL, NULL};
            solution_metric exact;
            double condition;
            assert_int_equal(solution_metric_make(&p, &exact), 0);
            hol_inverse *inverse = inverse_of(&c);
            CHECK(hol_inverse_condition(inverse, &condition));
            CHECK_AT_MOST(fabsl(condition - exact.condition),
                          (oracle_bound(n) + 2 * (long double)n) * DBL_EPSILON * exact.condition);
            solution_metric_free(&exact);
            hol_inverse_destroy(inverse);
            chain_free(&c);
        }
}

/** Bounds hold for the library's multipliers and for spoilt ones, and are not idle. */
static void error_bounds_hold_and_are_close(chain_kind kind, int64_t n, long double spoil)
{
    chain c = chain_make(kind, n, 77);
    double *w = malloc(sizeof(double) * ((size_t)n + 1)), *lambda = untouched((size_t)n), *bound = untouched((size_t)n);
    assert_non_null(w);
    for (int64_t i = 0; i <= n; ++i) w[i] = inverse_mass(&c, i);
    const solution_problem p = {n, c.mass, w, c.r, c.v, c.f, NULL};
    solution exact;
    double relative;
    assert_int_equal(solution_forces(&p, &exact), 0);
    hol_chains *chains = handle_of(&c);
    hol_inverse *inverse = inverse_of(&c);
    CHECK(hol_forces(chains, c.r, c.v, c.f, lambda, NULL, NULL, HOL_WRITE, NULL));
    random_stream random = random_seed(4);
    for (int64_t k = 0; k < n; ++k) lambda[k] += (double)(spoil * exact.lambda_scale[k]) * random_normal(&random);
    CHECK(hol_inverse_error_bound(inverse, c.v, c.f, lambda, bound, &relative));
    long double error = 0, largest = 0, size = 0;
    for (int64_t k = 0; k < n; ++k) {
        const long double e = fabsl(lambda[k] - exact.lambda[k]);
        /* the reference is rounded to 64 bits */
        CHECK_AT_MOST(e, bound[k] + long_double_rounding() * exact.lambda_scale[k]);
        if (e > error) error = e;
        if (bound[k] > largest) largest = bound[k];
        if (fabs(lambda[k]) > size) size = fabs(lambda[k]);
    }
    CHECK_AT_MOST(fabsl(relative - largest / size), 4 * DBL_EPSILON * relative);
    /* A residual is moved by each multiplier times its row of Z, so the bound is at most |Z^-1| |Z| times the error. */
    double condition;
    CHECK(hol_inverse_condition(inverse, &condition));
    if (kind == CHAIN_COIL) CHECK_AT_MOST(largest, 1.1 * condition * (error + long_double_rounding() * size));
    hol_inverse_destroy(inverse);
    hol_chains_destroy(chains);
    solution_free(&exact);
    free(w), free(lambda), free(bound);
    chain_free(&c);
}

static void error_bounds_hold_for_exact_and_for_spoilt_multipliers(void **state)
{
    (void)state;
    for (int kind = 0; kind < CHAIN_KINDS; ++kind)
        for (int64_t n = fewest(kind); n <= (quick_run() ? 40 : 200); n = 3 * n + 1) {
            error_bounds_hold_and_are_close((chain_kind)kind, n, 0);
            error_bounds_hold_and_are_close((chain_kind)kind, n, 1e-9L);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(elements_agree_with_113_bits_for_every_kind_of_chain),
        cmocka_unit_test(band_and_matrix_hold_the_same_elements),
        cmocka_unit_test(inverse_times_matrix_is_the_identity),
        cmocka_unit_test(straight_chain_has_the_closed_form_up_to_a_million_bonds),
        cmocka_unit_test(condition_number_is_that_of_the_dense_matrices),
        cmocka_unit_test(error_bounds_hold_for_exact_and_for_spoilt_multipliers),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
