#include "nve.h"

#include "check.h"

static void find_forces(nve *s)
{
    for (int64_t i = 0; i < 3 * s->n_atoms; ++i) s->f[i] = 0;
    s->potential = s->forces(s->of_what, s->n_atoms, s->r, s->f);
}

nve nve_make(const hol_chains *chains, int64_t n_atoms, const double *mass, const int64_t *pairs, const double *length,
             const double *r, const double *v, field forces, const void *of_what)
{
    const size_t size = 3 * (size_t)n_atoms;
    nve s = {chains, n_atoms, hol_chains_n_bonds(chains), mass, length, pairs, forces, of_what, 0, 0, 0, 0, 0, 0};
    s.r = copy_of(r, size);
    s.v = copy_of(v, size);
    s.f = copy_of(r, size);
    s.before = copy_of(r, size);
    CHECK(hol_project_velocities(chains, s.r, s.v, NULL, NULL));
    find_forces(&s);
    return s;
}

static void kick(nve *s, double dt)
{
    for (int64_t i = 0; i < 3 * s->n_atoms; ++i) s->v[i] += dt / s->mass[i / 3] * s->f[i];
}

/** Bond lengths as they are, against the rounding of the coordinates. */
static void check_lengths(nve *s)
{
    double extent = 0, shortest = HUGE_VAL;
    for (int64_t i = 0; i < 3 * s->n_atoms; ++i) extent = fmax(extent, fabs(s->r[i]));
    for (int64_t k = 0; k < s->n_bonds; ++k) shortest = fmin(shortest, s->length[k]);
    for (int64_t k = 0; k < s->n_bonds; ++k) {
        const double square = s->length[k] * s->length[k];
        long double error = -(long double)s->length[k] * s->length[k];
        for (int x = 0; x < 3; ++x) {
            const long double d = (long double)s->r[3 * s->pairs[2 * k + 1] + x] - s->r[3 * s->pairs[2 * k] + x];
            error += d * d;
        }
        const double of_rounding = fabs((double)error) / square / (DBL_EPSILON * (1 + extent / shortest));
        s->worst_length = fmax(s->worst_length, of_rounding);
    }
}

void nve_step(nve *s, double dt)
{
    const size_t size = 3 * (size_t)s->n_atoms;
    kick(s, dt / 2);
    memcpy(s->before, s->r, size * sizeof(double));
    for (size_t i = 0; i < size; ++i) s->r[i] += dt * s->v[i];
    CHECK(hol_project_positions(s->chains, s->before, s->r, s->v, dt, NULL, 0, NULL, NULL));
    check_lengths(s);
    find_forces(s);
    kick(s, dt / 2);
    CHECK(hol_project_velocities(s->chains, s->r, s->v, NULL, NULL));
}

double nve_kinetic(const nve *s)
{
    double sum = 0;
    for (int64_t i = 0; i < 3 * s->n_atoms; ++i) sum += s->mass[i / 3] * s->v[i] * s->v[i] / 2;
    return sum;
}

energy_record nve_run(nve *s, double dt, int steps)
{
    const int tenth = steps / 10;
    const double start = s->potential + nve_kinetic(s);
    energy_record e = {0, 0, 0};
    for (int n = 0; n < steps; ++n) {
        nve_step(s, dt);
        const double energy = s->potential + nve_kinetic(s);
        if (n < tenth) e.first += energy / tenth;
        if (n >= steps - tenth) e.last += energy / tenth;
        e.spread = fmax(e.spread, fabs(energy - start));
    }
    return e;
}

void nve_free(nve *s)
{
    free(s->r), free(s->v), free(s->f), free(s->before);
}
