#include "equations.h"

#include "check.h"

void leave_roundings_of_equations(const molecule *m, const double *lambda, const double *v, const double *f, int rates,
                                  const double *given)
{
    long double *a = calloc(3 * (size_t)m->n_atoms, sizeof *a), largest = 0;
    double *tension = calloc((size_t)m->n_atoms, sizeof *tension);
    for (int64_t i = 0; f && i < 3 * m->n_atoms; ++i) a[i] = f[i];
    for (int64_t k = 0; k < m->n_bonds; ++k)
        for (int e = 0; e < 2; ++e) {
            const int64_t i = m->pairs[2 * k + e], j = m->pairs[2 * k + 1 - e];
            tension[i] += 2 * fabs(lambda[k]) * m->length[k];
            for (int c = 0; c < 3; ++c)
                a[3 * i + c] += 2.0L * lambda[k] * ((long double)m->r[3 * j + c] - m->r[3 * i + c]);
        }
    for (int64_t i = 0; i < 3 * m->n_atoms; ++i) a[i] = a[i] / m->mass[i / 3] + (rates ? v[i] : 0);
    for (int64_t k = 0; k < m->n_bonds; ++k) {
        const int64_t i = m->pairs[2 * k], j = m->pairs[2 * k + 1];
        long double left = given ? 0.5L * given[k] : 0, terms = fabsl(left);
        long double of_ends[2] = {0};
        for (int c = 0; c < 3; ++c) {
            const long double d = (long double)m->r[3 * j + c] - m->r[3 * i + c];
            left += d * (a[3 * j + c] - a[3 * i + c]);
            for (int e = 0; e < 2; ++e) {
                const int64_t atom = 3 * (e ? j : i) + c;
                of_ends[e] += d * a[atom];
                if (f) terms += fabsl(d * f[atom]) / m->mass[atom / 3];
                if (rates) terms += fabsl(d * v[atom]);
            }
            if (v && !rates) left += powl((long double)v[3 * j + c] - v[3 * i + c], 2);
            if (v && !rates) terms += powl((long double)v[3 * j + c] - v[3 * i + c], 2);
        }
        terms += fabsl(of_ends[0]) + fabsl(of_ends[1]);
        const long double rounded = m->length[k] * (tension[i] / m->mass[i] + tension[j] / m->mass[j]);
        largest = fmaxl(largest, fabsl(left) / (oracle_bound(m->n_bonds) * terms + 0.6L * rounded));
    }
    CHECK_AT_MOST(largest, DBL_EPSILON);
    free(a), free(tension);
}
