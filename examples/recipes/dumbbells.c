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
 * What is left of the noise in a mean over time is that which turned the dumbbells: each kick changes
 * F = 3 u_y (u_x/x + u_y) by a known amount, whose mean is 0, and that dies out in the time lambda. So the sum of these
 * amounts, less the change of F from the first step to the last, is taken away: the error is a tenth then. No dumbbell
 * knows of another one, so it is that of their own means over time; a bond's part of W is -2 lambda d d, d its
 * reference.
 */
#include <string.h>

#include "../sampling/noise.h"
#include "recipe.h"

enum { N = 6000, STEPS = 3000, WARM = 1200 };

static const double kT = 1, zeta = 12, a = 1, x = 0.3, dt = 0.005; /* lambda = 1, the shear rate is x */

static double of_direction(const double *u)
{
    return 3 * u[1] * (u[0] / x + u[1]);
}

/* The flow, and noise. Returns the noise along the bond; `turned`: what the noise across it does to of_direction. */
static double move(double *r, noise *random, double *turned)
{
    const double kick = sqrt(2 * kT * dt / zeta), b[3] = {r[3] - r[0], r[4] - r[1], r[5] - r[2]};
    double xi[2][3], d[3], along = 0;
    for (int i = 0; i < 2; ++i) {
        r[3 * i] += x * r[3 * i + 1] * dt;
        for (int c = 0; c < 3; ++c) xi[i][c] = kick * noise_normal(random), r[3 * i + c] += xi[i][c];
    }
    for (int c = 0; c < 3; ++c) d[c] = xi[1][c] - xi[0][c], along += d[c] * b[c];
    for (int c = 0; c < 3; ++c) d[c] -= along * b[c];
    *turned = 3 * (d[1] * (b[0] / x + b[1]) + b[1] * (d[0] / x + d[1]));
    return along;
}

int main(void)
{
    double *const r = numbers(6 * N), *const before = numbers(6 * N), *const friction = numbers(2 * N);
    double *const lambda = numbers(N), *const along = numbers(N), *const alone = numbers(N), *const eta = numbers(N);
    double *const known = numbers(N), virial[9], all_bonds = 0;
    noise random = noise_start(7);
    for (int i = 0; i < 2 * N; ++i) friction[i] = zeta;
    for (int k = 0; k < N; ++k) noise_direction(&random, r + 6 * k + 3);
    hol_chains *dumbbells;
    const int64_t bond[2] = {0, 1};
    ok(hol_chains_create(2 * N, friction, &dumbbells)); /* frictions in place of masses */
    ok(hol_chains_add_molecules(dumbbells, N, 2, 0, 1, bond, &a));

    for (int step = -WARM; step < STEPS; ++step) {
        memcpy(before, r, sizeof *r * 6 * N);
        for (int k = 0; k < N; ++k) {
            double turned;
            along[k] = move(r + 6 * k, &random, &turned);
            if (step >= 0) known[k] += turned;
        }
        ok(hol_project_positions(dumbbells, before, r, NULL, sqrt(dt), lambda, 0, virial, NULL));
        if (step < 0) continue;
        all_bonds = 0;
        for (int k = 0; k < N; ++k) {
            const double *const b = before + 6 * k, *const e = r + 6 * k;
            const double u[3] = {b[3] - b[0], b[4] - b[1], b[5] - b[2]},
                         now[3] = {e[3] - e[0], e[4] - e[1], e[5] - e[2]};
            all_bonds -= 2 * lambda[k] * u[0] * u[1];
            /* the noise along the bond is a part of lambda, whose mean is 0 */
            alone[k] += (2 * lambda[k] - 0.5 * zeta / dt * along[k]) * u[0] * u[1] / (x * STEPS);
            eta[k] += kT * u[0] * u[1] / (x * STEPS);
            known[k] -= of_direction(now) - of_direction(u);
        }
    }
    agrees("the virial is that of the bonds", virial[1] / all_bonds, 1, 1e-10);
    for (int k = 0; k < N; ++k) {
        known[k] /= STEPS * dt;
        eta[k] += alone[k] - known[k];
        alone[k] -= 2. / 3 * known[k]; /* as u_x u_y comes twice in it, three times in eta */
    }
    /* The diffusion equation on the sphere, by spherical harmonics up to l = 14; the series' next term is about - x^6.
     */
    const double theory = 0.958641, of_virial = 0.775974, series = 1 - 18.0 / 35 * x * x + 1326.0 / 1925 * pow(x, 4);
    const mean both = mean_of(eta, N), part = mean_of(alone, N);
    agrees("the series at x = 0.3", series, theory, pow(x, 6));
    printf("standard errors %.2g and %.2g\n", both.error, part.error);
    /* Four errors; and steps of dt turn the dumbbells too fast by a part of 6 kT dt/(zeta a^2), which is 0.0025. */
    agrees("viscosity of rigid dumbbells", both.value, theory, 4 * both.error + 0.0025);
    agrees("its standard error", both.error, 0, 0.002);
    agrees("the virial alone has less of it", part.value, of_virial, 4 * part.error + 0.0025);
    hol_chains_destroy(dumbbells);
    free(r), free(before), free(friction), free(lambda), free(along), free(alone), free(eta), free(known);
    return 0;
}
