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
    nve s = {chains, n_atoms, hol_chains_n_bonds(chains), mass, length, pairs, forces, of_what, 0, 0, 0, 0, 0, 0, 0};
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

static double difference(const nve *s, const double *of, int64_t bond, double *d)
{
    const int64_t *const end = s->pairs + 2 * bond;
    for (int x = 0; x < 3; ++x) d[x] = of[3 * end[1] + x] - of[3 * end[0] + x];
    return d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
}

/** Moves the ends of a bond apart by `factor` d, shared out by inverse masses. */
static void push_apart(const nve *s, double *what, int64_t bond, double factor, const double *d)
{
    for (int e = 0; e < 2; ++e) {
        const int64_t i = s->pairs[2 * bond + e];
        for (int x = 0; x < 3; ++x) what[3 * i + x] += (e == 0 ? -factor : factor) / s->mass[i] * d[x];
    }
}

/** SHAKE (Ryckaert, Ciccotti and Berendsen 1977): bond after bond, until all are within the tolerance. */
static void shake(nve *s, double dt)
{
    int64_t left = 1;
    for (int sweep = 0; left > 0; ++sweep) {
        assert_true(sweep < 100000);
        left = 0;
        for (int64_t k = 0; k < s->n_bonds; ++k) {
            double d[3], old[3], along = 0;
            const double square = s->length[k] * s->length[k], off = square - difference(s, s->r, k, d);
            if (fabs(off) <= s->sweeps * square) continue;
            ++left;
            difference(s, s->before, k, old);
            for (int x = 0; x < 3; ++x) along += d[x] * old[x];
            const double w = 1 / s->mass[s->pairs[2 * k]] + 1 / s->mass[s->pairs[2 * k + 1]];
            const double factor = off / (2 * w * along);
            push_apart(s, s->r, k, factor, old);
            push_apart(s, s->v, k, factor / dt, old);
        }
    }
}

/** The velocity half of RATTLE (Andersen 1983). */
static void rattle(nve *s, double dt)
{
    int64_t left = 1;
    for (int sweep = 0; left > 0; ++sweep) {
        assert_true(sweep < 100000);
        left = 0;
        for (int64_t k = 0; k < s->n_bonds; ++k) {
            double d[3], u[3], rate = 0;
            const double square = difference(s, s->r, k, d);
            difference(s, s->v, k, u);
            for (int x = 0; x < 3; ++x) rate += d[x] * u[x];
            if (fabs(rate) * dt <= s->sweeps * square) continue;
            ++left;
            const double w = 1 / s->mass[s->pairs[2 * k]] + 1 / s->mass[s->pairs[2 * k + 1]];
            push_apart(s, s->v, k, -rate / (w * square), d);
        }
    }
}

void nve_step(nve *s, double dt)
{
    const size_t size = 3 * (size_t)s->n_atoms;
    kick(s, dt / 2);
    memcpy(s->before, s->r, size * sizeof(double));
    for (size_t i = 0; i < size; ++i) s->r[i] += dt * s->v[i];
    if (s->sweeps > 0)
        shake(s, dt);
    else
        CHECK(hol_project_positions(s->chains, s->before, s->r, s->v, dt, NULL, 0, NULL, NULL));
    check_lengths(s);
    find_forces(s);
    kick(s, dt / 2);
    if (s->sweeps > 0)
        rattle(s, dt);
    else
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

nve nve_with_sweeps(const nve *s, double tolerance)
{
    const size_t size = 3 * (size_t)s->n_atoms;
    nve other = *s;
    other.r = copy_of(s->r, size);
    other.v = copy_of(s->v, size);
    other.f = copy_of(s->f, size);
    other.before = copy_of(s->before, size);
    other.sweeps = tolerance;
    other.worst_length = 0;
    return other;
}

void nve_free(nve *s)
{
    free(s->r), free(s->v), free(s->f), free(s->before);
}
