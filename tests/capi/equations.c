#include "equations.h"

#include "check.h"

void bond_in_box(const double *r, const int64_t *pair, const double *box, long double d[3])
{
    for (int c = 0; c < 3; ++c) d[c] = (long double)r[3 * pair[1] + c] - r[3 * pair[0] + c];
    for (int h = 2; h >= 0 && box; --h) {
        const long double cells = roundl(d[h] / box[4 * h]);
        for (int c = 0; c <= h; ++c) d[c] -= cells * box[3 * h + c];
    }
}

void leave_roundings_of_equations(const molecule *m, const double *lambda, const double *v, const double *f, int rates,
                                  const double *given)
{
    leave_roundings_in_box(m, NULL, lambda, v, f, rates, given);
}

void leave_roundings_in_box(const molecule *m, const double *box, const double *lambda, const double *v,
                            const double *f, int rates, const double *given)
{
    const long double underflow = DBL_MIN / DBL_EPSILON;
    const long double bound = oracle_bound(m->n_bonds) + (box ? 4 * fmaxl(box[0], box[4]) : 0);
    long double *a = calloc(3 * (size_t)m->n_atoms, sizeof *a), largest = 0;
    double *tension = calloc((size_t)m->n_atoms, sizeof *tension);
    for (int64_t i = 0; f && i < 3 * m->n_atoms; ++i) a[i] = f[i];
    for (int64_t k = 0; k < m->n_bonds; ++k) {
        long double d[3];
        bond_in_box(m->r, m->pairs + 2 * k, box, d);
        for (int e = 0; e < 2; ++e) {
            const int64_t i = m->pairs[2 * k + e];
            tension[i] += 2 * fabs(lambda[k]) * m->length[k];
            for (int c = 0; c < 3; ++c) a[3 * i + c] += (e ? -2.0L : 2.0L) * lambda[k] * d[c];
        }
    }
    for (int64_t i = 0; i < 3 * m->n_atoms; ++i) a[i] = a[i] * m->inverse_mass[i / 3] + (rates ? v[i] : 0);
    for (int64_t k = 0; k < m->n_bonds; ++k) {
        const int64_t i = m->pairs[2 * k], j = m->pairs[2 * k + 1];
        const double wi = m->inverse_mass[i], wj = m->inverse_mass[j];
        if (wi == 0 && wj == 0) continue;
        long double d[3];
        bond_in_box(m->r, m->pairs + 2 * k, box, d);
        long double left = given ? 0.5L * given[k] : 0, terms = fabsl(left);
        long double of_ends[2] = {0};
        for (int c = 0; c < 3; ++c) {
            left += d[c] * (a[3 * j + c] - a[3 * i + c]);
            for (int e = 0; e < 2; ++e) {
                const int64_t atom = 3 * (e ? j : i) + c;
                of_ends[e] += d[c] * a[atom];
                if (f) terms += fabsl(d[c] * f[atom]) * (e ? wj : wi);
                if (rates) terms += fabsl(d[c] * v[atom]);
            }
            if (v && !rates) left += powl((long double)v[3 * j + c] - v[3 * i + c], 2);
            if (v && !rates) terms += powl((long double)v[3 * j + c] - v[3 * i + c], 2);
        }
        terms += fabsl(of_ends[0]) + fabsl(of_ends[1]);
        const long double rounded = m->length[k] * (tension[i] * wi + tension[j] * wj);
        largest = fmaxl(largest, fabsl(left) / (bound * terms + 0.6L * rounded + underflow));
    }
    CHECK_AT_MOST(largest, DBL_EPSILON);
    free(a), free(tension);
}

void leave_roundings_of_rates(const molecule *m, const double *v, const molecule_solution *exact)
{
    for (int64_t k = 0; k < m->n_bonds; ++k) {
        const int64_t i = m->pairs[2 * k], j = m->pairs[2 * k + 1];
        long double rate = 0, size = 0;
        for (int x = 0; x < 3; ++x) {
            const long double d = (long double)m->r[3 * j + x] - m->r[3 * i + x];
            rate += d * ((long double)v[3 * j + x] - v[3 * i + x]);
            size += fabsl(d) * (exact->moved_scale[i] + exact->moved_scale[j]);
        }
        CHECK_AT_MOST(fabsl(rate), oracle_bound(m->n_bonds) * DBL_EPSILON * size);
    }
}
