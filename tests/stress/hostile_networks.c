/**
 * Hostile networks against solutions in 448 bits: nearly straight strands, masses over decades, fixed nodes, bonds of
 * very different lengths, trees, open or with cycles round the box; large enough to be worked on as networks. From
 * number 1000 on lattices of single bonds, some of them strands, with planes that are nearly flat.
 *
 *     hostile_networks [first=1] [n=12]
 *
 * Every result is right within the oracle's bound or refused; a refused one has a condition that doubles can't bear.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "check.h"
#include "molecule.h"
#include "molecule_solution.h"
#include "random.h"

typedef struct {
    molecule m;
    double box[9], side;
    int periodic;
    hol_chains *chains;
    double curl, decades;
    int fixed, trees, longest;
} network;

static double pick(random_stream *random, double low, double high)
{
    return low + (high - low) * random_uniform(random);
}
static void image(const network *s, double *d)
{
    for (int c = 0; c < 3 && s->periodic; ++c) d[c] -= s->side * nearbyint(d[c] / s->side);
}
static double mass(const network *s, random_stream *random)
{
    return pow(10, pick(random, -0.5, 0.5) * s->decades);
}

static void add_strand(network *s, int64_t from, int64_t to, random_stream *random)
{
    double gap[3], at[3], walk[64][3], sum[3] = {0, 0, 0}, reach = 0;
    for (int c = 0; c < 3; ++c) gap[c] = s->m.r[3 * to + c] - s->m.r[3 * from + c];
    image(s, gap);
    for (int c = 0; c < 3; ++c) reach += gap[c] * gap[c];
    int n = 1 + (int)pick(random, 3, s->longest);
    while (n < 60 && sqrt(reach) / n > 0.2 * s->side) ++n;
    const double step = s->curl * sqrt(reach) / n;
    for (int k = 0; k < n; ++k) {
        random_direction(random, walk[k]);
        for (int c = 0; c < 3; ++c) sum[c] += walk[k][c] *= step;
    }
    memcpy(at, s->m.r + 3 * from, sizeof at);
    int64_t last = from;
    for (int k = 0; k < n; ++k) {
        for (int c = 0; c < 3; ++c) at[c] += walk[k][c] + (gap[c] - sum[c]) / n;
        const int64_t next = k + 1 < n ? molecule_add_atom(&s->m, mass(s, random), at) : to;
        molecule_add_bond(&s->m, last, next);
        last = next;
        double u[3];
        random_direction(random, u);
        if (k + 1 < n && s->trees && k == 2) molecule_grow(&s->m, next, mass(s, random), 1, u);
    }
}

static void finish(network *s, random_stream *random)
{
    molecule_finish(&s->m, random);
    for (int64_t k = 0; k < s->m.n_bonds; ++k) {
        double d[3];
        for (int c = 0; c < 3; ++c) d[c] = s->m.r[3 * s->m.pairs[2 * k + 1] + c] - s->m.r[3 * s->m.pairs[2 * k] + c];
        image(s, d);
        s->m.length[k] = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    }
    CHECK(hol_chains_create(s->m.n_atoms, s->m.mass, &s->chains));
    if (s->periodic) CHECK(hol_chains_set_box(s->chains, s->box));
    CHECK(hol_chains_add_bonds(s->chains, s->m.n_bonds, s->m.pairs, s->m.length));
}

/* n^3 atoms at a distance of 1, in a box of a cell more where it is periodic; `curl` is their disorder. */
static network make_lattice(random_stream random)
{
    network s = {.m = molecule_empty()};
    const int n = 6;
    s.periodic = random_uniform(&random) < 0.5;
    s.side = n;
    s.curl = random_uniform(&random) < 0.4 ? 0.3 : pow(10, pick(&random, -4, -0.5));
    s.decades = random_uniform(&random) < 0.5 ? 0 : pick(&random, 0, 8);
    s.fixed = random_uniform(&random) < 0.3;
    s.longest = 4;
    s.box[0] = s.box[4] = s.box[8] = s.side;
    const double left_out = pick(&random, 0.2, 0.35), split = random_uniform(&random) < 0.3 ? 0.1 : 0;
    for (int i = 0; i < n * n * n; ++i) {
        double r[3] = {i % n, i / n % n, i / (n * n)};
        for (int c = 0; c < 3; ++c) r[c] += s.curl * pick(&random, -1, 1);
        molecule_add_atom(&s.m, s.fixed && i % 11 == 3 ? 0 : mass(&s, &random), r);
    }
    for (int i = 0; i < n * n * n; ++i) {
        const int at[3] = {i % n, i / n % n, i / (n * n)}, step[3] = {1, n, n * n};
        for (int x = 0; x < 3; ++x) {
            if (at[x] + 1 == n && !s.periodic) continue;
            const int j = at[x] + 1 < n ? i + step[x] : i - (n - 1) * step[x];
            if (random_uniform(&random) < left_out || (s.m.mass[i] == 0 && s.m.mass[j] == 0)) continue;
            if (random_uniform(&random) < split)
                add_strand(&s, i, j, &random);
            else
                molecule_add_bond(&s.m, i, j);
        }
    }
    finish(&s, &random);
    return s;
}

static network make(uint64_t seed)
{
    network s = {.m = molecule_empty()};
    random_stream random = random_seed(seed);
    for (int i = 0; i < 4; ++i) random_uniform(&random);
    if (seed >= 1000) return make_lattice(random);
    const int nodes = 34 + (int)pick(&random, 0, 6);
    s.side = 12;
    s.periodic = random_uniform(&random) < 0.6;
    s.curl = random_uniform(&random) < 0.4 ? 1.5 : pow(10, pick(&random, -3, 0));
    s.decades = random_uniform(&random) < 0.5 ? 0 : pick(&random, 0, 12);
    s.fixed = random_uniform(&random) < 0.3;
    s.trees = random_uniform(&random) < 0.3;
    s.longest = 5 + (int)pick(&random, 0, 3);
    s.box[0] = s.box[4] = s.box[8] = s.side;
    int64_t stub[4 * 64];
    for (int i = 0; i < nodes; ++i) {
        double r[3];
        for (int c = 0; c < 3; ++c) r[c] = pick(&random, 0, s.side);
        molecule_add_atom(&s.m, s.fixed && i % 7 == 3 ? 0 : mass(&s, &random), r);
        for (int e = 0; e < 4; ++e) stub[4 * i + e] = i;
    }
    for (int i = 4 * nodes - 1; i > 0; --i) {
        const int j = (int)(pick(&random, 0, i + 1));
        const int64_t kept = stub[i];
        stub[i] = stub[j], stub[j] = kept;
    }
    for (int k = 0; k < 2 * nodes; ++k)
        if (stub[2 * k] != stub[2 * k + 1]) add_strand(&s, stub[2 * k], stub[2 * k + 1], &random);
    finish(&s, &random);
    return s;
}

/* The largest error of multipliers in units of eps times their scale, by the level. */
static double worst(const double *lambda, const molecule_solution *exact, int64_t n)
{
    double most = 0;
    for (int64_t k = 0; k < n; ++k) {
        const double e = (double)(fabsl(lambda[k] - exact->lambda[k]) / (exact->lambda_scale[k] * DBL_EPSILON));
        most = !(e <= most) ? e : most;
    }
    return most;
}

/* Forces and velocities; forces by kept factors; given right-hand sides, by hol_solve and by kept factors. */
enum { FORCES, VELOCITIES, KEPT_FORCES, GIVEN, KEPT_GIVEN, RESULTS };

/* Of each that is not refused; else -1. */
static void find_errors(const network *s, const molecule_problem *p, uint64_t seed, double *error)
{
    const molecule *m = &s->m;
    const size_t n = (size_t)m->n_bonds;
    double *lambda = calloc(n, sizeof *lambda), *rhs = calloc(n, sizeof *rhs);
    random_stream random = random_seed(seed + 77);
    hol_factors *factors;
    molecule_solution exact;
    for (size_t k = 0; k < n; ++k)
        rhs[k] = m->length[k] * random_normal(&random) * (random_uniform(&random) < 0.3 ? 1e-6 : 1);
    CHECK(hol_factors_create(s->chains, &factors));
    const int updated = hol_factors_update(factors, m->r);
    for (int i = 0; i < RESULTS; ++i) error[i] = -1;
    if (!molecule_forces(p, &exact)) {
        if (!hol_forces(s->chains, m->r, m->v, m->f, lambda, NULL, NULL, HOL_WRITE, NULL))
            error[FORCES] = worst(lambda, &exact, m->n_bonds);
        if (!updated && !hol_factors_forces(factors, m->v, m->f, lambda, NULL, NULL, HOL_WRITE, NULL))
            error[KEPT_FORCES] = worst(lambda, &exact, m->n_bonds);
        molecule_solution_free(&exact);
    }
    if (!molecule_velocities(p, &exact)) {
        if (!hol_project_velocities(s->chains, m->r, m->v, lambda, NULL))
            error[VELOCITIES] = worst(lambda, &exact, m->n_bonds);
        molecule_solution_free(&exact);
    }
    if (!molecule_solve(p, rhs, &exact)) {
        if (!hol_solve(s->chains, m->r, rhs, lambda, NULL, HOL_WRITE, NULL))
            error[GIVEN] = worst(lambda, &exact, m->n_bonds);
        if (!updated && !hol_factors_solve(factors, 1, rhs, lambda, NULL, HOL_WRITE, NULL))
            error[KEPT_GIVEN] = worst(lambda, &exact, m->n_bonds);
        molecule_solution_free(&exact);
    }
    hol_factors_destroy(factors);
    free(lambda), free(rhs);
}

int main(int argc, char **argv)
{
    const uint64_t first = argc > 1 ? strtoull(argv[1], NULL, 10) : 1, n = argc > 2 ? strtoull(argv[2], NULL, 10) : 12;
    int bad = 0;
    for (uint64_t seed = first; seed < first + n; ++seed) {
        network s = make(seed);
        molecule_problem p = molecule_problem_of(&s.m);
        if (s.periodic) p.box = s.box;
        double shortest = HUGE_VAL, error[RESULTS];
        for (int64_t k = 0; k < s.m.n_bonds; ++k) shortest = fmin(shortest, s.m.length[k]);
        find_errors(&s, &p, seed, error);
        /* Images round: a component of a bond by eps of a cell. */
        const double bound = (double)oracle_bound(s.m.n_bonds) + (s.periodic ? 8 * s.side / shortest : 0);
        int wrong = 0;
        for (int i = 0; i < RESULTS; ++i) wrong = wrong || error[i] > bound || error[i] != error[i];
        bad += wrong;
        printf("%llu: %lld bonds%s%s%s, curl %.1e, decades %.1f:", (unsigned long long)seed, (long long)s.m.n_bonds,
               s.periodic ? ", periodic" : "", s.fixed ? ", fixed nodes" : "", s.trees ? ", trees" : "", s.curl,
               s.decades);
        for (int i = 0; i < RESULTS; ++i) printf(" %.3g", error[i]);
        printf(" of %.3g%s\n", bound, wrong ? "  WRONG" : "");
        fflush(stdout);
        hol_chains_destroy(s.chains);
        molecule_free(&s.m);
    }
    return bad > 0;
}
