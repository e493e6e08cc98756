/**
 * Checks the library against reference files: check_oracle DIR reads DIR/INDEX and the files that it lists.
 * A line per case and quantity: the worst error in units of eps times its scale, and the bound of
 * tests/oracle/README.md. Exit status 0: all within their bounds; 1: one is not; 2: the files cannot be read.
 */
#include <float.h>
#include <holonomic.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "oracle_file.h"

/** Largest error of one quantity of one case. */
typedef struct worst {
    long double error; /* in units of eps times its scale */
    long double ratio; /* error over bound */
    long double bound;
} worst;

/** Takes in one number: an exactly zero reference or scale must be met exactly. */
static void compare(worst *w, double value, long double reference, long double scale, long double bound)
{
    const long double difference = fabsl(value - reference);
    long double error = difference / (DBL_EPSILON * scale);
    if (reference == 0 || scale == 0) error = value == 0 && reference == 0 ? 0 : HUGE_VALL;
    if (isnan(value)) error = HUGE_VALL;
    if (!(error / bound < w->ratio) || w->bound == 0) {
        w->error = error;
        w->ratio = error / bound;
        w->bound = bound;
    }
}

static void print(const char *name, const char *quantity, const worst *w)
{
    printf("%-36s %-14s %10.3Lg of %7.2Lf  %s\n", name, quantity, w->error, w->bound,
           w->ratio <= 1 ? "ok" : "OUT OF BOUND");
}

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

static long double larger(long double a, const worst *w)
{
    return w->ratio > a || isnan(w->ratio) ? w->ratio : a;
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
        printf("%-36s %s: %s\n", c->name, hol_status_name(status), hol_error_message());
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
    print(c->name, "lambda", &of_lambda);
    print(c->name, "G", &of_g);
    print(c->name, "virial", &of_virial);
    free(lambda);
    return larger(larger(larger(0, &of_lambda), &of_g), &of_virial);
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
        printf("%-36s %s: %s\n", c->name, hol_status_name(status), hol_error_message());
        free(force);
        return HUGE_VALL;
    }
    compare(&of_det, log_det, c->lndet, fabsl(c->lndet), k);
    compare(&of_energy, energy, c->fixman_energy, fabsl(c->fixman_energy), k);
    for (int64_t i = 0; i < 3 * (n + 1); ++i)
        compare(&of_force, force[i], c->fixman_force[i], c->fixman_scale[i / 3], 2 * k);
    print(c->name, "lndet", &of_det);
    print(c->name, "fixman_energy", &of_energy);
    print(c->name, "Fixman force", &of_force);
    free(force);
    return larger(larger(larger(0, &of_det), &of_energy), &of_force);
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
        printf("%-36s %s: %s\n", c->name, hol_status_name(status), hol_error_message());
        return HUGE_VALL;
    }
    if (c->n_zinv > 0) print(c->name, "zinv", &of_entry);
    return larger(0, &of_entry);
}

/** All quantities of one case. */
static long double check_case(const oracle_case *c)
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
    } else {
        printf("%-36s the library takes no such chain: %s\n", c->name, m ? hol_error_message() : "out of memory");
    }
    hol_chains_destroy(chains);
    free(m);
    return ratio;
}

/** Reads the next file name from INDEX: 1, or 0 at its end. */
static int next_name(FILE *index, char *name, size_t size)
{
    char line[512];
    while (fgets(line, sizeof line, index)) {
        line[strcspn(line, "\r\n#")] = 0;
        if (sscanf(line, " %255s", name) == 1 && strlen(name) < size) return 1;
    }
    return 0;
}

int main(int argc, char **argv)
{
    char path[4096], name[256], message[4400];
    if (argc != 2) {
        fprintf(stderr, "usage: check_oracle DIR\n");
        return 2;
    }
    snprintf(path, sizeof path, "%s/INDEX", argv[1]);
    FILE *index = fopen(path, "r");
    if (!index) {
        fprintf(stderr, "oracle: no readable file INDEX, which lists the cases, in %s\n", argv[1]);
        return 2;
    }
    long double ratio = 0;
    int count = 0;
    while (next_name(index, name, sizeof name)) {
        oracle_case c;
        snprintf(path, sizeof path, "%s/%s", argv[1], name);
        if (oracle_read(path, &c, message, sizeof message)) {
            fprintf(stderr, "oracle: %s\n", message);
            fclose(index);
            return 2;
        }
        const long double of_case = check_case(&c);
        if (of_case > ratio) ratio = of_case;
        ++count;
        oracle_free(&c);
    }
    fclose(index);
    if (count == 0) {
        fprintf(stderr, "oracle: %s/INDEX lists no case\n", argv[1]);
        return 2;
    }
    printf("not checked: cond and the bond lengths, which the files give for information only\n");
    printf("oracle: %d cases, worst ratio %.3Lg\n", count, ratio);
    return ratio <= 1 ? 0 : 1;
}
