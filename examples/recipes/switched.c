/*
 * Free energy along a parameter s that changes lengths, as in alchemical changes of one molecule into another one:
 *
 *     dA/ds = - < sum_k T_k da_k/ds >
 *
 * T_k the tensions of hol_forces at thermal velocities. No metric factor is missing, for bonds are rigid at each s.
 * Here: three atoms, two bonds with a joint that turns freely, and a field that pulls their ends apart. Without the
 * field A = - 2 kT ln(a b); with it the integral over angles is done by quadrature.
 */
#include "../sampling/noise.h"
#include "recipe.h"

enum { COPIES = 200000 };

static const double kT = 1.3, masses[3] = {3, 2, 5};

static double a(double s)
{
    return 1 + 0.5 * s;
}
static double b(double s)
{
    return 1.4 - 0.3 * s * s;
}

/* - ln of the integral over the directions of both bonds; the field pulls the ends apart along z. The measure of rigid
 * bonds is sqrt(det Z) a^2 b^2, and det Z has the cosine between them. */
static double free_energy(double s, double field, double gamma2)
{
    enum { N = 60 };
    double sum = 0;
    for (int i = 0; i < N; ++i)
        for (int j = 0; j < N; ++j)
            for (int k = 0; k < N; ++k) {
                const double z1 = -1 + (i + 0.5) * 2 / N, z2 = -1 + (j + 0.5) * 2 / N,
                             angle = k * 6.283185307179586 / N;
                const double c = z1 * z2 + sqrt((1 - z1 * z1) * (1 - z2 * z2)) * cos(angle);
                sum += sqrt(1 - gamma2 * c * c) * exp(field * (a(s) * z1 + b(s) * z2) / kT);
            }
    return -kT * (log(sum) + 2 * log(a(s) * b(s)));
}

/* Minus the mean of the tensions times the rates of their lengths, and its standard error. */
static mean slope(double s, double field, double gamma2, noise *random)
{
    const double lengths[2] = {a(s), b(s)}, h = 1e-6;
    const double da = (a(s + h) - a(s - h)) / (2 * h), db = (b(s + h) - b(s - h)) / (2 * h);
    const int64_t bonds[4] = {0, 1, 1, 2};
    double *const r = numbers(9 * COPIES), *const v = numbers(9 * COPIES), *const f = numbers(9 * COPIES);
    double *const mass = numbers(3 * COPIES), *const T = numbers(2 * COPIES), *const each = numbers(COPIES);
    hol_chains *chains;
    for (long i = 0; i < 3 * COPIES; ++i) mass[i] = masses[i % 3];
    ok(hol_chains_create(3 * COPIES, mass, &chains));
    ok(hol_chains_add_molecules(chains, COPIES, 3, 0, 2, bonds, lengths));
    for (long m = 0; m < COPIES; ++m) {
        double u[2][3], c, chance;
        do { /* directions with the density of the rigid molecule, by rejection */
            noise_direction(random, u[0]);
            noise_direction(random, u[1]);
            c = u[0][0] * u[1][0] + u[0][1] * u[1][1] + u[0][2] * u[1][2];
            chance = sqrt(1 - gamma2 * c * c) * exp(field * (a(s) * (u[0][2] - 1) + b(s) * (u[1][2] - 1)) / kT);
        } while (noise_uniform(random) > chance);
        for (int x = 0; x < 3; ++x) {
            r[9 * m + 3 + x] = a(s) * u[0][x];
            r[9 * m + 6 + x] = r[9 * m + 3 + x] + b(s) * u[1][x];
        }
        f[9 * m + 2] = -field;
        f[9 * m + 8] = field;
    }
    for (long i = 0; i < 9 * COPIES; ++i) v[i] = sqrt(kT / mass[i / 3]) * noise_normal(random);
    ok(hol_project_velocities(chains, r, v, NULL, NULL));
    ok(hol_forces(chains, r, v, f, NULL, T, NULL, HOL_WRITE, NULL));
    for (long m = 0; m < COPIES; ++m) each[m] = -(T[2 * m] * da + T[2 * m + 1] * db);
    const mean found = mean_of(each, COPIES);
    hol_chains_destroy(chains);
    free(r), free(v), free(f), free(mass), free(T), free(each);
    return found;
}

int main(void)
{
    noise random = noise_start(3);
    const double w[3] = {1 / masses[0], 1 / masses[1], 1 / masses[2]}, h = 1e-4;
    const double gamma2 = w[1] * w[1] / ((w[0] + w[1]) * (w[1] + w[2]));
    for (int k = 0; k < 4; ++k) {
        const double s = 0.2 + 0.6 * (k / 2), field = k % 2 ? 0.8 : 0;
        const double theory = (free_energy(s + h, field, gamma2) - free_energy(s - h, field, gamma2)) / (2 * h);
        const mean found = slope(s, field, gamma2, &random);
        char what[64];
        if (k % 2 == 0)
            agrees("without the field it is - 2 kT (a'/a + b'/b)", theory, -2 * kT * (0.5 / a(s) - 0.6 * s / b(s)),
                   1e-6);
        snprintf(what, sizeof what, "dA/ds at s = %.1f, field %.1f", s, field);
        agrees(what, found.value, theory, 4 * found.error);
    }
    return 0;
}
