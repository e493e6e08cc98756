/** One chain of a million bonds, and a million chains of three: set up well within a second, computed, and right. */
#define _DEFAULT_SOURCE
#include "chain.h"
#include "check.h"

#include <time.h>

static double seconds(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/** sigma'' of every bond is zero up to rounding: terms are of the order of ten, tensions up to a few hundred. */
static void assert_no_second_derivative(const chain *c, const double *g, int64_t bonds_per_chain)
{
    long double worst = 0;
    for (int64_t k = 0; k < c->n_bonds; ++k) {
        if (k % (bonds_per_chain + 1) == bonds_per_chain)
            continue; /* from the end of a chain to the start of the next */
        long double sum = 0, size = 0;
        for (int x = 0; x < 3; ++x) {
            const int64_t i = 3 * k + x, j = i + 3;
            const long double d = (long double)c->r[j] - c->r[i], u = (long double)c->v[j] - c->v[i];
            const long double p = (long double)c->f[j] + g[j], q = (long double)c->f[i] + g[i];
            sum += d * (p - q) + u * u;
            size += fabsl(d) * (fabs(c->f[j]) + fabs(g[j]) + fabs(c->f[i]) + fabs(g[i])) + u * u;
        }
        worst = fmaxl(worst, fabsl(sum) / (size + 1));
    }
    CHECK_AT_MOST(worst, 200 * DBL_EPSILON); /* pulls of neighbouring bonds may be some times larger than their sum */
}

static void run(int64_t n_chains, int64_t bonds_per_chain)
{
    const int64_t atoms = n_chains * (bonds_per_chain + 1);
    chain c = chain_make(CHAIN_COIL, atoms - 1, 5);
    hol_chains *chains;
    double *ones = malloc(sizeof *ones * (size_t)bonds_per_chain), *g = untouched(3 * (size_t)atoms), virial[9];
    double *lambda = untouched((size_t)(n_chains * bonds_per_chain));
    for (int64_t k = 0; k < bonds_per_chain; ++k) ones[k] = 1;
    double start = seconds();
    CHECK(hol_chains_create(atoms, c.mass, &chains));
    CHECK(hol_chains_add_block(chains, n_chains, bonds_per_chain, 0, ones));
    CHECK(hol_forces(chains, c.r, c.v, c.f, lambda, NULL, g, HOL_WRITE, virial));
    print_message("%lld chains of %lld: set-up and first call %.3f s, %.2f bytes per bond\n", (long long)n_chains,
                  (long long)bonds_per_chain, seconds() - start,
                  (double)hol_chains_memory(chains) / (double)(n_chains * bonds_per_chain));
    CHECK_AT_MOST(seconds() - start, 2.0); /* seconds: a tenth of that on a free machine */
    hol_chains_destroy(chains);
    start = seconds();
    int64_t *list = malloc(sizeof *list * (size_t)atoms);
    for (int64_t i = 0; i < atoms; ++i) list[i] = i;
    CHECK(hol_chains_create(atoms, c.mass, &chains));
    for (int64_t k = 0; k < n_chains; ++k)
        CHECK(hol_chains_add(chains, bonds_per_chain, list + k * (bonds_per_chain + 1), ones));
    print_message("  by lists of atoms: %.3f s, %.2f bytes per bond\n", seconds() - start,
                  (double)hol_chains_memory(chains) / (double)(n_chains * bonds_per_chain));
    CHECK_AT_MOST(seconds() - start, 4.0);
    assert_no_second_derivative(&c, g, bonds_per_chain);
    double *again = untouched(3 * (size_t)atoms);
    CHECK(hol_forces(chains, c.r, c.v, c.f, NULL, NULL, again, HOL_WRITE, NULL));
    assert_same_bits(g, again, 3 * (size_t)atoms);
    CHECK(hol_project_velocities(chains, c.r, c.v, NULL, virial));
    for (int64_t i = 0; i < 3 * atoms; ++i) again[i] = c.r[i] + 0.005 * c.v[i];
    hol_report report;
    hol_worst worst;
    CHECK(hol_project_positions(chains, c.r, again, c.v, 0.005, lambda, 0, virial, &report));
    assert_int_equal(report.n_corrected, n_chains);
    CHECK(hol_violation(chains, again, NULL, &worst));
    /* all atoms lie on one walk of a million steps: coordinates of the order of 1000, up to 3000 */
    CHECK_AT_MOST(worst.length, 2 * sqrt(3) * 3000 * DBL_EPSILON);
    free(ones), free(g), free(lambda), free(list), free(again);
    hol_chains_destroy(chains);
    chain_free(&c);
}

static void one_chain_of_a_million_bonds(void **state)
{
    (void)state;
    run(1, 1000000);
}

static void a_million_chains_of_three_bonds(void **state)
{
    (void)state;
    run(1000000, 3);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_chain_of_a_million_bonds),
        cmocka_unit_test(a_million_chains_of_three_bonds),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
