/**
 * Writes reference files in the format of tests/oracle, from the independent solution in 113-bit arithmetic:
 *     make_case DIR KIND N_BONDS SEED
 * adds DIR/KIND_nNNN_SEED.txt and its line in DIR/INDEX. KIND is a number, a chain_kind of chain.h.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "chain.h"
#include "solution.h"

/** A result; zero is written as the format wants it. */
static void result(FILE *out, long double x)
{
    if (x == 0)
        fputs(" 0.0", out);
    else
        fprintf(out, " %.20Le", x);
}

static void scale(FILE *out, long double x)
{
    if (x == 0)
        fputs(" 0.0", out);
    else
        fprintf(out, " %.5Le", x);
}

static void inputs(FILE *out, const double *x)
{
    fprintf(out, " %.16e %.16e %.16e", x[0], x[1], x[2]);
}

static void write_inputs(FILE *out, const chain *c, const double *w)
{
    fprintf(out, "atoms_in\n");
    for (int64_t i = 0; i <= c->n_bonds; ++i) {
        fprintf(out, "%lld %.16e %.16e", (long long)i, w[i], w[i] > 0 ? c->mass[i] : -1.0);
        inputs(out, c->r + 3 * i);
        inputs(out, c->v + 3 * i);
        inputs(out, c->f + 3 * i);
        fputc('\n', out);
    }
    fprintf(out, "bonds_in\n");
    for (int64_t k = 0; k < c->n_bonds; ++k) fprintf(out, "%lld %.16e\n", (long long)k + 1, c->length[k]);
}

static void write_results(FILE *out, const solution *s, const solution_metric *m)
{
    static const int upper[6] = {0, 1, 2, 4, 5, 8};
    fprintf(out, "lndet");
    result(out, m->log_det);
    fprintf(out, "\nfixman_energy");
    result(out, m->log_det / 2);
    fprintf(out, "\nvirial");
    for (int i = 0; i < 6; ++i) result(out, s->virial[upper[i]]);
    fprintf(out, "\ncond %.5Le\nbonds_out\n", m->condition);
    for (int64_t k = 0; k < s->n_bonds; ++k) {
        fprintf(out, "%lld", (long long)k + 1);
        result(out, s->lambda[k]);
        scale(out, s->lambda_scale[k]);
        fputc('\n', out);
    }
    fprintf(out, "atoms_out\n");
    for (int64_t i = 0; i <= s->n_bonds; ++i) {
        fprintf(out, "%lld", (long long)i);
        for (int x = 0; x < 3; ++x) result(out, s->g[3 * i + x]);
        scale(out, s->g_scale[i]);
        for (int x = 0; x < 3; ++x) result(out, m->fixman_force[3 * i + x]);
        scale(out, m->fixman_scale[i]);
        fputc('\n', out);
    }
}

/** A few entries of Z~^-1: near the diagonal and far from it. */
static int write_entries(FILE *out, const solution_problem *p)
{
    const int64_t n = p->n_bonds, near = n > 1 ? 2 : 1, middle = (n + 1) / 2, far = n < 20 ? n : 20;
    const int64_t entries[6][2] = {{1, 1}, {1, near}, {middle, middle}, {n - near + 1, n}, {1, far}, {n, n}};
    long double *column = malloc(sizeof *column * (size_t)n);
    if (!column) return -1;
    fprintf(out, "zinv 6\n");
    for (int e = 0; e < 6; ++e) {
        if (solution_inverse_column(p, entries[e][1] - 1, column)) break;
        fprintf(out, "%lld %lld", (long long)entries[e][0], (long long)entries[e][1]);
        result(out, column[entries[e][0] - 1]);
        fputc('\n', out);
    }
    fprintf(out, "end\n");
    free(column);
    return 0;
}

static int write_case(FILE *out, const char *name, const chain *c, const double *w)
{
    const solution_problem p = {c->n_bonds, NULL, w, c->r, c->v, c->f, NULL};
    solution s;
    solution_metric m;
    if (solution_forces(&p, &s) || solution_metric_make(&p, &m)) return -1;
    /* what elimination in extended arithmetic has lost must be far below one rounding of a double, 2.2e-16 */
    const int lost = !(m.condition * solution_epsilon() * (long double)c->n_bonds < 1e-18L);
    fprintf(out, "# %s, computed with %.1Le relative rounding\ncase %s\nnbonds %lld\n", name, solution_epsilon(), name,
            (long long)c->n_bonds);
    write_inputs(out, c, w);
    write_results(out, &s, &m);
    if (lost) fprintf(stderr, "make_case: %s: condition number %Lg leaves too few digits\n", name, m.condition);
    const int status = write_entries(out, &p);
    solution_free(&s);
    solution_metric_free(&m);
    return lost ? -1 : status;
}

int main(int argc, char **argv)
{
    if (argc != 5) {
        fprintf(stderr, "usage: make_case DIR KIND N_BONDS SEED\n");
        return 2;
    }
    const int kind = atoi(argv[2]);
    const long long n = atoll(argv[3]), seed = atoll(argv[4]);
    if (kind < 0 || kind >= CHAIN_KINDS || n < 1 || n > 5000 || seed < 0) {
        fprintf(stderr, "make_case: KIND 0..%d, N_BONDS 1..5000, SEED >= 0\n", CHAIN_KINDS - 1);
        return 2;
    }
    chain c = chain_make((chain_kind)kind, n, (uint64_t)seed);
    double *w = calloc((size_t)n + 1, sizeof *w);
    char name[64], path[4096];
    snprintf(name, sizeof name, "%s_n%03lld_%lld", chain_kind_name((chain_kind)kind), n, seed);
    for (char *p = name; *p; ++p)
        if (*p == ' ') *p = '_';
    for (int64_t i = 0; w && i <= n; ++i) { /* as in the files: w exact, m the nearest double to its inverse */
        w[i] = c.mass[i] > 0 ? 1 / c.mass[i] : 0;
        c.mass[i] = w[i] > 0 ? 1 / w[i] : 0;
    }
    snprintf(path, sizeof path, "%s/%s.txt", argv[1], name);
    FILE *out = w ? fopen(path, "w") : NULL;
    if (!out) {
        fprintf(stderr, "make_case: cannot write %s\n", path);
        return 2;
    }
    int status = write_case(out, name, &c, w);
    status |= fclose(out);
    snprintf(path, sizeof path, "%s/INDEX", argv[1]);
    out = status ? NULL : fopen(path, "a");
    if (out) {
        fprintf(out, "%s.txt\n", name);
        fclose(out);
    }
    free(w);
    chain_free(&c);
    return status || !out ? 1 : 0;
}
