#include "physics.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "random.h"

const char *const deviation_names[DEVIATIONS] = {"second derivatives",
                                                 "G",
                                                 "tensions",
                                                 "rates",
                                                 "changes of v",
                                                 "lengths",
                                                 "moves",
                                                 "changes of v with the positions",
                                                 "virials",
                                                 "ln det",
                                                 "energy",
                                                 "Fixman force",
                                                 "sum of the Fixman force"};

static void raise(deviations *x, deviation which, long double value, long double unit)
{
    const double ratio = value == 0 ? 0 : fabs((double)value) / (double)unit;
    if (!(ratio <= x->worst[which])) x->worst[which] = ratio; /* not a number is kept: no ratio is at least as large */
}

static double dot(const double *a, const double *b)
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static double size(const double *a)
{
    return sqrt(dot(a, a));
}

static void minus(const double *a, const double *b, double *d)
{
    for (int x = 0; x < 3; ++x) d[x] = a[x] - b[x];
}

/** One chain of a scene. */
typedef struct part {
    int64_t n, bond, number; /* bonds, place of the first in arrays per bond, number of the chain */
    const int64_t *atoms;
} part;

static double w(const scene *s, const part *p, int64_t k)
{
    return 1 / s->mass[p->atoms[k]];
}

static const double *at(const part *p, int64_t k, const double *per_atom)
{
    return per_atom + 3 * p->atoms[k];
}

static void bond(const part *p, int64_t k, const double *r, double *d)
{
    minus(at(p, k + 1, r), at(p, k, r), d);
}

/** factor (lambda_{i+1} d_{i+1} - lambda_i d_i) of atom i, and the size of the larger of the two. */
static double pull(const part *p, int64_t i, const double *r, const double *lambda, double factor, double *g)
{
    double most = 0;
    g[0] = g[1] = g[2] = 0;
    for (int side = 0; side < 2; ++side) {
        const int64_t k = i - 1 + side;
        if (k < 0 || k >= p->n) continue;
        double d[3];
        bond(p, k, r, d);
        const double t = factor * lambda[p->bond + k];
        for (int x = 0; x < 3; ++x) g[x] += side ? t * d[x] : -t * d[x];
        most = fmax(most, fabs(t) * size(d));
    }
    return most;
}

static void check_forces(deviations *x, const scene *s, const part *p, const answers *a, int plain)
{
    double g[3], before[3], before_size = 0;
    for (int64_t i = 0; i <= p->n; ++i) {
        const double *const own = at(p, i, a->g), *const f = at(p, i, s->f);
        const double most = pull(p, i, s->r, a->lambda[0], 2, g), wi = w(s, p, i);
        double left[3], acceleration[3];
        minus(own, g, left);
        raise(x, PULLS, size(left), DBL_EPSILON * most);
        for (int c = 0; c < 3; ++c) acceleration[c] = wi * (f[c] + own[c]);
        const double acceleration_size = wi * (size(f) + most);
        if (i > 0) {
            double d[3], dv[3], da[3];
            bond(p, i - 1, s->r, d);
            minus(at(p, i, s->v), at(p, i - 1, s->v), dv);
            minus(acceleration, before, da);
            raise(x, SECOND_DERIVATIVE, dot(d, da) + dot(dv, dv),
                  DBL_EPSILON * (size(d) * (acceleration_size + before_size) + dot(dv, dv)));
            const double tension = 2 * a->lambda[0][p->bond + i - 1] * size(d);
            if (!plain) raise(x, TENSIONS, a->tension[p->bond + i - 1] - tension, DBL_EPSILON * fabs(tension));
        }
        for (int c = 0; c < 3; ++c) before[c] = acceleration[c];
        before_size = acceleration_size;
    }
}

static void check_velocities(deviations *x, const scene *s, const part *p, const answers *a)
{
    double before_size = 0;
    for (int64_t i = 0; i <= p->n; ++i) {
        double g[3], left[3];
        const double most = w(s, p, i) * pull(p, i, s->r, a->lambda[1], 2, g);
        const double *const v = at(p, i, a->projected), *const was = at(p, i, s->v);
        for (int c = 0; c < 3; ++c) left[c] = v[c] - (was[c] + w(s, p, i) * g[c]);
        raise(x, CHANGES, size(left), DBL_EPSILON * (size(was) + most));
        if (i > 0) {
            double d[3], dv[3];
            bond(p, i - 1, s->r, d);
            minus(v, at(p, i - 1, a->projected), dv);
            raise(x, RATES, dot(d, dv), DBL_EPSILON * size(d) * (size(v) + most + before_size));
        }
        before_size = size(v) + most;
    }
}

static void check_positions(deviations *x, const scene *s, const part *p, const answers *a)
{
    double extent = 0;
    for (int64_t i = 0; i <= p->n; ++i) extent = fmax(extent, dot(at(p, i, a->moved), at(p, i, a->moved)));
    extent = sqrt(extent);
    for (int64_t i = 0; i <= p->n; ++i) {
        double move[3], left[3], push[3];
        const double *const r = at(p, i, a->moved), *const was = at(p, i, a->drifted);
        const double factor = 2 * time_step * time_step, wi = w(s, p, i);
        const double most = wi * pull(p, i, s->r, a->lambda[2], factor, move);
        for (int c = 0; c < 3; ++c) left[c] = r[c] - (was[c] + wi * move[c]);
        raise(x, MOVES, size(left), DBL_EPSILON * (size(was) + most));
        minus(at(p, i, a->pushed), at(p, i, s->v), push);
        for (int c = 0; c < 3; ++c) left[c] = push[c] - wi * move[c] / time_step;
        raise(x, PUSHES, size(left), DBL_EPSILON * (size(at(p, i, s->v)) + most / time_step));
        if (i == 0) continue;
        double d[3];
        const double length = s->length[p->bond + i - 1];
        bond(p, i - 1, a->moved, d);
        raise(x, LENGTHS, dot(d, d) - length * length, DBL_EPSILON * length * (extent + length));
    }
}

/** Bonds of a chain as if moved by h times a direction per atom. */
static void bond_along(const scene *s, const part *p, int64_t k, const double *direction, long double h, long double *d)
{
    const double *const r0 = at(p, k, s->r), *const r1 = at(p, k + 1, s->r);
    for (int x = 0; x < 3; ++x)
        d[x] = ((long double)r1[x] - r0[x]) +
               (direction ? h * ((long double)direction[3 * (k + 1) + x] - direction[3 * k + x]) : 0);
}

/** Logarithms of det Z~ and det Z, and what their rounding is measured by. */
typedef struct log_dets {
    long double scaled, scaled_size, whole, whole_size;
} log_dets;

/** ln det Z~ by Omega_k^2 = 1 - gamma_k^2 / Omega_{k-1}^2, and ln det Z; a logarithm for a few factors at a time. */
static log_dets log_dets_of(const scene *s, const part *p, const double *direction, long double h)
{
    enum { FACTORS = 32 };
    long double d[3], last[3] = {0}, last_q = 0, omega2 = 1, product = 1, own = 1;
    log_dets out = {0, 0, 0, 0};
    for (int64_t k = 0; k < p->n; ++k) {
        const long double w0 = w(s, p, k), w1 = w(s, p, k + 1);
        bond_along(s, p, k, direction, h, d);
        const long double q = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
        if (k > 0) {
            const long double before = w(s, p, k - 1), g = d[0] * last[0] + d[1] * last[1] + d[2] * last[2];
            omega2 = 1 - w0 * w0 * g * g / (q * last_q * (before + w0) * (w0 + w1) * omega2);
        }
        product *= omega2;
        own *= 4 * (w0 + w1) * q;
        out.scaled_size += 1 / omega2;
        if (k % FACTORS == FACTORS - 1 || k + 1 == p->n) {
            const long double of_products = logl(product), of_own = logl(own);
            out.scaled += of_products;
            out.whole += of_products + of_own;
            out.whole_size += fabsl(of_own);
            product = own = 1;
        }
        for (int x = 0; x < 3; ++x) last[x] = d[x];
        last_q = q;
    }
    out.whole_size += out.scaled_size;
    return out;
}

/** The Fixman force of a chain against a difference of ln det Z~ along a random direction. */
static void check_fixman(deviations *x, const scene *s, const part *p, const answers *a)
{
    long double along = 0, squares = 0;
    const long double h = 1e-5L;
    random_stream stream = random_seed((uint64_t)p->n);
    double *const direction = malloc(sizeof *direction * 3 * (size_t)(p->n + 1));
    if (!direction) abort();
    for (int64_t i = 0; i <= p->n; ++i) {
        const double *const force = at(p, i, a->fixman);
        for (int c = 0; c < 3; ++c) direction[3 * i + c] = 2 * random_uniform(&stream) - 1;
        along += dot(force, direction + 3 * i);
        squares += dot(force, force);
    }
    const log_dets ahead = log_dets_of(s, p, direction, h), behind = log_dets_of(s, p, direction, -h);
    free(direction);
    const long double slope = temperature / 2 * (ahead.scaled - behind.scaled) / (2 * h);
    raise(x, FIXMAN_FORCE, along + slope, 1e-6L * (sqrtl(squares) + DBL_EPSILON));
}

static void check_metric(deviations *x, const scene *s, const part *p, const answers *a, int plain)
{
    double sum[3] = {0}, sizes = 0;
    for (int64_t i = 0; i <= p->n; ++i) {
        const double *const force = at(p, i, a->fixman);
        for (int c = 0; c < 3; ++c) sum[c] += force[c];
        sizes += fabs(force[0]) + fabs(force[1]) + fabs(force[2]);
    }
    for (int c = 0; c < 3; ++c) raise(x, FIXMAN_SUM, sum[c], DBL_EPSILON * (sizes + DBL_EPSILON));
    const log_dets here = log_dets_of(s, p, NULL, 0);
    raise(x, LOGARITHMS, a->log_det[p->number] - here.scaled, DBL_EPSILON * here.scaled_size);
    if (!plain) raise(x, LOGARITHMS, a->log_det_z[p->number] - here.whole, DBL_EPSILON * here.whole_size);
    if (p->number % 4 == 0) check_fixman(x, s, p, a);
}

/** - sum 2 lambda_k d_k (x) d_k, times a factor, against what a call gave. */
static void check_virial(deviations *x, const scene *s, const double *lambda, double factor, const double *virial)
{
    long double sum[9] = {0};
    double sizes = 0;
    const int64_t *atoms = s->atoms;
    const double *l = lambda;
    for (int64_t c = 0; c < s->n_chains; ++c) {
        const part p = {s->bonds[c], 0, c, atoms};
        double part_sum[9] = {0};
        for (int64_t k = 0; k < p.n; ++k) {
            double d[3];
            bond(&p, k, s->r, d);
            const double t = factor * l[k];
            for (int i = 0; i < 9; ++i) part_sum[i] -= t * d[i / 3] * d[i % 3];
            sizes += fabs(t) * dot(d, d);
            if (k % 64 != 63 && k + 1 < p.n) continue;
            for (int i = 0; i < 9; ++i) sum[i] += part_sum[i];
            memset(part_sum, 0, sizeof part_sum);
        }
        atoms += p.n + 1;
        l += p.n;
    }
    for (int i = 0; i < 9; ++i) raise(x, VIRIALS, virial[i] - sum[i], DBL_EPSILON * sizes);
}

void deviations_add(deviations *x, const scene *s, const answers *a, int plain)
{
    const int64_t *atoms = s->atoms;
    int64_t first = 0;
    long double log_det = 0, sizes = 0;
    for (int64_t c = 0; c < s->n_chains; ++c) {
        const part p = {s->bonds[c], first, c, atoms};
        check_forces(x, s, &p, a, plain);
        check_velocities(x, s, &p, a);
        check_positions(x, s, &p, a);
        check_metric(x, s, &p, a, plain);
        log_det += a->log_det[c];
        sizes += fabs(a->log_det[c]);
        atoms += p.n + 1;
        first += p.n;
    }
    if (plain) return;
    for (int verb = 0; verb < 3; ++verb) check_virial(x, s, a->lambda[verb], 2, a->virial[verb]);
    raise(x, ENERGY, a->energy - temperature / 2 * log_det, DBL_EPSILON * temperature * (sizes + DBL_EPSILON));
}
