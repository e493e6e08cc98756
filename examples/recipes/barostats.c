/**
 * Constant pressure with rigid molecules. An ideal gas of rigid water in a box, whose volume theory knows: with the
 * pressure P_0 the mean volume is N kT / P_0 by a weak-coupling (Berendsen) barostat, which holds the pressure and not
 * the ensemble; and (N + 1) kT / P_0 with a standard deviation of sqrt(N + 1) kT / P_0 by stochastic cell rescaling
 * (Bernetti and Bussi 2020), which is exact.
 *
 * One step: drift of the centres; new thermal velocities; pressure of all atoms, the rigid bonds' virial included; the
 * cell and all atoms are scaled, and the projection gives the bonds their lengths back.
 */
#include <string.h>

#include "../sampling/noise.h"
#include "recipe.h"

enum { WATERS = 64, ATOMS = 3 * WATERS };

typedef struct gas {
    hol_chains *chains;
    double mass[ATOMS], r[3 * ATOMS], v[3 * ATOMS], before[3 * ATOMS], side;
    noise random;
} gas;

static const double kT = 1, P_0 = 0.01, dt = 0.1;

static void set_box(hol_chains *chains, double side, int (*set)(hol_chains *, const double *))
{
    const double box[9] = {side, 0, 0, 0, side, 0, 0, 0, side};
    ok(set(chains, box));
}

static void begin(gas *g)
{
    const int64_t bonds[6] = {0, 1, 0, 2, 1, 2};
    const double lengths[3] = {1, 1, sqrt(2)}, shape[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    g->random = noise_start(4);
    g->side = cbrt(WATERS * kT / P_0);
    for (long i = 0; i < ATOMS; ++i) g->mass[i] = i % 3 ? 1 : 16;
    for (long m = 0; m < WATERS; ++m)
        for (int c = 0; c < 3; ++c) {
            const double centre = g->side * noise_uniform(&g->random);
            for (int i = 0; i < 3; ++i) g->r[9 * m + 3 * i + c] = centre + shape[3 * i + c];
        }
    ok(hol_chains_create(ATOMS, g->mass, &g->chains));
    ok(hol_chains_add_molecules(g->chains, WATERS, 3, 0, 3, bonds, lengths));
    set_box(g->chains, g->side, hol_chains_set_box);
}

/* Velocities of the Maxwell distribution, a drift, and the pressure. `constrained` = 0 forgets the bonds' virial. */
static double move(gas *g, int constrained)
{
    double virial[9], kinetic = 0;
    for (long i = 0; i < 3 * ATOMS; ++i) g->v[i] = sqrt(kT / g->mass[i / 3]) * noise_normal(&g->random);
    ok(hol_project_velocities(g->chains, g->r, g->v, NULL, NULL));
    memcpy(g->before, g->r, sizeof g->r);
    for (long i = 0; i < 3 * ATOMS; ++i) g->r[i] += dt * g->v[i];
    ok(hol_project_positions(g->chains, g->before, g->r, g->v, dt, NULL, 0, NULL, NULL));
    ok(hol_project_velocities(g->chains, g->r, g->v, NULL, NULL));
    ok(hol_forces(g->chains, g->r, g->v, NULL, NULL, NULL, NULL, HOL_WRITE, virial));
    for (long i = 0; i < 3 * ATOMS; ++i) kinetic += g->mass[i / 3] * g->v[i] * g->v[i]; /* twice K */
    const double W = virial[0] + virial[4] + virial[8];
    return (kinetic + constrained * W) / (3 * g->side * g->side * g->side);
}

/* Scales the cell by `by` and all atoms with it. The reference belongs to the old cell, r to the new one. */
static void scale(gas *g, double by)
{
    memcpy(g->before, g->r, sizeof g->r);
    for (long i = 0; i < 3 * ATOMS; ++i) g->r[i] *= by;
    set_box(g->chains, g->side, hol_chains_set_reference_box);
    g->side *= by;
    set_box(g->chains, g->side, hol_chains_set_box);
    ok(hol_project_positions(g->chains, g->before, g->r, NULL, dt, NULL, 0, NULL, NULL));
    ok(hol_chains_set_reference_box(g->chains, NULL)); /* the drift that follows begins and ends in the new cell */
}

static double weak_coupling(gas *g, long n_steps, int constrained)
{
    const double coupling = 0.02 / P_0; /* dt/tau times the compressibility 1/P_0 */
    double sum = 0;
    for (long step = -500; step < n_steps; ++step) {
        const double P = move(g, constrained);
        scale(g, cbrt(1 - coupling * (P_0 - P)));
        if (step >= 0) sum += g->side * g->side * g->side / (double)n_steps;
    }
    return sum;
}

static void cell_rescaling(gas *g, long n_steps, double *mean_volume, double *deviation)
{
    const double coupling = 0.02 / P_0;
    double sum = 0, squares = 0;
    for (long step = -2000; step < n_steps; ++step) {
        const double P = move(g, 1), V = g->side * g->side * g->side;
        const double strain = coupling * (P - P_0) + sqrt(2 * coupling * kT / V) * noise_normal(&g->random);
        scale(g, exp(strain / 3));
        const double after = g->side * g->side * g->side;
        if (step < 0) continue;
        sum += after / (double)n_steps;
        squares += after * after / (double)n_steps;
    }
    *mean_volume = sum;
    *deviation = sqrt(squares - sum * sum);
}

int main(void)
{
    static gas g;
    const double ideal = WATERS * kT / P_0;
    double V, deviation;
    begin(&g);
    V = weak_coupling(&g, 4000, 1);
    agrees("weak coupling, volume", V / ideal, 1, 0.02);
    V = weak_coupling(&g, 4000, 0);
    agrees("the same without the bonds' virial: wrong by", V / ideal, 2, 0.05); /* six freedoms as if of atoms */
    cell_rescaling(&g, 60000, &V, &deviation);
    agrees("cell rescaling, volume", V / ideal, (WATERS + 1.0) / WATERS, 0.03);
    agrees("its standard deviation", deviation / ideal, sqrt(WATERS + 1.0) / WATERS, 0.015);
    hol_worst worst;
    ok(hol_violation(g.chains, g.r, NULL, &worst));
    agrees("largest error of a bond", worst.length, 0, 1e-11);
    hol_chains_destroy(g.chains);
    return 0;
}
