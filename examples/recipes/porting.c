/*
 * What programs meet that have had SHAKE, each beside what is right (docs/porting.md):
 * (1) SHAKE of a gradient or of a search direction is hol_project_velocities of a handle with all masses 1.
 * (2) A last SHAKE "to be sure" has nothing to do, and is to be deleted.
 * (3) Angles that are exact now: acos of 1 + 1e-16, and 0/0 in the derivative at 180 degrees.
 * (4) r_ref holds the fixed atoms, too.
 * (5) The sign of the virial: + sum r (x) G here; GROMACS keeps - 1/2 of it.
 */
#include <string.h>

#include "recipe.h"

enum { ATOMS = 5, BONDS = 4 };

static const double start[ATOMS][3] = {{0, 0, 0}, {1, 0, 0}, {1.6, 0.8, 0}, {2.2, 0.8, 0.8}, {2.2, 1.4, 1.6}};
static const int64_t pairs[2 * BONDS] = {0, 1, 1, 2, 2, 3, 3, 4};
static const double lengths[BONDS] = {1, 1, 1, 1}, ones[ATOMS] = {1, 1, 1, 1, 1}, masses[ATOMS] = {12, 1, 16, 1, 14};

static hol_chains *chain_of(const double *mass)
{
    hol_chains *chain;
    ok(hol_chains_create(ATOMS, mass, &chain));
    ok(hol_chains_add_bonds(chain, BONDS, pairs, lengths));
    return chain;
}

static double dot(const double *a, const double *b, int n)
{
    double sum = 0;
    for (int i = 0; i < n; ++i) sum += a[i] * b[i];
    return sum;
}

/* (1) The part of a gradient along the constraints is nearest to it, among all vectors that change no length. */
static void gradients(void)
{
    hol_chains *const unit = chain_of(ones), *const heavy = chain_of(masses);
    double gradient[ATOMS][3], part[ATOMS][3], wrong[ATOMS][3], left[ATOMS][3], rate = 0;
    for (int i = 0; i < ATOMS; ++i)
        for (int c = 0; c < 3; ++c) gradient[i][c] = sin(3 * i + c + 1.);
    memcpy(part, gradient, sizeof part);
    memcpy(wrong, gradient, sizeof wrong);
    ok(hol_project_velocities(unit, start[0], part[0], NULL, NULL));
    ok(hol_project_velocities(heavy, start[0], wrong[0], NULL, NULL));
    for (int k = 0; k < BONDS; ++k)
        for (int c = 0; c < 3; ++c)
            rate = fmax(rate, fabs(dot(start[k + 1], part[k + 1], 3) - dot(start[k], part[k + 1], 3) -
                                   dot(start[k + 1], part[k], 3) + dot(start[k], part[k], 3)));
    agrees("rates of lengths along the gradient", rate, 0, 1e-14);
    for (int i = 0; i < 3 * ATOMS; ++i) left[i / 3][i % 3] = gradient[i / 3][i % 3] - part[i / 3][i % 3];
    agrees("what was taken away is at right angles to it", dot(left[0], part[0], 3 * ATOMS), 0, 1e-14);
    for (int i = 0; i < 3 * ATOMS; ++i) left[i / 3][i % 3] = gradient[i / 3][i % 3] - wrong[i / 3][i % 3];
    agrees("with masses it is not", fabs(dot(left[0], wrong[0], 3 * ATOMS)) > 0.1, 1, 0);
    hol_chains_destroy(unit);
    hol_chains_destroy(heavy);
}

/* (2) Bit by bit: another call, or a SHAKE of any tolerance, leaves positions as they are. */
static void the_last_shake(void)
{
    hol_chains *const chain = chain_of(masses);
    double r[ATOMS][3], again[ATOMS][3];
    hol_report report;
    hol_worst worst;
    for (int i = 0; i < 3 * ATOMS; ++i) r[i / 3][i % 3] = start[i / 3][i % 3] + 0.02 * cos(5. * i);
    ok(hol_project_positions(chain, start[0], r[0], NULL, 0.01, NULL, 0, NULL, NULL));
    memcpy(again, r, sizeof r);
    ok(hol_project_positions(chain, r[0], again[0], NULL, 0.01, NULL, 0, NULL, &report));
    agrees("molecules that a last call moves", (double)report.n_corrected, 0, 0);
    agrees("and its positions are the same", memcmp(again, r, sizeof r), 0, 0);
    ok(hol_violation(chain, r[0], NULL, &worst));
    agrees("what is left of the lengths", worst.length, 0, 4e-15);
    hol_chains_destroy(chain);
}

/* Energy of a harmonic angle at the middle atom, and its forces; the plain formulas, or those that hold everywhere. */
static double angle_energy(const double r[3][3], int plain, double f[3][3])
{
    const double rest = 3.0, k = 50;
    double p[3], q[3], turn[3];
    for (int c = 0; c < 3; ++c) p[c] = r[0][c] - r[1][c], q[c] = r[2][c] - r[1][c];
    const double pp = dot(p, p, 3), qq = dot(q, q, 3), pq = dot(p, q, 3);
    for (int c = 0; c < 3; ++c) turn[c] = p[(c + 1) % 3] * q[(c + 2) % 3] - p[(c + 2) % 3] * q[(c + 1) % 3];
    const double sine = sqrt(dot(turn, turn, 3)) / sqrt(pp * qq), cosine = pq / sqrt(pp * qq);
    const double angle = plain ? acos(cosine) : atan2(sine, cosine), pull = -k * (angle - rest);
    memset(f, 0, 9 * sizeof f[0][0]);
    if (plain || sine > 1e-8) { /* at 180 degrees no direction is the one in which it opens: no force */
        const double by = plain ? 1 / sqrt(1 - cosine * cosine) : 1 / sine;
        for (int c = 0; c < 3; ++c) {
            f[0][c] = pull * -by * (q[c] / sqrt(pp * qq) - cosine * p[c] / pp);
            f[2][c] = pull * -by * (p[c] / sqrt(pp * qq) - cosine * q[c] / qq);
            f[1][c] = -f[0][c] - f[2][c];
        }
    }
    return 0.5 * k * (angle - rest) * (angle - rest);
}

/* (3) CO2 by three distances: the angle is 180 degrees to the last digit, in any direction. */
static void exact_angles(void)
{
    const double co2[3] = {16, 12, 16}, distances[3] = {1.16, 1.16, 2.32};
    const int64_t three[6] = {0, 1, 1, 2, 0, 2};
    hol_chains *chain;
    int n_plain = 0, n_safe = 0;
    ok(hol_chains_create(3, co2, &chain));
    ok(hol_chains_add_bonds(chain, 3, three, distances));
    for (int k = 0; k < 200; ++k) {
        double r[3][3], f[3][3], u[3] = {sin(k + 1.), cos(2. * k), sin(3. * k + 2)};
        const double size = sqrt(dot(u, u, 3));
        for (int i = 0; i < 3; ++i)
            for (int c = 0; c < 3; ++c) r[i][c] = 1.16 * (i - 1) * u[c] / size + 0.02 * sin(7. * i + c + k);
        double before[3][3];
        memcpy(before, r, sizeof r);
        for (int i = 0; i < 3; ++i)
            for (int c = 0; c < 3; ++c) before[i][c] = 1.16 * (i - 1) * u[c] / size;
        ok(hol_project_positions(chain, before[0], r[0], NULL, 1, NULL, 0, NULL, NULL));
        double energy = angle_energy((const double(*)[3])r, 1, f);
        n_plain += !isfinite(energy + f[0][0] + f[1][0] + f[2][0]) || fabs(f[0][0]) > 1e3;
        energy = angle_energy((const double(*)[3])r, 0, f);
        n_safe += !(fabs(energy - 25 * pow(3.14159265358979324 - 3, 2)) < 1e-6) || !(dot(f[0], f[0], 9) < 1e4);
    }
    agrees("plain angles of exact CO2 are not finite, or huge", n_plain > 20, 1, 0);
    agrees("with atan2, and no force at 180 degrees: none", n_safe, 0, 0);
    hol_chains_destroy(chain);
}

/* (4) A chain that hangs on a wall: who copies what moves alone has nothing at the wall in r_ref. */
static void fixed_atoms(void)
{
    double held[ATOMS], r[ATOMS][3], moving_alone[ATOMS][3];
    memcpy(held, masses, sizeof held);
    held[0] = INFINITY;
    hol_chains *const chain = chain_of(held);
    memcpy(r, start, sizeof r);
    memcpy(moving_alone, start, sizeof moving_alone);
    for (int i = 0; i < ATOMS; ++i) r[i][1] += 5, moving_alone[i][1] += 5; /* the wall is elsewhere */
    memset(moving_alone[0], 0, sizeof moving_alone[0]);
    agrees("a reference without its fixed atom is refused",
           hol_project_positions(chain, moving_alone[0], r[0], NULL, 1, NULL, 0, NULL, NULL), HOL_ERR_LENGTHS, 0);
    double before[ATOMS][3];
    memcpy(before, r, sizeof r);
    for (int i = 1; i < ATOMS; ++i) r[i][2] -= 0.05 * i;
    ok(hol_project_positions(chain, before[0], r[0], NULL, 1, NULL, 0, NULL, NULL));
    agrees("with it the chain hangs on the wall", memcmp(r[0], before[0], sizeof r[0]), 0, 0);
    hol_chains_destroy(chain);
}

/* (5) Of molecules at rest under forces f: the virial is sum r (x) G, a matrix that is symmetric. */
static void sign_of_the_virial(void)
{
    hol_chains *const chain = chain_of(masses);
    double f[ATOMS][3], g[ATOMS][3], virial[9], of_atoms = 0;
    for (int i = 0; i < ATOMS; ++i)
        for (int c = 0; c < 3; ++c) f[i][c] = cos(2 * i + 3. * c);
    ok(hol_forces(chain, start[0], NULL, f[0], NULL, NULL, g[0], HOL_WRITE, virial));
    for (int i = 0; i < ATOMS; ++i) of_atoms += start[i][0] * g[i][0];
    agrees("virial, xx: + sum x G_x", virial[0], of_atoms, 1e-13);
    /* P V = (2 K + W)/3 with W its trace; GROMACS has Xi = - W/2 and P V = 2/3 (K - Xi) */
    const double w = virial[0] + virial[4] + virial[8], xi = -0.5 * w, kinetic = 7;
    agrees("the pressure in both", 2. / 3 * (kinetic - xi), (2 * kinetic + w) / 3, 1e-13);
    hol_chains_destroy(chain);
}

int main(void)
{
    gradients();
    the_last_shake();
    exact_angles();
    fixed_atoms();
    sign_of_the_virial();
    return 0;
}
