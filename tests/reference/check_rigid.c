#include <float.h>
#include <holonomic.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "check_cases.h"
#include "worst.h"

/** Arrays for all outputs of one molecule. */
typedef struct outputs {
    double *memory;
    double *lambda, *mu, *position_lambda;
    double *g, *v, *r;
    double virial[9];
} outputs;

static int make_outputs(const rigid_file *c, outputs *o)
{
    const size_t n = (size_t)c->n_bonds, atoms = (size_t)c->n_atoms;
    o->memory = calloc(3 * n + 9 * atoms, sizeof(double));
    if (!o->memory) return -1;
    o->lambda = o->memory;
    o->mu = o->lambda + n;
    o->position_lambda = o->mu + n;
    o->g = o->position_lambda + n;
    o->v = o->g + 3 * atoms;
    o->r = o->v + 3 * atoms;
    return 0;
}

/** 16 + sqrt of the number of constraints, those between the points that stand for a body included: one for a linear
 * body, three for a planar one, six for others; which it is, the distances of its massive atoms' places tell. */
static int body_constraints(const rigid_file *c, const int64_t *atoms, int64_t n)
{
    long double centre[3] = {0, 0, 0}, mass = 0, s[3][3] = {{0}};
    for (int64_t a = 0; a < n; ++a)
        for (int x = 0; x < 3; ++x) {
            centre[x] += (long double)c->mass[atoms[a]] * c->place[3 * atoms[a] + x];
            if (x == 0) mass += c->mass[atoms[a]];
        }
    for (int64_t a = 0; a < n; ++a)
        for (int x = 0; x < 3; ++x)
            for (int y = 0; y < 3; ++y)
                s[x][y] += c->mass[atoms[a]] * (c->place[3 * atoms[a] + x] - centre[x] / mass) *
                           (c->place[3 * atoms[a] + y] - centre[y] / mass);
    const long double trace = s[0][0] + s[1][1] + s[2][2];
    long double minors = 0;
    for (int x = 0; x < 3; ++x) {
        const int y = (x + 1) % 3;
        minors += s[x][x] * s[y][y] - s[x][y] * s[y][x];
    }
    const long double det = s[0][0] * (s[1][1] * s[2][2] - s[1][2] * s[2][1]) -
                            s[0][1] * (s[1][0] * s[2][2] - s[1][2] * s[2][0]) +
                            s[0][2] * (s[1][0] * s[2][1] - s[1][1] * s[2][0]);
    if (minors < 1e-16L * trace * trace) return 1;
    return det < 1e-16L * trace * minors ? 3 : 6;
}

static long double bound_of(const rigid_file *c)
{
    int64_t n = c->n_bonds;
    const int64_t *atoms = c->body_atoms;
    for (int64_t b = 0; b < c->n_bodies; atoms += c->sizes[b++]) n += body_constraints(c, atoms, c->sizes[b]);
    return 16 + sqrtl((long double)n);
}

/** lambda, G, accelerations of what has mass, and the virial. */
static long double check_forces(const rigid_file *c, const hol_chains *chains, outputs *o, long double k)
{
    worst of_lambda = {0, 0, 0}, of_g = {0, 0, 0}, of_a = {0, 0, 0}, of_virial = {0, 0, 0};
    const int status = hol_forces(chains, c->r, c->v, c->f, o->lambda, NULL, o->g, HOL_WRITE, o->virial);
    if (status != HOL_OK) return print_failure(c->name, "forces", status);
    for (int64_t a = 0; a < c->n_bonds; ++a) compare(&of_lambda, o->lambda[a], c->lambda[a], c->lambda_scale[a], k);
    for (int64_t i = 0; i < 3 * c->n_atoms; ++i) {
        compare(&of_g, o->g[i], c->g[i], c->g_scale[i / 3], k);
        if (c->mass[i / 3] > 0)
            compare(&of_a, (o->g[i] + c->f[i]) / c->mass[i / 3], c->acceleration[i], c->a_scale[i / 3], k);
    }
    for (int i = 0; i < 9; ++i) compare(&of_virial, o->virial[i], c->virial[i], c->virial_scale, k);
    if (c->n_bonds > 0) print_worst(c->name, "lambda", &of_lambda);
    print_worst(c->name, "G", &of_g);
    print_worst(c->name, "accelerations", &of_a);
    print_worst(c->name, "virial", &of_virial);
    return larger_ratio(larger_ratio(larger_ratio(larger_ratio(0, &of_lambda), &of_g), &of_a), &of_virial);
}

static long double check_velocities(const rigid_file *c, const hol_chains *chains, outputs *o, long double k)
{
    worst of_mu = {0, 0, 0}, of_v = {0, 0, 0};
    memcpy(o->v, c->v, sizeof(double) * 3 * (size_t)c->n_atoms);
    const int status = hol_project_velocities(chains, c->r, o->v, o->mu, NULL);
    if (status != HOL_OK) return print_failure(c->name, "velocities", status);
    for (int64_t a = 0; a < c->n_bonds; ++a) compare(&of_mu, o->mu[a], c->mu[a], c->mu_scale[a], k);
    for (int64_t i = 0; i < 3 * c->n_atoms; ++i)
        if (c->mass[i / 3] >= 0) compare(&of_v, o->v[i], c->velocity[i], c->v_scale[i / 3], k);
    if (c->n_bonds > 0) print_worst(c->name, "mu", &of_mu);
    print_worst(c->name, "projected v", &of_v);
    return larger_ratio(larger_ratio(0, &of_mu), &of_v);
}

static long double check_positions(const rigid_file *c, const hol_chains *chains, outputs *o, long double k)
{
    worst of_r = {0, 0, 0}, of_lambda = {0, 0, 0};
    memcpy(o->r, c->drifted, sizeof(double) * 3 * (size_t)c->n_atoms);
    const int status = hol_project_positions(chains, c->r, o->r, NULL, c->dt, o->position_lambda, 0, NULL, NULL);
    if (status != HOL_OK) return print_failure(c->name, "positions", status);
    for (int64_t a = 0; a < c->n_bonds; ++a)
        compare(&of_lambda, o->position_lambda[a], c->position_lambda[a], c->position_scale[a], k);
    for (int64_t i = 0; i < 3 * c->n_atoms; ++i) compare(&of_r, o->r[i], c->position[i], c->r_scale[i / 3], k);
    print_worst(c->name, "positions", &of_r);
    if (c->n_bonds > 0) print_worst(c->name, "lambda (r)", &of_lambda);
    return larger_ratio(larger_ratio(0, &of_r), &of_lambda);
}

static hol_chains *make_chains(const rigid_file *c, int *status)
{
    hol_chains *chains = NULL;
    double *mass = malloc(sizeof *mass * (size_t)c->n_atoms), *place = malloc(sizeof *place * 3 * (size_t)c->n_held);
    *status = HOL_ERR_MEMORY;
    if (mass && place) {
        for (int64_t i = 0; i < c->n_atoms; ++i) mass[i] = c->mass[i] < 0 ? (double)INFINITY : c->mass[i];
        for (int64_t a = 0; a < c->n_held; ++a)
            memcpy(place + 3 * a, c->place + 3 * c->body_atoms[a], 3 * sizeof *place);
        *status = hol_chains_create(c->n_atoms, mass, &chains);
    }
    if (*status == HOL_OK)
        *status =
            hol_chains_add_rigid(chains, c->n_bodies, c->sizes, c->body_atoms, place, c->n_bonds, c->pairs, c->length);
    free(mass);
    free(place);
    if (*status == HOL_OK) return chains;
    hol_chains_destroy(chains);
    return NULL;
}

long double check_rigid_case(const rigid_file *c)
{
    int status;
    outputs o;
    hol_chains *chains = make_chains(c, &status);
    if (!chains) return print_failure(c->name, "the library takes no such molecule", status);
    long double ratio = HUGE_VALL;
    if (make_outputs(c, &o) == 0) {
        const long double k = bound_of(c);
        ratio = check_forces(c, chains, &o, k);
        ratio = fmaxl(ratio, check_velocities(c, chains, &o, k));
        ratio = fmaxl(ratio, check_positions(c, chains, &o, k));
        free(o.memory);
    }
    hol_chains_destroy(chains);
    return ratio;
}
