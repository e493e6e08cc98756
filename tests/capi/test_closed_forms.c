/**
 * One to five bonds with equal masses and unit lengths against the closed forms of the appendix of Mazars 2007, with
 * the corrections of docs/theory.md: lambda = D Z~^-1 D (K + C), and the entries of Z~^-1 as polynomials of gamma.
 */
#include "chain.h"
#include "check.h"
#include "solution.h"

/** Z~^-1 for n bonds, from gamma_2 .. gamma_n (g[2] .. g[n]). */
static void inverse(int n, const long double *g, long double z[5][5])
{
    long double a[6] = {1, 1}, b[7]; /* leading and trailing minors of Z~ */
    for (int k = 2; k <= n; ++k) a[k] = a[k - 1] - g[k] * g[k] * a[k - 2];
    b[n + 1] = b[n] = 1;
    for (int k = n - 1; k >= 1; --k) b[k] = b[k + 1] - g[k + 1] * g[k + 1] * b[k + 2];
    for (int i = 1; i <= n; ++i) {
        long double product = 1;
        for (int j = i; j <= n; ++j) {
            if (j > i) product *= g[j];
            z[i - 1][j - 1] = z[j - 1][i - 1] = a[i - 1] * product * b[j + 1] / a[n];
        }
    }
}

/** The entries as the appendix prints them, for those that fit in a line: they must be what `inverse` gives. */
static void assert_printed_entries(int n, const long double *g, long double z[5][5])
{
    const long double p = g[2] * g[2], q = n > 2 ? g[3] * g[3] : 0, s = n > 3 ? g[4] * g[4] : 0;
    const long double tiny = 64 * long_double_rounding();
    if (n == 2) {
        CHECK_AT_MOST(fabsl(z[0][0] - 1 / (1 - p)), tiny);
        CHECK_AT_MOST(fabsl(z[0][1] - g[2] / (1 - p)), tiny);
    } else if (n == 3) {
        const long double det = 1 - p - q;
        CHECK_AT_MOST(fabsl(z[0][0] - (1 - q) / det), tiny);
        CHECK_AT_MOST(fabsl(z[0][2] - g[2] * g[3] / det), tiny);
        CHECK_AT_MOST(fabsl(z[1][1] - 1 / det), tiny);
        CHECK_AT_MOST(fabsl(z[2][2] - (1 - p) / det), tiny);
    } else if (n == 4) {
        const long double det = 1 - p - q - s * (1 - p);
        CHECK_AT_MOST(fabsl(z[0][0] - (1 - s - q) / det), tiny);
        CHECK_AT_MOST(fabsl(z[0][1] - g[2] * (1 - s) / det), tiny);
        CHECK_AT_MOST(fabsl(z[0][3] - g[2] * g[3] * g[4] / det), tiny);
        CHECK_AT_MOST(fabsl(z[1][2] - g[3] / det), tiny);
        CHECK_AT_MOST(fabsl(z[2][2] - (1 - p) / det), tiny);
        CHECK_AT_MOST(fabsl(z[2][3] - (1 - p) * g[4] / det), tiny);
        CHECK_AT_MOST(fabsl(z[3][3] - (1 - p - q) / det), tiny);
    }
}

static void closed_forms(int n, double mass, uint64_t seed)
{
    chain c = chain_make(CHAIN_COIL, n, seed);
    long double u[6][3], g[6] = {0}, a[6], right[6], z[5][5];
    for (int i = 0; i <= n; ++i) c.mass[i] = mass;
    for (int k = 1; k <= n; ++k) {
        long double square = 0, along = 0, speed = 0;
        for (int x = 0; x < 3; ++x) {
            u[k][x] = (long double)c.r[3 * k + x] - c.r[3 * k - 3 + x];
            square += u[k][x] * u[k][x];
        }
        a[k] = sqrtl(square);
        for (int x = 0; x < 3; ++x) {
            u[k][x] /= a[k];
            const long double dv = (long double)c.v[3 * k + x] - c.v[3 * k - 3 + x];
            along += ((long double)c.f[3 * k + x] - c.f[3 * k - 3 + x]) * u[k][x];
            speed += dv * dv;
        }
        right[k] = 2 * a[k] / mass * along + 2 * speed; /* K + C, (21) and (22) */
        if (k > 1) g[k] = (u[k - 1][0] * u[k][0] + u[k - 1][1] * u[k][1] + u[k - 1][2] * u[k][2]) / 2;
    }
    inverse(n, g, z);
    assert_printed_entries(n, g, z);
    double lambda[5], virial[9];
    hol_chains *chains;
    CHECK(hol_chains_create(n + 1, c.mass, &chains));
    CHECK(hol_chains_add_block(chains, 1, n, 0, c.length));
    CHECK(hol_forces(chains, c.r, c.v, c.f, lambda, NULL, NULL, HOL_WRITE, virial));
    const solution_problem p = {n, c.mass, NULL, c.r, c.v, c.f, NULL};
    solution exact;
    assert_int_equal(solution_forces(&p, &exact), 0);
    for (int i = 1; i <= n; ++i) {
        long double sum = 0;
        for (int j = 1; j <= n; ++j)
            sum += z[i - 1][j - 1] * right[j] / (8 * a[i] * a[j] / mass); /* Z_kk = 8 a^2 / m */
        CHECK_AT_MOST(fabsl(lambda[i - 1] - sum), oracle_bound(n) * DBL_EPSILON * exact.lambda_scale[i - 1]);
        CHECK_AT_MOST(fabsl(exact.lambda[i - 1] - sum), 1000 * long_double_rounding() * exact.lambda_scale[i - 1]);
    }
    solution_free(&exact);
    hol_chains_destroy(chains);
    chain_free(&c);
}

static void multipliers_are_the_corrected_closed_forms_for_one_to_five_bonds(void **state)
{
    (void)state;
    for (int n = 1; n <= 5; ++n)
        for (uint64_t seed = 0; seed < (quick_run() ? 10 : 200); ++seed) closed_forms(n, seed % 2 ? 1 : 2.5, seed);
}

static void one_bond_has_the_closed_form_with_a_quarter(void **state)
{
    (void)state;
    /* A.1.2 corrected: lambda = 1/(4a) [(F1 - F0).u + m/a (v1 - v0)^2]; here 1/8 [3 + 1/2 (1 + 4)] */
    const double mass[2] = {1, 1}, length = 2, r[6] = {0, 0, 0, 2, 0, 0}, v[6] = {0, 0, 0, 0, 1, 2},
                 f[6] = {-1, 5, 5, 2, 7, 1};
    double lambda, tension, g[6], virial[9];
    hol_chains *chains;
    CHECK(hol_chains_create(2, mass, &chains));
    CHECK(hol_chains_add_block(chains, 1, 1, 0, &length));
    CHECK(hol_forces(chains, r, v, f, &lambda, &tension, g, HOL_WRITE, virial));
    assert_true(lambda == 5.5 / 8);
    assert_true(tension == 2.75);
    assert_true(g[0] == 2.75 && g[3] == -2.75 && g[1] == 0 && g[2] == 0 && g[4] == 0 && g[5] == 0);
    assert_true(virial[0] == -5.5);
    for (int i = 1; i < 9; ++i) assert_true(virial[i] == 0);
    hol_chains_destroy(chains);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(multipliers_are_the_corrected_closed_forms_for_one_to_five_bonds),
        cmocka_unit_test(one_bond_has_the_closed_form_with_a_quarter),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
