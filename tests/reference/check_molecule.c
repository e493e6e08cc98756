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
    size_t size; /* in numbers */
    double *lambda, *mu, *position_lambda;
    double *g, *fixman, *v, *r, *moved;
    double *log_det, *log_det_z; /* of each molecule that the library finds */
    double virial[9], energy;
} outputs;

static const uint64_t pattern = UINT64_C(0x7ff4dead0000beef); /* no calculation gives this NaN */

static int make_outputs(const molecule_file *c, outputs *o)
{
    const size_t n = (size_t)c->n_bonds, atoms = (size_t)c->n_atoms;
    o->size = 5 * n + 15 * atoms;
    o->memory = malloc(sizeof(double) * o->size);
    if (!o->memory) return -1;
    for (size_t i = 0; i < o->size; ++i) memcpy(o->memory + i, &pattern, sizeof pattern);
    for (int i = 0; i < 9; ++i) memcpy(o->virial + i, &pattern, sizeof pattern);
    memcpy(&o->energy, &pattern, sizeof pattern);
    double **const per_bond[] = {&o->lambda, &o->mu, &o->position_lambda, &o->log_det, &o->log_det_z};
    double **const per_atom[] = {&o->g, &o->fixman, &o->v, &o->r, &o->moved};
    for (size_t i = 0; i < 5; ++i) *per_bond[i] = o->memory + i * n;
    for (size_t i = 0; i < 5; ++i) *per_atom[i] = o->memory + 5 * n + 3 * i * atoms;
    return 0;
}

static int is_untouched(const double *a, size_t n)
{
    for (size_t i = 0; i < n; ++i)
        if (memcmp(a + i, &pattern, sizeof pattern) != 0) return 0;
    return 1;
}

static long double bound_of(const molecule_file *c)
{
    return 16 + sqrtl((long double)c->n_bonds);
}

/** lambda, G and virial. */
static long double check_forces(const molecule_file *c, const hol_chains *chains, outputs *o)
{
    const long double k = bound_of(c);
    worst of_lambda = {0, 0, 0}, of_g = {0, 0, 0}, of_virial = {0, 0, 0};
    const int status = hol_forces(chains, c->r, c->v, c->f, o->lambda, NULL, o->g, HOL_WRITE, o->virial);
    if (status != HOL_OK) return print_failure(c->name, "forces", status);
    for (int64_t a = 0; a < c->n_bonds; ++a) compare(&of_lambda, o->lambda[a], c->lambda[a], c->lambda_scale[a], k);
    for (int64_t i = 0; i < 3 * c->n_atoms; ++i) compare(&of_g, o->g[i], c->g[i], c->g_scale[i / 3], k);
    for (int i = 0; i < 9; ++i) compare(&of_virial, o->virial[i], c->virial[i], c->virial_scale, k);
    print_worst(c->name, "lambda", &of_lambda);
    print_worst(c->name, "G", &of_g);
    print_worst(c->name, "virial", &of_virial);
    return larger_ratio(larger_ratio(larger_ratio(0, &of_lambda), &of_g), &of_virial);
}

/** mu and the projected velocities. */
static long double check_velocities(const molecule_file *c, const hol_chains *chains, outputs *o)
{
    const long double k = bound_of(c);
    worst of_mu = {0, 0, 0}, of_v = {0, 0, 0};
    memcpy(o->v, c->v, sizeof(double) * 3 * (size_t)c->n_atoms);
    const int status = hol_project_velocities(chains, c->r, o->v, o->mu, NULL);
    if (status != HOL_OK) return print_failure(c->name, "velocities", status);
    for (int64_t a = 0; a < c->n_bonds; ++a) compare(&of_mu, o->mu[a], c->mu[a], c->mu_scale[a], k);
    for (int64_t i = 0; i < 3 * c->n_atoms; ++i) compare(&of_v, o->v[i], c->velocity[i], c->v_scale[i / 3], k);
    print_worst(c->name, "mu", &of_mu);
    print_worst(c->name, "projected v", &of_v);
    return larger_ratio(larger_ratio(0, &of_mu), &of_v);
}

/** Bonds left, in units of eps (1 + X / a_min), beside 8. */
static void check_lengths(const molecule_file *c, const double *r, worst *w)
{
    long double extent = 0, shortest = HUGE_VALL;
    for (int64_t i = 0; i < 3 * c->n_atoms; ++i) extent = fmaxl(extent, fabsl(c->position[i]));
    for (int64_t k = 0; k < c->n_bonds; ++k) shortest = fminl(shortest, c->length[k]);
    for (int64_t k = 0; k < c->n_bonds; ++k) {
        const int64_t i = c->pairs[2 * k], j = c->pairs[2 * k + 1];
        if (c->w[i] == 0 && c->w[j] == 0) continue;
        long double error = -(long double)c->length[k] * c->length[k];
        for (int x = 0; x < 3; ++x) {
            const long double d = (long double)r[3 * j + x] - r[3 * i + x];
            error += d * d;
        }
        error /= (long double)c->length[k] * c->length[k];
        note(w, fabsl(error) / (DBL_EPSILON * (1 + extent / shortest)), 8);
    }
}

/** Positions, their multipliers and the lengths that are left. */
static long double check_positions(const molecule_file *c, const hol_chains *chains, outputs *o)
{
    const long double k = bound_of(c);
    worst of_r = {0, 0, 0}, of_lambda = {0, 0, 0}, of_length = {0, 0, 0};
    if (!c->has_positions) return 0;
    memcpy(o->r, c->drifted, sizeof(double) * 3 * (size_t)c->n_atoms);
    const int status = hol_project_positions(chains, c->r, o->r, NULL, c->dt, o->position_lambda, 0, NULL, NULL);
    if (status != HOL_OK) return print_failure(c->name, "positions", status);
    for (int64_t a = 0; a < c->n_bonds; ++a)
        compare(&of_lambda, o->position_lambda[a], c->position_lambda[a], c->position_scale[a], k);
    for (int64_t i = 0; i < 3 * c->n_atoms; ++i) compare(&of_r, o->r[i], c->position[i], c->r_scale[i / 3], k);
    check_lengths(c, o->r, &of_length);
    print_worst(c->name, "positions", &of_r);
    print_worst(c->name, "lambda (r)", &of_lambda);
    print_worst(c->name, "bonds left", &of_length);
    return larger_ratio(larger_ratio(larger_ratio(0, &of_r), &of_lambda), &of_length);
}

/** ln det Z~, ln det Z, the Fixman potential at kT = 1 and its force. */
static long double check_metric(const molecule_file *c, const hol_chains *chains, outputs *o)
{
    const long double k = bound_of(c);
    worst of_det = {0, 0, 0}, of_det_z = {0, 0, 0}, of_energy = {0, 0, 0}, of_force = {0, 0, 0};
    const int status = hol_metric(chains, c->r, 1, o->log_det, o->log_det_z, &o->energy, o->fixman, HOL_WRITE);
    if (status != HOL_OK) return print_failure(c->name, "metric", status);
    long double det = 0, det_z = 0, z_scale = fabsl(c->lndet);
    for (int64_t m = 0; m < hol_chains_n_molecules(chains); ++m) {
        det += o->log_det[m];
        det_z += o->log_det_z[m];
    }
    for (int64_t a = 0; a < c->n_bonds; ++a) {
        const int64_t i = c->pairs[2 * a], j = c->pairs[2 * a + 1];
        const long double masses = (long double)c->w[i] + c->w[j];
        if (masses > 0) z_scale += fabsl(logl(4 * masses * c->length[a] * c->length[a]));
    }
    compare(&of_det, (double)det, c->lndet, fabsl(c->lndet), k);
    compare(&of_det_z, (double)det_z, c->lndetz, z_scale, k);
    compare(&of_energy, o->energy, c->fixman_energy, fabsl(c->fixman_energy), k);
    for (int64_t i = 0; i < 3 * c->n_atoms; ++i)
        compare(&of_force, o->fixman[i], c->fixman_force[i], c->fixman_scale[i / 3], 2 * k);
    print_worst(c->name, "lndet", &of_det);
    print_worst(c->name, "lndetz", &of_det_z);
    print_worst(c->name, "fixman_energy", &of_energy);
    print_worst(c->name, "Fixman force", &of_force);
    return larger_ratio(larger_ratio(larger_ratio(larger_ratio(0, &of_det), &of_det_z), &of_energy), &of_force);
}

/** Every level says that the molecule is degenerate and leaves all outputs as they were. */
static long double check_refused(const molecule_file *c, const hol_chains *chains, outputs *o)
{
    const double dt = 1e-3;
    const size_t size = sizeof(double) * 3 * (size_t)c->n_atoms;
    int status = hol_forces(chains, c->r, c->v, c->f, o->lambda, NULL, o->g, HOL_WRITE, o->virial);
    if (status != HOL_ERR_DEGENERATE) return print_failure(c->name, "forces should be refused", status);
    status = hol_metric(chains, c->r, 1, o->log_det, o->log_det_z, &o->energy, o->fixman, HOL_WRITE);
    if (status != HOL_ERR_DEGENERATE) return print_failure(c->name, "metric should be refused", status);
    const int untouched = is_untouched(o->memory, o->size) && is_untouched(o->virial, 9) && is_untouched(&o->energy, 1);
    memcpy(o->v, c->v, size);
    status = hol_project_velocities(chains, c->r, o->v, o->mu, NULL);
    if (status != HOL_ERR_DEGENERATE) return print_failure(c->name, "velocities should be refused", status);
    for (int64_t i = 0; i < 3 * c->n_atoms; ++i) /* somewhere near, whatever the velocities */
        o->r[i] = c->drifted[i] = c->r[i] + (c->w[i / 3] > 0 ? 1e-3 * c->length[0] * sin((double)(i * i + 1)) : 0);
    status = hol_project_positions(chains, c->r, o->r, NULL, dt, o->position_lambda, 0, NULL, NULL);
    if (status != HOL_ERR_DEGENERATE && status != HOL_ERR_NO_CONVERGENCE)
        return print_failure(c->name, "positions should be refused", status);
    const int kept = memcmp(o->v, c->v, size) == 0 && memcmp(o->r, c->drifted, size) == 0 &&
                     is_untouched(o->mu, (size_t)c->n_bonds) && is_untouched(o->position_lambda, (size_t)c->n_bonds);
    printf("%-36s %s\n", c->name, untouched && kept ? "refused, outputs untouched" : "OUTPUTS TOUCHED");
    return untouched && kept ? 0 : HUGE_VALL;
}

/** Distances that depend on each other, taken as a rigid body: its forces are no forces from outside, and the
 * accelerations and velocities keep every distance, up to the rounding of what they are sums of. */
static long double check_body(const molecule_file *c, const hol_chains *chains, outputs *o)
{
    const size_t size = sizeof(double) * 3 * (size_t)c->n_atoms;
    const long double enough = 1e3L * DBL_EPSILON;
    long double sum[6] = {0}, scale = 0, largest = 0;
    memcpy(o->v, c->v, size);
    int status = hol_project_velocities(chains, c->r, o->v, o->mu, NULL);
    if (status != HOL_OK) return print_failure(c->name, "velocities of a body", status);
    status = hol_forces(chains, c->r, o->v, c->f, o->lambda, NULL, o->g, HOL_WRITE, o->virial);
    if (status != HOL_OK) return print_failure(c->name, "forces of a body", status);
    for (int64_t i = 0; i < c->n_atoms; ++i)
        for (int x = 0; x < 3; ++x) {
            const int y = (x + 1) % 3, z = (x + 2) % 3;
            const double *const r = c->r + 3 * i, *const g = o->g + 3 * i;
            sum[x] += g[x];
            sum[3 + x] += (long double)r[y] * g[z] - (long double)r[z] * g[y];
            scale += fabsl(g[x]) * (1 + fabsl(r[y]) + fabsl(r[z]));
        }
    for (int x = 0; x < 6; ++x) largest = fmaxl(largest, fabsl(sum[x]) / (enough * scale));
    for (int64_t k = 0; k < c->n_bonds; ++k) {
        const int64_t i = c->pairs[2 * k], j = c->pairs[2 * k + 1];
        long double second = 0, first = 0, size_second = 0, size_first = 0;
        for (int x = 0; x < 3; ++x) {
            const long double d = (long double)c->r[3 * j + x] - c->r[3 * i + x],
                              u = (long double)o->v[3 * j + x] - o->v[3 * i + x],
                              a = c->w[j] * ((long double)c->f[3 * j + x] + o->g[3 * j + x]),
                              b = c->w[i] * ((long double)c->f[3 * i + x] + o->g[3 * i + x]);
            second += d * (a - b) + u * u;
            first += d * u;
            size_second += fabsl(d) * (fabsl(a) + fabsl(b)) + u * u;
            size_first += fabsl(d) * (fabsl(o->v[3 * j + x]) + fabsl(o->v[3 * i + x]));
        }
        largest = fmaxl(largest, fmaxl(fabsl(second) / (enough * size_second), fabsl(first) / (enough * size_first)));
    }
    printf("%-36s a rigid body    %9.3Lg of 1  %s\n", c->name, largest, largest <= 1 ? "ok" : "TOO LARGE");
    return largest;
}

/** A handle with the molecule, or NULL with the status of what failed. */
static hol_chains *make_chains(const molecule_file *c, int *status)
{
    hol_chains *chains = NULL;
    double *mass = malloc(sizeof *mass * (size_t)c->n_atoms);
    *status = HOL_ERR_MEMORY;
    if (mass) {
        for (int64_t i = 0; i < c->n_atoms; ++i) mass[i] = c->w[i] == 0 ? 0 : c->mass[i];
        *status = hol_chains_create(c->n_atoms, mass, &chains);
    }
    if (*status == HOL_OK) *status = hol_chains_add_bonds(chains, c->n_bonds, c->pairs, c->length);
    free(mass);
    if (*status == HOL_OK) return chains;
    hol_chains_destroy(chains);
    return NULL;
}

long double check_molecule_case(const molecule_file *c)
{
    int status;
    outputs o;
    hol_chains *chains = make_chains(c, &status);
    if (!chains && c->degenerate && status == HOL_ERR_DEGENERATE) {
        printf("%-36s refused when added: %s\n", c->name, hol_error_message());
        return 0;
    }
    if (!chains) return print_failure(c->name, "the library takes no such molecule", status);
    long double ratio = HUGE_VALL;
    if (make_outputs(c, &o) == 0) {
        if (c->degenerate && hol_chains_n_of_shape(chains, HOL_SHAPE_RIGID) > 0) {
            ratio = check_body(c, chains, &o);
        } else if (c->degenerate) {
            ratio = check_refused(c, chains, &o);
        } else {
            ratio = check_forces(c, chains, &o);
            ratio = fmaxl(ratio, check_velocities(c, chains, &o));
            ratio = fmaxl(ratio, check_positions(c, chains, &o));
            ratio = fmaxl(ratio, check_metric(c, chains, &o));
        }
        ratio = fmaxl(ratio, check_fit(c->name, chains, c->n_atoms, c->n_bonds, c->pairs, c->length, c->r));
        free(o.memory);
    }
    hol_chains_destroy(chains);
    return ratio;
}
