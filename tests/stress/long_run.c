/**
 * Long runs of a small system: do the constraints drift?
 *     long_run STEPS
 * (1) NVE: 8 bead-rod chains of 8 beads with repulsive beads, RATTLE, dt = 0.004. Total energy, momentum, bond lengths.
 * (2) Langevin: a chain of 12 beads with unequal masses and one end held, in a harmonic trap, BAOAB with the
 * projections of the library, dt = 0.02. Bond lengths, d.v, and the mean kinetic energy, kT/2 for each degree of
 * freedom. Exit status 1 if a bond length is off by more than 1e-13 relative at the end of any step, or a mean is not
 * what it must be.
 */
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "melt.h"
#include "random.h"

static int failures;

static void require(int right, const char *what)
{
    if (right) return;
    printf("FAILED: %s\n", what);
    ++failures;
}

static void must(int status)
{
    if (status == HOL_OK) return;
    printf("FAILED: %s: %s\n", hol_status_name(status), hol_error_message());
    exit(1);
}

static double momentum(const melt *m)
{
    double p[3] = {0, 0, 0}, largest = 0;
    for (int64_t i = 0; i < 3 * m->n_atoms; ++i) p[i % 3] += m->v[i];
    for (int x = 0; x < 3; ++x) largest = fmax(largest, fabs(p[x]));
    return largest;
}

static void nve(long steps)
{
    const double dt = 0.004;
    melt m = melt_make(8, 8, 0.4, 3);
    for (int i = 0; i < 2000; ++i) { /* away from the lattice */
        melt_step(&m, dt);
        if (i % 20 == 0) melt_rescale(&m);
    }
    m.worst_length = 0;
    const double start = m.potential + melt_kinetic(&m), p0 = momentum(&m);
    /* the drift is the slope of a straight line through the energies */
    double t1 = 0, e1 = 0, t2 = 0, te = 0, largest = 0;
    for (long s = 1; s <= steps; ++s) {
        melt_step(&m, dt);
        const double e = m.potential + melt_kinetic(&m) - start, t = (double)s * dt;
        t1 += t, e1 += e, t2 += t * t, te += t * e;
        largest = fmax(largest, fabs(e));
    }
    const double n = (double)steps, slope = (n * te - t1 * e1) / (n * t2 - t1 * t1) / (double)m.n_atoms;
    printf(
        "NVE, %ld steps: energy off by at most %.2e kT per bead, drift %.2e kT per bead and unit of time,\n"
        "    bond error at most %.2e, momentum changed by %.2e, %.2f iterations a step\n",
        steps, largest / (double)m.n_atoms, slope, m.worst_length, fabs(momentum(&m) - p0),
        (double)m.iterations / (double)m.steps);
    require(m.worst_length < 1e-13, "a bond length has drifted");
    /* each step rounds 192 momenta of about one, at random */
    require(fabs(momentum(&m) - p0) < 100 * DBL_EPSILON * sqrt(192.0 * n), "the momentum has drifted");
    require(largest / (double)m.n_atoms < 2e-2, "the energy is not kept");
    /* what fluctuates looks like a drift of less and less in longer runs */
    require(fabs(slope) < 1e-6 * fmax(1, pow(1e6 / n, 1.5)), "the energy drifts");
    melt_free(&m);
}

enum { BEADS = 12, SIZE = 3 * BEADS };

/** Half a step of drift on the constraints, velocities included. */
static void drift(const hol_chains *chains, double *r, double *v, double dt, double *lambda)
{
    double before[SIZE];
    memcpy(before, r, sizeof before);
    for (int i = 0; i < SIZE; ++i) r[i] += dt * v[i];
    must(hol_project_positions(chains, before, r, v, dt, lambda, 0, NULL, NULL));
    must(hol_project_velocities(chains, r, v, NULL, NULL));
}

static void langevin(long steps)
{
    const double dt = 0.02, friction = 1, decay = exp(-friction * dt), kick = sqrt(1 - decay * decay);
    double mass[BEADS], length[BEADS - 1], r[SIZE], v[SIZE], lambda[BEADS - 1];
    hol_chains *chains = NULL;
    random_stream stream = random_seed(11);
    for (int i = 0; i < BEADS; ++i) {
        mass[i] = i == 0 ? 0 : i % 3 == 0 ? 5 : 1;
        if (i < BEADS - 1) length[i] = 1 + 0.25 * (i % 2);
        double u[3];
        random_direction(&stream, u);
        for (int x = 0; x < 3; ++x) {
            r[3 * i + x] = i == 0 ? 0 : r[3 * i - 3 + x] + length[i - 1] * u[x];
            v[3 * i + x] = i == 0 ? 0 : random_normal(&stream) / sqrt(mass[i]);
        }
    }
    must(hol_chains_create(BEADS, mass, &chains));
    must(hol_chains_add_block(chains, 1, BEADS - 1, 0, length));
    must(hol_project_velocities(chains, r, v, NULL, NULL));
    double kinetic = 0, worst_length = 0, worst_rate = 0;
    for (long s = 0; s < steps; ++s) {
        for (int half = 0; half < 2; ++half) {
            for (int i = 3; i < SIZE; ++i) v[i] -= dt / 2 * 0.3 * r[i] / mass[i / 3]; /* B */
            must(hol_project_velocities(chains, r, v, NULL, NULL));
            if (half == 1) break;
            drift(chains, r, v, dt / 2, lambda); /* A */
            for (int i = 3; i < SIZE; ++i)
                v[i] = decay * v[i] + kick * random_normal(&stream) / sqrt(mass[i / 3]); /* O */
            must(hol_project_velocities(chains, r, v, NULL, NULL));
            drift(chains, r, v, dt / 2, lambda); /* A */
        }
        hol_worst worst;
        must(hol_violation(chains, r, v, &worst));
        worst_length = fmax(worst_length, worst.length);
        worst_rate = fmax(worst_rate, worst.rate);
        for (int i = 3; i < SIZE; ++i) kinetic += mass[i / 3] * v[i] * v[i];
    }
    const double per_freedom = kinetic / (double)steps / (double)hol_chains_degrees_of_freedom(chains, 3);
    printf(
        "Langevin, %ld steps: bond error at most %.2e, d.v at most %.2e, kinetic energy %.4f of kT/2 per degree of "
        "freedom\n",
        steps, worst_length, worst_rate, per_freedom);
    require(worst_length < 1e-13, "a bond length has drifted");
    require(worst_rate < 1e-13, "velocities along bonds are left");
    /* 22 degrees of freedom, correlated over 1/(2 friction) = 25 steps: four standard errors, and the error of the step
     */
    const double samples = (double)steps / 50 * (double)hol_chains_degrees_of_freedom(chains, 3);
    require(fabs(per_freedom - 1) < 4 * sqrt(2 / samples) + 5e-3, "the temperature is wrong");
    hol_chains_destroy(chains);
}

int main(int argc, char **argv)
{
    const long steps = argc == 2 ? atol(argv[1]) : 0;
    if (steps < 1) {
        fprintf(stderr, "usage: long_run STEPS\n");
        return 2;
    }
    nve(steps);
    langevin(steps);
    return failures != 0;
}
