/**
 * Free energy along a distance by thermodynamic integration: the distance is held by one more bond, and
 *     dA/dxi = - <T>,
 * T the tension of that bond (hol_forces, at thermal velocities). Alone, that is the free energy of the distance, the
 * entropy of its directions included. Beside other rigid bonds a factor is missing, which hol_metric knows:
 *     A(xi) = A_held(xi) - kT ln < sqrt(det Z_without / det Z_with) 2 xi >
 * with the determinants of the other bonds alone, and of all (theory.md (24)-(32); hol_metric's log_det_z).
 *
 * (1) Two atoms on a spring: dA/dxi = k (xi - xi_0) - 2 kT / xi.
 * (2) Two rigid arms of length 1 joined in the middle, and the distance of their ends: the angle's cosine c has the
 *     density sqrt(1 - gamma^2 c^2), so A = - kT ln (xi sqrt(1 - gamma^2 c^2)), c = 1 - xi^2 / 2.
 */
#include "../sampling/noise.h"
#include "recipe.h"

enum { COPIES = 20000 }; /* all of them in one call */

static const double kT = 1.3;

/* Velocities of the Maxwell distribution on the constraints: those of free atoms, projected. */
static void thermal_velocities(const hol_chains *chains, long n_atoms, const double *mass, const double *r, double *v,
                               noise *random)
{
    for (long i = 0; i < 3 * n_atoms; ++i) v[i] = sqrt(kT / mass[i / 3]) * noise_normal(random);
    ok(hol_project_velocities(chains, r, v, NULL, NULL));
}

static void two_atoms_on_a_spring(noise *random)
{
    const double k = 5, rest = 1.4, length = 1;
    double *const r = numbers(6 * COPIES), *const v = numbers(6 * COPIES), *const f = numbers(6 * COPIES);
    double *const tension = numbers(COPIES), *const mass = numbers(2 * COPIES), *const lengths = numbers(COPIES);
    hol_chains *chains;
    for (long i = 0; i < 2 * COPIES; ++i) mass[i] = i % 2 ? 2 : 7;
    ok(hol_chains_create(2 * COPIES, mass, &chains));
    ok(hol_chains_add_block(chains, COPIES, 1, 0, &length));
    for (double xi = 0.8; xi < 2.1; xi += 0.4) {
        for (long c = 0; c < COPIES; ++c) {
            lengths[c] = xi;
            r[6 * c + 3] = xi;
            f[6 * c] = k * (xi - rest);
            f[6 * c + 3] = -f[6 * c];
        }
        ok(hol_chains_set_lengths(chains,
                                  lengths)); /* hol_forces takes bonds as they are; the position level needs it */
        thermal_velocities(chains, 2 * COPIES, mass, r, v, random);
        ok(hol_forces(chains, r, v, f, NULL, tension, NULL, HOL_WRITE, NULL));
        const mean T = mean_of(tension, COPIES);
        char what[64];
        snprintf(what, sizeof what, "spring, dA/dxi at xi = %.1f", xi);
        agrees(what, -T.value, k * (xi - rest) - 2 * kT / xi, 4 * T.error);
    }
    hol_chains_destroy(chains);
    free(r), free(v), free(f), free(tension), free(mass), free(lengths);
}

/* Ends a distance xi apart, the middle at a distance of 1 from both. */
static void place(double *r, double xi)
{
    for (int i = 0; i < 9; ++i) r[i] = 0;
    r[0] = -0.5 * xi;
    r[4] = sqrt(1 - 0.25 * xi * xi);
    r[6] = 0.5 * xi;
}

/* ln of what the mean of A's correction is taken of; here all copies have the same shape, and it is the mean itself. */
static double log_factor(const hol_chains *with, const hol_chains *without, double xi)
{
    double r[9], all, arms;
    place(r, xi);
    ok(hol_metric(with, r, kT, NULL, &all, NULL, NULL, HOL_WRITE));
    ok(hol_metric(without, r, kT, NULL, &arms, NULL, NULL, HOL_WRITE));
    return 0.5 * (arms - all) + log(2 * xi);
}

static void ends_of_rigid_arms(noise *random)
{
    const double masses[3] = {1, 1, 4}, w[3] = {1, 1, 0.25};
    const double gamma2 = w[1] * w[1] / ((w[0] + w[1]) * (w[1] + w[2])), lengths[3] = {1, 1, 1};
    const int64_t bonds[6] = {0, 1, 1, 2, 0, 2};
    double *const r = numbers(9 * COPIES), *const v = numbers(9 * COPIES), *const T_all = numbers(3 * COPIES);
    double *const mass = numbers(3 * COPIES), *const T = numbers(COPIES);
    hol_chains *chains, *with, *without;
    for (long i = 0; i < 3 * COPIES; ++i) mass[i] = masses[i % 3];
    ok(hol_chains_create(3 * COPIES, mass, &chains));
    ok(hol_chains_add_molecules(chains, COPIES, 3, 0, 3, bonds, lengths));
    ok(hol_chains_create(3, masses, &with));
    ok(hol_chains_add_bonds(with, 3, bonds, lengths));
    ok(hol_chains_create(3, masses, &without));
    ok(hol_chains_add_bonds(without, 2, bonds, lengths));
    for (double xi = 0.5; xi < 1.9; xi += 0.4) {
        for (long c = 0; c < COPIES; ++c) place(r + 9 * c, xi);
        thermal_velocities(chains, 3 * COPIES, mass, r, v, random);
        ok(hol_forces(chains, r, v, NULL, NULL, T_all, NULL, HOL_WRITE, NULL));
        for (long c = 0; c < COPIES; ++c) T[c] = T_all[3 * c + 2];
        const mean held = mean_of(T, COPIES);
        const double h = 1e-4;
        const double factor = (log_factor(with, without, xi + h) - log_factor(with, without, xi - h)) / (2 * h);
        const double cosine = 1 - 0.5 * xi * xi;
        char what[64];
        snprintf(what, sizeof what, "rigid arms, dA/dxi at xi = %.1f", xi);
        agrees(what, -held.value - kT * factor, -kT * (1 / xi + gamma2 * cosine * xi / (1 - gamma2 * cosine * cosine)),
               4 * held.error + 1e-6);
    }
    hol_chains_destroy(chains);
    hol_chains_destroy(with);
    hol_chains_destroy(without);
    free(r), free(v), free(T_all), free(mass), free(T);
}

int main(void)
{
    noise random = noise_start(1);
    two_atoms_on_a_spring(&random);
    ends_of_rigid_arms(&random);
    return 0;
}
