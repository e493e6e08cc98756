#include <float.h>
#include <holonomic.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "check_cases.h"
#include "worst.h"

/** The chain's masses as the library takes them: 0 where the inverse mass is 0. */
static void masses(const oracle_case *c, double *m)
{
    for (int64_t i = 0; i <= c->n_bonds; ++i) m[i] = c->w[i] == 0 ? 0 : c->mass[i];
}

static hol_chains *one_chain(const oracle_case *c, const double *m)
{
    hol_chains *chains = NULL;
    if (hol_chains_create(c->n_bonds + 1, m, &chains) == HOL_OK &&
        hol_chains_add_block(chains, 1, c->n_bonds, 0, c->length) == HOL_OK)
        return chains;
    hol_chains_destroy(chains);
    return NULL;
}

/** lambda, G and virial. Returns the largest error over bound, or infinity if a call fails. */
static long double check_forces(const oracle_case *c, const hol_chains *chains)
{
    const int64_t n = c->n_bonds;
    const long double k = 16 + sqrtl((long double)n);
    double *lambda = malloc(sizeof(double) * (size_t)(n + 3 * (n + 1))), virial[9];
    if (!lambda) return HUGE_VALL;
    double *g = lambda + n;
    worst of_lambda = {0, 0, 0}, of_g = {0, 0, 0}, of_virial = {0, 0, 0};
    const int status = hol_forces(chains, c->r, c->v, c->f, lambda, NULL, g, HOL_WRITE, virial);
    if (status != HOL_OK) {
        print_failure(c->name, "a call failed", status);
        free(lambda);
        return HUGE_VALL;
    }
    long double virial_scale = 0;
    for (int64_t a = 0; a < n; ++a) {
        long double square = 0;
        for (int x = 0; x < 3; ++x) {
            const long double d = (long double)c->r[3 * a + 3 + x] - c->r[3 * a + x];
            square += d * d;
        }
        compare(&of_lambda, lambda[a], c->lambda[a], c->lambda_scale[a], k);
        virial_scale += 2 * c->lambda_scale[a] * square;
    }
    for (int64_t i = 0; i < 3 * (n + 1); ++i) compare(&of_g, g[i], c->g[i], c->g_scale[i / 3], k);
    for (int i = 0; i < 9; ++i) compare(&of_virial, virial[i], c->virial[i], virial_scale, k);
    print_worst(c->name, "lambda", &of_lambda);
    print_worst(c->name, "G", &of_g);
    print_worst(c->name, "virial", &of_virial);
    free(lambda);
    return larger_ratio(larger_ratio(larger_ratio(0, &of_lambda), &of_g), &of_virial);
}

/** ln det Z~, the Fixman potential at kT = 1 and its force. */
static long double check_metric(const oracle_case *c, const hol_chains *chains)
{
    const int64_t n = c->n_bonds;
    const long double k = 16 + sqrtl((long double)n);
    double log_det, energy, *force = malloc(sizeof(double) * 3 * (size_t)(n + 1));
    if (!force) return HUGE_VALL;
    worst of_det = {0, 0, 0}, of_energy = {0, 0, 0}, of_force = {0, 0, 0};
    const int status = hol_metric(chains, c->r, 1, &log_det, NULL, &energy, force, HOL_WRITE);
    if (status != HOL_OK) {
        print_failure(c->name, "a call failed", status);
        free(force);
        return HUGE_VALL;
    }
    compare(&of_det, log_det, c->lndet, fabsl(c->lndet), k);
    compare(&of_energy, energy, c->fixman_energy, fabsl(c->fixman_energy), k);
    for (int64_t i = 0; i < 3 * (n + 1); ++i)
        compare(&of_force, force[i], c->fixman_force[i], c->fixman_scale[i / 3], 2 * k);
    print_worst(c->name, "lndet", &of_det);
    print_worst(c->name, "fixman_energy", &of_energy);
    print_worst(c->name, "Fixman force", &of_force);
    free(force);
    return larger_ratio(larger_ratio(larger_ratio(0, &of_det), &of_energy), &of_force);
}

/** Elements of Z~^-1. */
static long double check_inverse(const oracle_case *c, const hol_chains *chains)
{
    const long double k = 16 + sqrtl((long double)c->n_bonds);
    hol_inverse *inverse = NULL;
    worst of_entry = {0, 0, 0};
    int status = hol_inverse_create(chains, 0, c->r, &inverse);
    for (int64_t e = 0; e < c->n_zinv && status == HOL_OK; ++e) {
        const oracle_entry *z = c->zinv + e;
        double value;
        status = hol_inverse_entry(inverse, HOL_UNIT_DIAGONAL, z->i - 1, z->j - 1, &value);
        if (status == HOL_OK)
            compare(&of_entry, value, z->value, fabsl(z->value), k + 2 * (long double)llabs(z->i - z->j));
    }
    hol_inverse_destroy(inverse);
    if (status != HOL_OK) {
        print_failure(c->name, "a call failed", status);
        return HUGE_VALL;
    }
    if (c->n_zinv > 0) print_worst(c->name, "zinv", &of_entry);
    return larger_ratio(0, &of_entry);
}

/** All quantities of one case. */
long double check_chain_case(const oracle_case *c)
{
    double *m = malloc(sizeof(double) * (size_t)(c->n_bonds + 1));
    hol_chains *chains = NULL;
    long double ratio = HUGE_VALL;
    if (m) {
        masses(c, m);
        chains = one_chain(c, m);
    }
    if (chains) {
        ratio = check_forces(c, chains);
        ratio = fmaxl(ratio, check_metric(c, chains));
        ratio = fmaxl(ratio, check_inverse(c, chains));
        ratio = fmaxl(ratio, check_fit(c->name, chains, c->n_bonds + 1, c->n_bonds, NULL, c->length, c->r));
    } else {
        printf("%-36s the library takes no such chain: %s\n", c->name, m ? hol_error_message() : "out of memory");
    }
    hol_chains_destroy(chains);
    free(m);
    return ratio;
}
