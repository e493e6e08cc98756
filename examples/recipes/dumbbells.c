/*
 * The stress of Brownian rigid dumbbells in shear, and so their viscosity, beside the series of kinetic theory (Bird,
 * Curtiss, Armstrong and Hassager, Dynamics of Polymeric Liquids, vol. 2; Stewart and Sorensen 1972):
 *
 *     eta/(n kT lambda) = 1 - 18/35 x^2 + 1326/1925 x^4 - ..,   lambda = zeta a^2/(12 kT),  x = lambda times the shear
 * rate
 *
 * The constraint forces' virial is not all of it: two atoms that are held at a distance have no velocity along it, so
 * that of their relative motion there are kT (1 - u u), not kT 1. Per dumbbell
 *
 *     stress = - kT (1 + 1 - u u) - W,   W the virial of hol_project_positions
 *
 * Of each two dumbbells the second one has the start and the noise of the first one, mirrored in y: without the flow
 * both would add up to no shear stress at all, so that what is left is the flow's.
 */
#include <string.h>

#include "../sampling/noise.h"
#include "recipe.h"

enum { N = 6000, STEPS = 3000, WARM = 1200, BLOCKS = 20 }; /* N: pairs, which are mirrored so that noise cancels */

static const double kT = 1, zeta = 12, a = 1, x = 0.3, dt = 0.005; /* lambda = 1, the shear rate is x */

int main(void)
{
    double *const r = numbers(6 * N), *const before = numbers(6 * N), *const friction = numbers(2 * N);
    noise random = noise_start(7);
    for (int i = 0; i < 2 * N; ++i) friction[i] = zeta;
    for (int k = 0; k < N; ++k) {
        double u[3], size = 0;
        for (int c = 0; c < 3; ++c) u[c] = noise_normal(&random), size += u[c] * u[c];
        if (k % 2 == 0)
            for (int c = 0; c < 3; ++c) r[6 * k + 3 + c] = a * u[c] / sqrt(size);
        else
            for (int c = 0; c < 3; ++c) r[6 * k + 3 + c] = (c == 1 ? -1 : 1) * r[6 * k - 3 + c];
    }
    hol_chains *dumbbells;
    const int64_t bond[2] = {0, 1};
    ok(hol_chains_create(2 * N, friction, &dumbbells)); /* frictions in place of masses */
    ok(hol_chains_add_molecules(dumbbells, N, 2, 0, 1, bond, &a));

    double virial_part[BLOCKS] = {0}, kinetic_part[BLOCKS] = {0}, both[BLOCKS];
    for (int step = -WARM; step < STEPS; ++step) {
        double virial[9], uu = 0, known = 0;
        memcpy(before, r, sizeof *r * 6 * N);
        const double kick = sqrt(2 * kT * dt / zeta);
        double xi[6];
        for (int k = 0; k < N; ++k) {
            const double *const b = before + 6 * k;
            double along = 0;
            for (int c = 0; c < 6; ++c)
                if (k % 2 == 0)
                    xi[c] = noise_normal(&random);
                else if (c % 3 == 1)
                    xi[c] = -xi[c];
            for (int c = 0; c < 3; ++c) along += (xi[3 + c] - xi[c]) * (b[3 + c] - b[c]);
            for (int i = 0; i < 2; ++i) {
                r[6 * k + 3 * i] += x * b[3 * i + 1] * dt; /* the flow */
                for (int c = 0; c < 3; ++c) r[6 * k + 3 * i + c] += kick * xi[3 * i + c];
            }
            const double xy = (b[3] - b[0]) * (b[4] - b[1]);
            uu += xy;
            known -= 0.5 * zeta / dt * kick * along * xy; /* the noise's part of W: its mean is 0, and known */
        }
        ok(hol_project_positions(dumbbells, before, r, NULL, sqrt(dt), NULL, 0, virial, NULL));
        if (step < 0) continue;
        const int block = step * BLOCKS / STEPS;
        virial_part[block] -= (virial[1] - known) / (N * x * STEPS / BLOCKS);
        kinetic_part[block] += kT * uu / (N * x * STEPS / BLOCKS);
    }
    for (int k = 0; k < BLOCKS; ++k) both[k] = virial_part[k] + kinetic_part[k];
    const double theory = 1 - 18.0 / 35 * x * x + 1326.0 / 1925 * pow(x, 4);
    const mean eta = mean_of(both, BLOCKS), alone = mean_of(virial_part, BLOCKS);
    printf("standard error %.2g; of the virial alone %.4g\n", eta.error, alone.value);
    agrees("viscosity of rigid dumbbells, x = 0.3", eta.value, theory, 0.005 + 4 * eta.error);
    agrees("the virial alone has less of it", alone.value, 0.774, 0.02);
    hol_chains_destroy(dumbbells);
    free(r);
    free(before);
    free(friction);
    return 0;
}
