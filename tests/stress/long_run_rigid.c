/**
 * Long runs of rigid bodies: what must stay?
 *     long_run_rigid STEPS
 * NVE of a body of each kind, tied to the origin by springs at two of its atoms, by RATTLE with the library's
 * projections: distances within the rounding of the coordinates, energy without a drift, the angular momentum about the
 * origin, which the springs do not change, and back to the start with velocities reversed. Exit status 1 if one of them
 * fails.
 */
#include <float.h>
#include <holonomic.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST = 60 };

typedef struct body {
    const char *name;
    int n;
    double mass[MOST], place[3 * MOST];
} body;

static void must(int status)
{
    if (status == HOL_OK) return;
    printf("FAILED: %s: %s\n", hol_status_name(status), hol_error_message());
    exit(1);
}

static body make_body(int which)
{
    static const char *const names[] = {"CO2", "TIP4P", "benzene", "methane", "a cage of 60"};
    static const int sizes[] = {3, 4, 12, 5, 60};
    body b = {.name = names[which], .n = sizes[which]};
    const double pi = acos(-1.0), carbon_dioxide[9] = {-1.16, 0, 0, 0, 0, 0, 1.16, 0, 0},
                 tip4p[12] = {0, 0, 0, 0.9572, 0, 0, -0.24, 0.9266, 0, 0.0934, 0.1206, 0};
    for (int i = 0; i < b.n; ++i) {
        double *x = b.place + 3 * i;
        b.mass[i] = i == 0 ? 12 : 1;
        if (which == 0) memcpy(x, carbon_dioxide + 3 * i, 3 * sizeof *x), b.mass[i] = i == 1 ? 12 : 16;
        if (which == 1) memcpy(x, tip4p + 3 * i, 3 * sizeof *x), b.mass[i] = i == 0 ? 16 : i < 3 ? 1 : 0;
        if (which == 2) {
            const double size = i < 6 ? 1.4 : 2.48;
            x[0] = size * cos(pi / 3 * i), x[1] = size * sin(pi / 3 * i);
            b.mass[i] = i < 6 ? 12 : 1;
        }
        for (int c = 0; which == 3 && i > 0 && c < 3; ++c) x[c] = i == 1 || i == c + 2 ? 0.63 : -0.63;
        if (which == 4) {
            const double z = 1 - (i + 0.5) / 30, s = sqrt(1 - z * z);
            x[0] = 3.5 * s * cos(2.399963 * i), x[1] = 3.5 * s * sin(2.399963 * i), x[2] = 3.5 * z;
            b.mass[i] = 12;
        }
    }
    return b;
}

/** Springs at the first and the third atom; returns the potential energy. */
static double springs(const body *b, const double *r, double *f)
{
    double sum = 0;
    memset(f, 0, sizeof *f * 3 * (size_t)b->n);
    for (int i = 0; i < 3; i += 2)
        for (int c = 0; c < 3; ++c) {
            f[3 * i + c] = -(1 + i) * r[3 * i + c];
            sum += 0.5 * (1 + i) * r[3 * i + c] * r[3 * i + c];
        }
    return sum;
}

static double kinetic(const body *b, const double *v)
{
    double sum = 0;
    for (int i = 0; i < 3 * b->n; ++i) sum += 0.5 * b->mass[i / 3] * v[i] * v[i];
    return sum;
}

static void angular_momentum(const body *b, const double *r, const double *v, double *l)
{
    memset(l, 0, 3 * sizeof *l);
    for (int i = 0; i < b->n; ++i)
        for (int c = 0; c < 3; ++c) {
            const int d = 3 * i + (c + 1) % 3, e = 3 * i + (c + 2) % 3;
            l[c] += b->mass[i] * (r[d] * v[e] - r[e] * v[d]);
        }
}

static int run(int which, int64_t n_steps)
{
    const body b = make_body(which);
    const double dt = 2e-3;
    double r[3 * MOST], v[3 * MOST], f[3 * MOST], ref[3 * MOST], start[3 * MOST], l[2][3], mean[2] = {0, 0}, worst = 0;
    const int64_t n = b.n, back = n_steps < 2000 ? n_steps : 2000;
    int64_t atoms[MOST];
    hol_chains *chains;
    hol_worst now;
    for (int i = 0; i < b.n; ++i) {
        atoms[i] = i;
        const double *x = b.place + 3 * i;
        const double spin[3] = {0.3, 0.9, 0.7},
                     turned[3] = {spin[1] * x[2] - spin[2] * x[1], spin[2] * x[0] - spin[0] * x[2],
                                  spin[0] * x[1] - spin[1] * x[0]};
        for (int c = 0; c < 3; ++c) r[3 * i + c] = x[c] + 0.4 * c, v[3 * i + c] = turned[c] + 0.2 - 0.1 * c;
    }
    must(hol_chains_create(n, b.mass, &chains));
    must(hol_chains_add_rigid(chains, 1, &n, atoms, b.place, 0, NULL, NULL));
    must(hol_project_velocities(chains, r, v, NULL, NULL));
    angular_momentum(&b, r, v, l[0]);
    double potential = springs(&b, r, f), largest = 0;
    const double energy = potential + kinetic(&b, v);
    int64_t reversed = -1;
    for (int64_t s = 0; s < n_steps + back; ++s) {
        if (s == n_steps - back) memcpy(start, r, sizeof r);
        if (s == n_steps) {
            angular_momentum(&b, r, v, l[1]);
            must(hol_violation(chains, r, v, &now));
            for (int i = 0; i < 3 * b.n; ++i) v[i] = -v[i];
            reversed = s;
        }
        memcpy(ref, r, sizeof r);
        for (int i = 0; i < 3 * b.n; ++i) {
            if (b.mass[i / 3] > 0) v[i] += dt / 2 * f[i] / b.mass[i / 3];
            r[i] += dt * v[i];
        }
        must(hol_project_positions(chains, ref, r, v, dt, NULL, 0, NULL, NULL));
        potential = springs(&b, r, f);
        for (int i = 0; i < 3 * b.n; ++i)
            if (b.mass[i / 3] > 0) v[i] += dt / 2 * f[i] / b.mass[i / 3];
        must(hol_project_velocities(chains, r, v, NULL, NULL));
        if (reversed >= 0) continue;
        const double off = (potential + kinetic(&b, v)) / energy - 1;
        largest = fmax(largest, fabs(off));
        mean[2 * s >= n_steps] += off * 2 / (double)n_steps;
    }
    hol_chains_destroy(chains);
    double change = 0, size = 0, way = 0;
    for (int c = 0; c < 3; ++c) change = fmax(change, fabs(l[1][c] - l[0][c])), size = fmax(size, fabs(l[0][c]));
    for (int i = 0; i < 3 * b.n; ++i) way = fmax(way, fabs(r[i] - start[i]));
    worst = fmax(now.length, now.rate);
    // A step rounds velocities twice and positions once, by some two units of the last digit together. These have no
    // preferred direction: they add up as the root of their number, of which six times the mean is never met. One that
    // is the same in each step would come out above that after some thousand steps.
    const double walk = 6 * 2 * DBL_EPSILON * sqrt((double)n_steps);
    const int good = worst < 1e-13 && largest < 1e-3 && fabs(mean[1] - mean[0]) < 0.2 * largest &&
                     change < walk * size && way < 1e-11;
    printf(
        "%-14s %lld steps: distances and rates %.1e, energy %.1e and its mean moves by %.1e, angular momentum %.1e, "
        "back after %lld steps %.1e  %s\n",
        b.name, (long long)n_steps, worst, largest, mean[1] - mean[0], change / size, (long long)back, way,
        good ? "ok" : "FAILED");
    return !good;
}

int main(int argc, char **argv)
{
    const int64_t n_steps = argc > 1 ? atoll(argv[1]) : 1000000;
    int failures = 0;
    for (int which = 0; which < 5; ++which) failures += run(which, n_steps);
    return failures > 0;
}
