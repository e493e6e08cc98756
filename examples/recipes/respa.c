/**
 * r-RESPA with two force groups: stiff springs that tether atoms, in every step, and a slow field, in every fourth one.
 * Each group's kick is that of its forces and of the constraint forces that belong to them, so where both act there are
 * two right-hand sides at one configuration. With factors that are kept the matrix is eliminated once for the two.
 * The gain is small: an update costs about one hol_forces and each of the four solves of such a step about two thirds
 * of one, 3.7 in place of 4, and the three steps between have one group alone. Many right-hand sides gain more.
 */
#include <string.h>
#include <time.h>

#include "../sampling/noise.h"
#include "recipe.h"

enum { CHAINS = 400, BONDS = 20, PER_CHAIN = BONDS + 1, ATOMS = CHAINS * PER_CHAIN, INNER = 4, OUTER = 50 };

static const double dt = 0.005, stiffness = 40, strength = 0.5;

typedef struct state {
    double r[3 * ATOMS], v[3 * ATOMS];
} state;

static double tether[3 * ATOMS], seconds;

static double fast_forces(const double *r, double *f)
{
    double energy = 0;
    for (long e = 0; e < 3 * ATOMS; ++e) {
        const double x = r[e] - tether[e];
        f[e] = -stiffness * x;
        energy += 0.5 * stiffness * x * x;
    }
    return energy;
}

static double slow_forces(const double *r, double *f)
{
    double energy = 0;
    for (long e = 0; e < 3 * ATOMS; ++e) {
        f[e] = strength * sin(r[e]);
        energy += strength * cos(r[e]);
    }
    return energy;
}

static double now(void)
{
    struct timespec t;
    timespec_get(&t, TIME_UTC);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* f + G of a group, in f. The term of velocities belongs to the fast one. */
static void constrain(const hol_chains *chains, const hol_factors *factors, const state *s, int fast, double *f)
{
    const double *const v = fast ? s->v : NULL, start = now();
    if (factors)
        ok(hol_factors_forces(factors, v, f, NULL, NULL, f, HOL_ADD, NULL));
    else
        ok(hol_forces(chains, s->r, v, f, NULL, NULL, f, HOL_ADD, NULL));
    seconds += now() - start;
}

static void kick(state *s, const double *f, double time)
{
    for (long e = 0; e < 3 * ATOMS; ++e) s->v[e] += time * f[e];
}

/* Returns the largest change of the total energy; `keep` says how the constraint forces are found. */
static double run(const hol_chains *chains, state *s, int keep, double *energy)
{
    static double fast[3 * ATOMS], slow[3 * ATOMS], before[3 * ATOMS];
    double first = 0, drift = 0;
    hol_factors *factors = NULL;
    if (keep) ok(hol_factors_create(chains, &factors));
    seconds = 0;
    for (int step = 0; step <= OUTER * INNER; ++step) {
        const int both = step % INNER == 0;
        const hol_factors *const kept = both ? factors : NULL; /* where one group acts hol_forces is as good */
        double potential = fast_forces(s->r, fast);
        if (kept) {
            const double start = now();
            ok(hol_factors_update(factors, s->r));
            seconds += now() - start;
        }
        if (step > 0) {
            constrain(chains, kept, s, 1, fast);
            kick(s, fast, dt / 2);
            if (both) {
                slow_forces(s->r, slow);
                constrain(chains, kept, s, 0, slow);
                kick(s, slow, INNER * dt / 2);
            }
            ok(hol_project_velocities(chains, s->r, s->v, NULL, NULL));
        }
        if (both) {
            potential += slow_forces(s->r, slow);
            *energy = potential;
            for (long e = 0; e < 3 * ATOMS; ++e) *energy += 0.5 * s->v[e] * s->v[e];
            if (step == 0) first = *energy;
            drift = fmax(drift, fabs(*energy - first));
            constrain(chains, kept, s, 0, slow);
            kick(s, slow, INNER * dt / 2);
        }
        fast_forces(s->r, fast);
        constrain(chains, kept, s, 1, fast);
        kick(s, fast, dt / 2);
        memcpy(before, s->r, sizeof before);
        for (long e = 0; e < 3 * ATOMS; ++e) s->r[e] += dt * s->v[e];
        ok(hol_project_positions(chains, before, s->r, s->v, dt, NULL, 0, NULL, NULL));
    }
    hol_factors_destroy(factors);
    return drift;
}

int main(void)
{
    static state start, one, two;
    static double mass[ATOMS], length[BONDS];
    double energy[2], drift[2], time[2];
    noise random = noise_start(7);
    hol_chains *chains = NULL;
    for (long i = 0; i < ATOMS; ++i) {
        double d[3];
        mass[i] = 1;
        noise_direction(&random, d);
        for (int c = 0; c < 3; ++c) {
            start.r[3 * i + c] = i % PER_CHAIN == 0 ? 50 * noise_uniform(&random) : start.r[3 * i - 3 + c] + d[c];
            start.v[3 * i + c] = noise_uniform(&random) - 0.5;
        }
    }
    for (int k = 0; k < BONDS; ++k) length[k] = 1;
    memcpy(tether, start.r, sizeof tether);
    ok(hol_chains_create(ATOMS, mass, &chains));
    ok(hol_chains_add_block(chains, CHAINS, BONDS, 0, length));
    ok(hol_project_velocities(chains, start.r, start.v, NULL, NULL));
    one = two = start;
    drift[0] = run(chains, &one, 0, energy);
    time[0] = seconds;
    drift[1] = run(chains, &two, 1, energy + 1);
    time[1] = seconds;
    printf("two calls of hol_forces  energy %.10f, drift %.2g, %.1f ms for the constraint forces\n", energy[0],
           drift[0], 1e3 * time[0]);
    printf("factors that are kept    energy %.10f, drift %.2g, %.1f ms\n", energy[1], drift[1], 1e3 * time[1]);
    hol_chains_destroy(chains);
    /* Roundings grow a little with time; the drift of the integrator is the same. */
    agrees("energy with kept factors", energy[1], energy[0], 1e-9 * fabs(energy[0]));
    agrees("its drift", drift[1], 0, 1e-3 * fabs(energy[0]));
    return 0;
}
