/*
 * Molecules in a flow or under a barostat in the equations of motion: r' = v + L r, v' = w (f + G) - A v. A plain half
 * kick by A v before the velocities are projected makes the method one of first order in dt; here it is one of second
 * order, with S = exp(-dt/2 A) and the projection repeated around it. What is compared: the same equations by Runge and
 * Kutta's fourth order with the exact forces of hol_forces, in steps so small that they count as exact.
 */
#include <string.h>

#include "recipe.h"

enum { N = 4 };
typedef double array[3 * N]; /* per atom */
typedef double matrix[9];    /* row after row */

static const double mass[N] = {1, 2, 1, 3}, stiffness[N] = {1, 0.6, 1.3, 0.8}, end = 1;

static void forces(const array r, array f)
{
    for (int i = 0; i < N; ++i)
        for (int c = 0; c < 3; ++c) f[3 * i + c] = -stiffness[i] * r[3 * i + c] + 0.3 * sin(r[3 * i + c]);
}

/* y = M x, atom by atom; y may be x. */
static void times(const matrix m, const array x, array y)
{
    for (int i = 0; i < N; ++i) {
        const double a = x[3 * i], b = x[3 * i + 1], c = x[3 * i + 2];
        for (int k = 0; k < 3; ++k) y[3 * i + k] = m[3 * k] * a + m[3 * k + 1] * b + m[3 * k + 2] * c;
    }
}

static void add(array y, double factor, const array x)
{
    for (int i = 0; i < 3 * N; ++i) y[i] += factor * x[i];
}

/* exp(t M) by its series; t M is small. */
static void exponential(double t, const matrix m, matrix e)
{
    matrix term = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    memcpy(e, term, sizeof term);
    for (int n = 1; n < 12; ++n) {
        matrix next = {0};
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j)
                for (int k = 0; k < 3; ++k) next[3 * i + j] += term[3 * i + k] * t * m[3 * k + j] / n;
        memcpy(term, next, sizeof term);
        for (int i = 0; i < 9; ++i) e[i] += term[i];
    }
}

static void start(const hol_chains *molecule, array r, array v)
{
    static const array r0 = {0, 0, 0, 0.8, 0.6, 0, 0.8, 0.6, 1, 0, 1.2, 1};
    memcpy(r, r0, sizeof r0);
    for (int i = 0; i < 3 * N; ++i) v[i] = 0.5 * cos(3.0 * i);
    ok(hol_project_velocities(molecule, r, v, NULL, NULL));
}

/* Velocity Verlet; A is L here, as in SLLOD. */
static void verlet(const hol_chains *molecule, const matrix L, int steps, int plain, array r, array v)
{
    const double dt = end / steps, h = dt / 2;
    array f, before, u;
    matrix S, S_inverse, D;
    exponential(-h, L, S);
    exponential(h, L, S_inverse);
    exponential(dt, L, D);
    start(molecule, r, v);
    for (int s = 0; s < steps; ++s) {
        forces(r, f);
        times(S, v, v);
        for (int i = 0; i < 3 * N; ++i) v[i] += h / mass[i / 3] * f[i];
        memcpy(before, r, sizeof before);
        times(S_inverse, v, u); /* the drift by v + L r: second order in dt */
        times(D, r, r);
        add(r, dt, u);
        ok(hol_project_positions(molecule, before, r, v, dt, NULL, 0, NULL, NULL));
        forces(r, f);
        if (plain) {
            times(L, v, u);
            add(v, -h, u);
            for (int i = 0; i < 3 * N; ++i) v[i] += h / mass[i / 3] * f[i];
            ok(hol_project_velocities(molecule, r, v, NULL, NULL));
            continue;
        }
        memcpy(u, v, sizeof u); /* u: before S, with the impulses of the constraints; v = S u */
        for (int i = 0; i < 3 * N; ++i) u[i] += h / mass[i / 3] * f[i];
        times(S, u, v);
        ok(hol_project_velocities(molecule, r, v, NULL, NULL));
        for (int again = 0; again < 2; ++again) {
            array old;
            times(S, u, old);
            add(u, 1, v);
            add(u, -1, old);
            times(S, u, v);
            ok(hol_project_velocities(molecule, r, v, NULL, NULL));
        }
    }
}

static void rates(const hol_chains *molecule, const matrix L, const array r, const array v, array r_rate, array v_rate)
{
    array f, LLr, Lv;
    forces(r, f);
    times(L, r, r_rate);
    times(L, r_rate, LLr);
    times(L, v, Lv);
    array all; /* all that accelerates the positions: r'' = w (f + G) + L L r */
    for (int i = 0; i < 3 * N; ++i) all[i] = f[i] + mass[i / 3] * LLr[i];
    ok(hol_forces(molecule, r, v, all, NULL, NULL, f, HOL_ADD, NULL));
    add(r_rate, 1, v);
    for (int i = 0; i < 3 * N; ++i) v_rate[i] = f[i] / mass[i / 3] - Lv[i];
}

static void runge_kutta(const hol_chains *molecule, const matrix L, int steps, array r, array v)
{
    static const double part[4] = {0, 0.5, 0.5, 1}, weight[4] = {1, 2, 2, 1};
    const double dt = end / steps;
    start(molecule, r, v);
    for (int s = 0; s < steps; ++s) {
        array kr = {0}, kv = {0}, r_sum = {0}, v_sum = {0};
        for (int k = 0; k < 4; ++k) {
            array r_there, v_there;
            memcpy(r_there, r, sizeof r_there);
            memcpy(v_there, v, sizeof v_there);
            add(r_there, part[k] * dt, kr);
            add(v_there, part[k] * dt, kv);
            rates(molecule, L, r_there, v_there, kr, kv);
            add(r_sum, weight[k] * dt / 6, kr);
            add(v_sum, weight[k] * dt / 6, kv);
        }
        add(r, 1, r_sum);
        add(v, 1, v_sum);
    }
}

static double largest(const array a, const array b)
{
    double most = 0;
    for (int i = 0; i < 3 * N; ++i) most = fmax(most, fabs(a[i] - b[i]));
    return most;
}

int main(void)
{
    static const matrix flows[3] = {{0, 0.5, 0, 0, 0, 0, 0, 0, 0},     /* shear */
                                    {0.3, 0, 0, 0, 0.3, 0, 0, 0, 0.3}, /* a barostat */
                                    {0.1, 0.4, 0.05, 0, -0.1, 0.1, 0, 0, 0.2}};
    const double lengths[N - 1] = {1, 1, 1};
    hol_chains *molecule;
    ok(hol_chains_create(N, mass, &molecule));
    ok(hol_chains_add_block(molecule, 1, N - 1, 0, lengths));
    for (int k = 0; k < 3; ++k) {
        array r, v, exact_r, exact_v;
        double error[2][3];
        ok(hol_chains_set_box_rate(molecule, flows[k]));
        runge_kutta(molecule, flows[k], 2000, exact_r, exact_v);
        for (int plain = 0; plain < 2; ++plain)
            for (int n = 0; n < 3; ++n) {
                verlet(molecule, flows[k], 100 << n, plain, r, v);
                error[plain][n] = largest(v, exact_v);
                printf("%s, dt %.4f: velocities off by %.2e\n", plain ? "plain" : "around", end / (100 << n),
                       error[plain][n]);
            }
        agrees("error over that of half the step", error[0][0] / error[0][1], 4, 0.2);
        agrees("again", error[0][1] / error[0][2], 4, 0.2);
        agrees("with the plain half kick", error[1][1] / error[1][2], 2, 0.3);
    }
    hol_chains_destroy(molecule);
    return 0;
}
