#include "molecule.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

molecule molecule_empty(void)
{
    molecule m;
    memset(&m, 0, sizeof m);
    return m;
}

static double *larger(double *a, int64_t n)
{
    double *b = realloc(a, sizeof *b * (size_t)n);
    if (!b) abort();
    return b;
}

int64_t molecule_add_atom(molecule *m, double mass, const double r[3])
{
    if (m->n_atoms == m->room_for_atoms) {
        const int64_t n = m->room_for_atoms = 2 * m->room_for_atoms + 16;
        m->mass = larger(m->mass, n);
        m->inverse_mass = larger(m->inverse_mass, n);
        m->r = larger(m->r, 3 * n);
        m->v = larger(m->v, 3 * n);
        m->f = larger(m->f, 3 * n);
    }
    const int64_t i = m->n_atoms++;
    double w = 0; /* a mass whose reciprocal is the inverse mass to the last bit */
    for (int attempt = 0; mass > 0 && attempt < 100; ++attempt, mass = nextafter(mass, HUGE_VAL)) {
        w = 1 / mass;
        if (1 / (1 / w) == w) break;
    }
    m->inverse_mass[i] = w;
    m->mass[i] = w > 0 ? 1 / w : 0;
    memcpy(m->r + 3 * i, r, 3 * sizeof *r);
    return i;
}

void molecule_add_bond(molecule *m, int64_t i, int64_t j)
{
    if (m->n_bonds == m->room_for_bonds) {
        const int64_t n = m->room_for_bonds = 2 * m->room_for_bonds + 16;
        m->length = larger(m->length, n);
        m->pairs = realloc(m->pairs, 2 * sizeof *m->pairs * (size_t)n);
        if (!m->pairs) abort();
    }
    m->pairs[2 * m->n_bonds] = i;
    m->pairs[2 * m->n_bonds++ + 1] = j;
}

int64_t molecule_grow(molecule *m, int64_t to, double mass, double length, const double u[3])
{
    double r[3];
    for (int x = 0; x < 3; ++x) r[x] = m->r[3 * to + x] + length * u[x];
    const int64_t i = molecule_add_atom(m, mass, r);
    molecule_add_bond(m, to, i);
    return i;
}

void molecule_finish(molecule *m, random_stream *s)
{
    for (int64_t k = 0; k < m->n_bonds; ++k) {
        const double *a = m->r + 3 * m->pairs[2 * k], *b = m->r + 3 * m->pairs[2 * k + 1];
        long double square = 0;
        for (int x = 0; x < 3; ++x) square += ((long double)b[x] - a[x]) * ((long double)b[x] - a[x]);
        m->length[k] = (double)sqrtl(square);
    }
    for (int64_t i = 0; i < m->n_atoms; ++i) {
        const double root = sqrt(m->mass[i]);
        for (int x = 0; x < 3; ++x) {
            const double nv = random_normal(s), nf = random_normal(s);
            m->v[3 * i + x] = root > 0 ? nv / root : 0;
            m->f[3 * i + x] = root > 0 ? nf * root : nf;
        }
    }
}

double *molecule_drifted(const molecule *m, double dt)
{
    double *r = malloc(sizeof *r * 3 * (size_t)m->n_atoms);
    if (!r) abort();
    for (int64_t i = 0; i < 3 * m->n_atoms; ++i) r[i] = m->r[i] + dt * m->v[i];
    return r;
}

molecule_problem molecule_problem_of(const molecule *m)
{
    const molecule_problem p = {m->n_atoms, m->n_bonds, m->pairs, m->inverse_mass, m->r, m->v, m->f, NULL};
    return p;
}

molecule molecule_copy(const molecule *m)
{
    molecule c = molecule_empty();
    for (int64_t i = 0; i < m->n_atoms; ++i) molecule_add_atom(&c, m->mass[i], m->r + 3 * i);
    for (int64_t k = 0; k < m->n_bonds; ++k) molecule_add_bond(&c, m->pairs[2 * k], m->pairs[2 * k + 1]);
    const size_t vectors = 3 * sizeof *m->v * (size_t)m->n_atoms;
    memcpy(c.v, m->v, vectors);
    memcpy(c.f, m->f, vectors);
    memcpy(c.length, m->length, sizeof *m->length * (size_t)m->n_bonds);
    return c;
}

void molecule_free(molecule *m)
{
    free(m->mass);
    free(m->inverse_mass);
    free(m->r);
    free(m->v);
    free(m->f);
    free(m->pairs);
    free(m->length);
    *m = molecule_empty();
}
