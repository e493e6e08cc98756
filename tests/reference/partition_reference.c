#include "partition_reference.h"

#include <math.h>
#include <stdlib.h>

static long double share(double mass, double middle)
{
    if (middle == 0) return 0; /* fixed */
    return mass == 0 ? 1 : mass / ((long double)mass + middle);
}

/** x_n of the paper, Eq. (33), n = 2 .. N. */
static long double inertia(const double *m, int64_t n)
{
    return share(m[n], m[n - 1]) * share(m[n - 2], m[n - 1]);
}

/** (a)_k for k = 0 .. count-1. */
static long double *rising(long double a, int64_t count)
{
    long double *f = malloc(sizeof(long double) * (size_t)count);
    if (!f) abort();
    f[0] = 1;
    for (int64_t k = 1; k < count; ++k) f[k] = f[k - 1] * (a + (long double)(k - 1));
    return f;
}

long double partition_series(int64_t n_bonds, const double *masses, int p, const int64_t *terms)
{
    const long double a = p < 0 ? 0.5L : -0.5L;
    long double *pochhammer = rising(a, terms[0] + terms[1]), *factorial = rising(1, terms[0] + terms[1]);
    const int64_t most = terms[0] > terms[1] ? terms[0] : terms[1];
    long double *v = malloc(sizeof(long double) * (size_t)most), *next = malloc(sizeof(long double) * (size_t)most);
    long double log_scale = 0;
    if (!v || !next) abort();
    for (int64_t n = 2; n <= n_bonds + 1; ++n) { /* v_k: all before k_n = k is chosen, and past the last: k = 0 alone */
        const int64_t count = n > n_bonds ? 1 : terms[n % 2 == 0];
        const int64_t before = n == 2 ? 1 : terms[n % 2 == 1];
        const long double x = n > n_bonds ? 0 : inertia(masses, n);
        long double power = 1;
        for (int64_t k = 0; k < count; ++k) {
            long double sum = 0;
            if (n == 2) sum = pochhammer[k];
            for (int64_t j = before - 1; j >= 0 && n > 2; --j) sum += v[j] * pochhammer[j + k];
            next[k] = sum * power / ((long double)(2 * k + 1) * factorial[k] * pochhammer[k]);
            power *= x;
        }
        log_scale += logl(next[0]);
        for (int64_t k = 0; k < count; ++k) v[k] = next[k] / next[0];
    }
    free(pochhammer), free(factorial), free(v), free(next);
    return log_scale;
}

/** Nodes and weights of tanh-sinh quadrature on (0, 1), with the distance to the upper end, which a node can't carry.
 */
enum { POINTS = 401 };
typedef struct rule {
    long double node[POINTS], rest[POINTS], weight[POINTS];
} rule;

static rule tanh_sinh(void)
{
    rule r;
    const long double h = 9.0L / (POINTS - 1), half_pi = 1.57079632679489661923L;
    for (int i = 0; i < POINTS; ++i) {
        const long double t = (i - POINTS / 2) * h, u = expl(-2 * half_pi * sinhl(fabsl(t)));
        const long double small = u / (1 + u), c = coshl(t);
        r.node[i] = t < 0 ? small : 1 / (1 + u);
        r.rest[i] = t < 0 ? 1 / (1 + u) : small;
        r.weight[i] = h * half_pi * c * 2 * u / ((1 + u) * (1 + u));
    }
    return r;
}

/** Mean over gamma in 0 .. sqrt(x) of (P - gamma^2 Q)^(p/2), given P and the rest P - x Q. */
static long double innermost(long double P, long double Q, long double x, long double rest, int p)
{
    const long double top = sqrtl(x * Q), root = sqrtl(rest > 0 ? rest : 0), angle = atan2l(top, root);
    if (p < 0) return angle / top;
    return (P * angle / top + root) / 2;
}

long double partition_quadrature(int64_t n_bonds, const double *masses, int p)
{
    const rule r = tanh_sinh();
    const long double x2 = inertia(masses, 2), x3 = inertia(masses, 3), x4 = n_bonds > 3 ? inertia(masses, 4) : 0;
    /* det = (1 - g2^2) (1 - g4^2) - g3^2, the innermost gamma is the middle one. 1 - x2 and so on from the masses. */
    const long double r2 = 1 - x2, r4 = 1 - x4;
    long double sum = 0;
    for (int i = 0; i < POINTS; ++i) {
        const long double A = r2 + x2 * r.rest[i] * (1 + r.node[i]); /* 1 - x2 s^2 = 1 - x2 + x2 (1 - s) (1 + s) */
        for (int j = 0; j < (n_bonds > 3 ? POINTS : 1); ++j) {
            const long double B = n_bonds > 3 ? r4 + x4 * r.rest[j] * (1 + r.node[j]) : 1;
            const long double mean = innermost(A * B, 1, x3, A * B - x3, p);
            sum += r.weight[i] * (n_bonds > 3 ? r.weight[j] : 1) * mean;
        }
    }
    return logl(sum);
}
