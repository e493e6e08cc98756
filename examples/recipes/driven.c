/*
 * A dimer whose length a(t) is driven: positions by hol_project_positions at the new length, velocities and forces by
 * hol_solve, with the right-hand sides that the rate of the length adds. Free flight has a closed form: a^2 times the
 * angular velocity stays as it is, and the tension is m (a omega^2 - a''), m the reduced mass.
 */
#include <string.h>

#include "recipe.h"

static double length_at(double t)
{
    return 1 + 0.2 * sin(t);
}
static double rate_at(double t)
{
    return 0.2 * cos(t);
}
static double change_of_rate_at(double t)
{
    return -0.2 * sin(t);
}

static double dot(const double *a, const double *b)
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void relative(const double x[2][3], double *d)
{
    for (int c = 0; c < 3; ++c) d[c] = x[1][c] - x[0][c];
}

static const double mass[2] = {1, 3}, omega = 1.3, end = 2;

/* Adds the impulses that give the bond the rate a': d.u = a a'. */
static void drive_velocities(hol_chains *dimer, const double r[2][3], double v[2][3], double t)
{
    double d[3], u[3], impulse[2][3];
    relative(r, d);
    relative((const double(*)[3])v, u);
    const double rhs = 2 * (dot(d, u) - length_at(t) * rate_at(t));
    ok(hol_solve(dimer, r[0], &rhs, NULL, impulse[0], HOL_WRITE, NULL));
    for (int i = 0; i < 2; ++i)
        for (int c = 0; c < 3; ++c) v[i][c] += impulse[i][c] / mass[i];
}

/* What plain hol_project_velocities would do, in silence: the rate is zero afterwards. */
static double rate_after_plain_projection(hol_chains *dimer, const double r[2][3], const double v[2][3])
{
    double u[2][3], d[3], w[3];
    memcpy(u, v, sizeof u);
    ok(hol_project_velocities(dimer, r[0], u[0], NULL, NULL));
    relative(r, d);
    relative((const double(*)[3])u, w);
    return dot(d, w);
}

/* The tension at an instant: as hol_forces finds it, less what a' and a'' ask for. */
static double tension_at(hol_chains *dimer, const double r[2][3], const double v[2][3], double t)
{
    double u[3], lambda, tension;
    relative(v, u);
    const double a = length_at(t), rate = rate_at(t);
    const double rhs = 2 * dot(u, u) - 2 * (rate * rate + a * change_of_rate_at(t)); /* no other forces here */
    ok(hol_solve(dimer, r[0], &rhs, &lambda, NULL, HOL_WRITE, NULL));
    ok(hol_reactions(dimer, r[0], HOL_BOX, &lambda, &tension, NULL, HOL_WRITE, NULL, NULL));
    return tension;
}

/* Velocity Verlet to the end; gives the angle and the tension there. */
static void fly(int steps, double *angle, double *tension)
{
    const double dt = end / steps;
    double r[2][3] = {{0}, {1, 0, 0}}, v[2][3] = {{0}, {rate_at(0), omega, 0}};
    hol_chains *dimer;
    const int64_t bond[2] = {0, 1};
    double a = length_at(0);
    ok(hol_chains_create(2, mass, &dimer));
    ok(hol_chains_add_bonds(dimer, 1, bond, &a));
    for (int s = 0; s < steps; ++s) {
        double before[2][3];
        memcpy(before, r, sizeof before);
        for (int i = 0; i < 2; ++i)
            for (int c = 0; c < 3; ++c) r[i][c] += dt * v[i][c];
        a = length_at((s + 1) * dt);
        ok(hol_chains_set_lengths(dimer, &a));
        ok(hol_project_positions(dimer, before[0], r[0], v[0], dt, NULL, 0, NULL, NULL));
        drive_velocities(dimer, (const double(*)[3])r, v, (s + 1) * dt); /* in place of hol_project_velocities */
    }
    double d[3], speed[3];
    relative((const double(*)[3])r, d);
    relative((const double(*)[3])v, speed);
    *angle = atan2(d[1], d[0]);
    agrees("d.u of a driven dimer is a a'", dot(d, speed), length_at(end) * rate_at(end), 1e-13);
    agrees("and would be 0 by hol_project_velocities",
           rate_after_plain_projection(dimer, (const double(*)[3])r, (const double(*)[3])v), 0, 1e-14);
    *tension = tension_at(dimer, (const double(*)[3])r, (const double(*)[3])v, end);
    hol_chains_destroy(dimer);
}

int main(void)
{
    const double m = mass[0] * mass[1] / (mass[0] + mass[1]), momentum = omega * length_at(0) * length_at(0);
    double theory = 0;
    for (int k = 0; k < 20000; ++k) theory += momentum / pow(length_at((k + 0.5) * end / 20000), 2) * end / 20000;
    const double now = momentum / pow(length_at(end), 2);
    double angle[2], tension[2];
    fly(400, &angle[0], &tension[0]);
    fly(800, &angle[1], &tension[1]);
    agrees("angle of a driven dimer", angle[1], theory, 1e-5);
    agrees("its error in half steps: a quarter", (angle[0] - theory) / (angle[1] - theory), 4, 0.1);
    agrees("its tension", tension[1], m * (length_at(end) * now * now - change_of_rate_at(end)), 1e-4);
    return 0;
}
