/**
 * Replicas: the same molecules at several temperatures, or in several windows. Two ways that give the same bits. One
 * handle serves all replicas, each with arrays of its own, also at the same time from several threads; or the replicas
 * are copies in one array, and one call works on all of them, side by side in the lanes of the processor's vectors.
 */
#include <string.h>

#include "../sampling/noise.h"
#include "recipe.h"

enum { REPLICAS = 8, ATOMS = 6, BONDS = 5 };

int main(void)
{
    /* A branched molecule. */
    const int64_t pairs[2 * BONDS] = {0, 1, 1, 2, 1, 3, 3, 4, 3, 5};
    const double start[3 * ATOMS] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 1, 0, 1, 2, 0, 1, 1, -1, 1};
    const double ones[BONDS] = {1, 1, 1, 1, 1}, dt = 0.05;
    double mass[REPLICAS * ATOMS], r[2][REPLICAS][3 * ATOMS], v[2][REPLICAS][3 * ATOMS], before[REPLICAS][3 * ATOMS];
    hol_chains *one, *all;
    for (int i = 0; i < REPLICAS * ATOMS; ++i) mass[i] = 1 + i % ATOMS;
    ok(hol_chains_create(ATOMS, mass, &one));
    ok(hol_chains_add_bonds(one, BONDS, pairs, ones));
    ok(hol_chains_create(REPLICAS * ATOMS, mass, &all));
    ok(hol_chains_add_molecules(all, REPLICAS, ATOMS, 0, BONDS, pairs, ones));

    noise random = noise_start(3);
    for (int k = 0; k < REPLICAS; ++k)
        for (int i = 0; i < 3 * ATOMS; ++i) {
            const double temperature = 0.1 * (k + 1);
            before[k][i] = start[i];
            v[0][k][i] = v[1][k][i] = sqrt(temperature / mass[i / 3]) * noise_normal(&random);
            r[0][k][i] = r[1][k][i] = start[i] + dt * v[0][k][i];
        }

    for (int k = 0; k < REPLICAS; ++k) { /* one after the other; by any threads */
        ok(hol_project_positions(one, before[k], r[0][k], v[0][k], dt, NULL, 0, NULL, NULL));
        ok(hol_project_velocities(one, r[0][k], v[0][k], NULL, NULL));
    }
    ok(hol_project_positions(all, before[0], r[1][0], v[1][0], dt, NULL, 0, NULL, NULL)); /* at once */
    ok(hol_project_velocities(all, r[1][0], v[1][0], NULL, NULL));

    agrees("bits that differ", memcmp(r[0], r[1], sizeof r[0]) != 0 || memcmp(v[0], v[1], sizeof v[0]) != 0, 0, 0);
    /* Replicas that change temperatures exchange nothing with the library: swap pointers, or scale velocities. */
    hol_chains_destroy(one);
    hol_chains_destroy(all);
    return 0;
}
