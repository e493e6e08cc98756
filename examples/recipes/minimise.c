/**
 * Minimisation with rigid bonds: steepest descent, FIRE and L-BFGS on a chain that hangs between two fixed points,
 * whose energy is known. All of them need three things: the force along the constraints, f + G with G of hol_forces at
 * rest; a way back after a move, hol_project_positions with the positions before it; and, for what is remembered from
 * earlier steps, hol_project_velocities, which takes from any vector what the bonds forbid. The masses of the handle
 * are a choice here: ones, so that all three mean the same metric.
 */
#include <string.h>

#include "recipe.h"

enum { BONDS = 20, ATOMS = BONDS + 1, SIZE = 3 * ATOMS, MEMORY = 8 };

static const double weight = 1, span = 14;
static hol_chains *chains;

static double energy(const double *r)
{
    double e = 0;
    for (int i = 1; i < BONDS; ++i) e += weight * r[3 * i + 2];
    return e;
}

static double dot(const double *a, const double *b)
{
    double sum = 0;
    for (int i = 0; i < SIZE; ++i) sum += a[i] * b[i];
    return sum;
}

/* Weights, and what the bonds make of them. Fixed ends have no force that moves them. */
static void force(const double *r, double *along)
{
    for (int i = 0; i < SIZE; ++i) along[i] = i % 3 == 2 ? -weight : 0;
    ok(hol_forces(chains, r, NULL, along, NULL, NULL, along, HOL_ADD, NULL));
    for (int c = 0; c < 3; ++c) along[c] = along[3 * BONDS + c] = 0;
}

/* r + step * direction, back on the constraints. False: no lengths can be reached from there, a shorter step is due. */
static int move(const double *r, double step, const double *direction, double *next)
{
    for (int i = 0; i < SIZE; ++i) next[i] = r[i] + step * direction[i];
    const int status = hol_project_positions(chains, r, next, NULL, 1, NULL, 0, NULL, NULL);
    if (status == HOL_ERR_NO_CONVERGENCE || status == HOL_ERR_LENGTHS) return 0;
    ok(status);
    return 1;
}

/* A V: two straight halves, slightly bent so that it is no equilibrium of any kind. */
static void start(double *r)
{
    const double dx = span / BONDS, dz = sqrt(1 - dx * dx);
    for (int i = 0; i < ATOMS; ++i) {
        r[3 * i] = i * dx;
        r[3 * i + 1] = 0;
        r[3 * i + 2] = -dz * (i < BONDS / 2 ? i : BONDS - i);
    }
}

static int steepest_descent(double *r)
{
    double f[SIZE], next[SIZE], step = 0.01;
    int steps = 0;
    for (force(r, f); sqrt(dot(f, f)) > 1e-6 && step > 1e-12; ++steps) {
        if (move(r, step, f, next) && energy(next) < energy(r)) {
            memcpy(r, next, sizeof next);
            force(r, f);
            step *= 1.1;
        } else {
            step *= 0.5;
        }
    }
    return steps;
}

/* Fast inertial relaxation engine (Bitzek et al. 2006): molecular dynamics that turns velocities downhill. */
static int fire(double *r)
{
    double f[SIZE], v[SIZE] = {0}, next[SIZE], dt = 0.05, mixing = 0.1;
    int steps = 0, downhill = 0;
    for (force(r, f); sqrt(dot(f, f)) > 1e-7 && steps < 100000; ++steps) {
        if (dot(f, v) > 0) {
            const double part = mixing * sqrt(dot(v, v) / dot(f, f));
            for (int i = 0; i < SIZE; ++i) v[i] = (1 - mixing) * v[i] + part * f[i];
            if (++downhill > 5) {
                dt = fmin(1.1 * dt, 0.5);
                mixing *= 0.99;
            }
        } else {
            for (int i = 0; i < SIZE; ++i) v[i] = 0;
            dt *= 0.5;
            mixing = 0.1;
            downhill = 0;
        }
        for (int i = 0; i < SIZE; ++i) v[i] += dt * f[i];
        for (int i = 0; i < SIZE; ++i) next[i] = r[i] + dt * v[i];
        const int status = hol_project_positions(chains, r, next, v, dt, NULL, 0, NULL, NULL);
        if (status != HOL_OK) { /* too long a step: from rest, with a shorter one */
            dt *= 0.5;
            for (int i = 0; i < SIZE; ++i) v[i] = 0;
            continue;
        }
        memcpy(r, next, sizeof next);
        ok(hol_project_velocities(chains, r, v, NULL, NULL));
        force(r, f);
    }
    return steps;
}

/* Limited-memory BFGS (Nocedal 1980). Steps and changes of the gradient of earlier points are projected where they are
 * used: what they say about directions that the bonds forbid there is of no use. */
static int lbfgs(double *r)
{
    static double s[MEMORY][SIZE], y[MEMORY][SIZE];
    double f[SIZE], old[SIZE], next[SIZE], p[SIZE], factor[MEMORY];
    int steps = 0, kept = 0;
    for (force(r, f); sqrt(dot(f, f)) > 1e-7 && steps < 2000; ++steps) {
        memcpy(p, f, sizeof p); /* minus the gradient */
        for (int k = kept - 1; k >= 0; --k) {
            factor[k] = dot(s[k], p) / dot(s[k], y[k]);
            for (int i = 0; i < SIZE; ++i) p[i] -= factor[k] * y[k][i];
        }
        const double first = kept ? dot(s[kept - 1], y[kept - 1]) / dot(y[kept - 1], y[kept - 1]) : 0.1;
        for (int i = 0; i < SIZE; ++i) p[i] *= first;
        for (int k = 0; k < kept; ++k) {
            const double by = factor[k] - dot(y[k], p) / dot(s[k], y[k]);
            for (int i = 0; i < SIZE; ++i) p[i] += by * s[k][i];
        }
        ok(hol_project_velocities(chains, r, p, NULL, NULL));
        const double slope = dot(p, f);
        double step = 1;
        while (!(move(r, step, p, next) && energy(next) <= energy(r) - 1e-4 * step * slope) && step > 1e-6) step *= 0.5;
        if (!(slope > 0) || step <= 1e-6) {
            if (kept == 0) break;
            kept = 0; /* what was remembered misleads: from steepest descent again */
            continue;
        }
        memcpy(old, f, sizeof f);
        force(next, f);
        if (kept == MEMORY) {
            memmove(s, s[1], (MEMORY - 1) * sizeof s[0]);
            memmove(y, y[1], (MEMORY - 1) * sizeof y[0]);
            --kept;
        }
        for (int i = 0; i < SIZE; ++i) {
            s[kept][i] = next[i] - r[i];
            y[kept][i] = old[i];
        }
        memcpy(r, next, sizeof next);
        ok(hol_project_velocities(chains, r, y[kept], NULL, NULL));
        for (int i = 0; i < SIZE; ++i) y[kept][i] -= f[i];
        ++kept;
        int good = 0;
        for (int k = 0; k < kept; ++k) {
            ok(hol_project_velocities(chains, r, s[k], NULL, NULL));
            if (k < kept - 1) ok(hol_project_velocities(chains, r, y[k], NULL, NULL));
            if (!(dot(s[k], y[k]) > 1e-10 * sqrt(dot(s[k], s[k]) * dot(y[k], y[k])))) continue;
            if (good != k) {
                memcpy(s[good], s[k], sizeof s[0]);
                memcpy(y[good], y[k], sizeof y[0]);
            }
            ++good;
        }
        kept = good;
    }
    return steps;
}

/* Horizontal tension H: the slope of bond k is (k - (BONDS - 1)/2) weight / H, and all bonds together span the gap. */
static double exact_energy(void)
{
    double low = 1e-3, high = 1e3;
    while (high - low > 1e-15 * high) {
        const double H = 0.5 * (low + high);
        double x = 0;
        for (int k = 0; k < BONDS; ++k) x += H / hypot(H, (k - 0.5 * (BONDS - 1)) * weight);
        if (x < span)
            low = H;
        else
            high = H;
        if (H == low && 0.5 * (low + high) == H) break;
    }
    double z = 0, e = 0;
    for (int k = 0; k < BONDS - 1; ++k) {
        const double up = (k - 0.5 * (BONDS - 1)) * weight;
        z += up / hypot(low, up);
        e += weight * z;
    }
    return e;
}

int main(void)
{
    const struct {
        const char *name;
        int (*minimise)(double *);
    } ways[] = {{"steepest descent", steepest_descent}, {"FIRE", fire}, {"L-BFGS", lbfgs}};
    double mass[ATOMS], length[BONDS], r[SIZE];
    for (int i = 0; i < ATOMS; ++i) mass[i] = i == 0 || i == BONDS ? 0 : 1;
    for (int k = 0; k < BONDS; ++k) length[k] = 1;
    ok(hol_chains_create(ATOMS, mass, &chains));
    ok(hol_chains_add_block(chains, 1, BONDS, 0, length));
    const double exact = exact_energy();
    for (int way = 0; way < 3; ++way) {
        start(r);
        const int steps = ways[way].minimise(r);
        printf("%d steps of ", steps);
        agrees(ways[way].name, energy(r), exact, 1e-12 * fabs(exact));
        hol_worst worst;
        ok(hol_violation(chains, r, NULL, &worst));
        agrees("largest error of a bond", worst.length, 0, 1e-13);
    }
    hol_chains_destroy(chains);
    return 0;
}
