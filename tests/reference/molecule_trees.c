#include "molecule_shapes.h"

#include <math.h>
#include <stdlib.h>

static const double pi = 3.14159265358979323846;

void unit_normal(random_stream *s, const double u[3], double n[3])
{
    double size;
    do {
        double e[3], along = 0, square = 0;
        random_direction(s, e);
        for (int x = 0; x < 3; ++x) along += e[x] * u[x];
        for (int x = 0; x < 3; ++x) {
            n[x] = e[x] - along * u[x];
            square += n[x] * n[x];
        }
        size = sqrt(square);
    } while (size < 0.3);
    for (int x = 0; x < 3; ++x) n[x] /= size;
}

void turned(const double u[3], const double n[3], double angle, double azimuth, double out[3])
{
    const double b[3] = {u[1] * n[2] - u[2] * n[1], u[2] * n[0] - u[0] * n[2], u[0] * n[1] - u[1] * n[0]};
    for (int x = 0; x < 3; ++x) out[x] = cos(angle) * u[x] + sin(angle) * (cos(azimuth) * n[x] + sin(azimuth) * b[x]);
}

int64_t first_atom(molecule *m, double mass)
{
    const double origin[3] = {0, 0, 0};
    return molecule_add_atom(m, mass, origin);
}

void branches(molecule *m, random_stream *s, int64_t at, const double u[3], int count, double mass, double length)
{
    const double angle = acos(1.0 / 3);
    double n[3], d[3];
    unit_normal(s, u, n);
    for (int c = 0; c < count; ++c) {
        turned(u, n, angle, 2 * pi * c / 3, d);
        molecule_grow(m, at, mass, length, d);
    }
}

/** A centre with `count` atoms around it, in the directions of a tetrahedron. */
void make_xhn(molecule *m, random_stream *s, int count)
{
    double u[3], back[3];
    random_direction(s, u);
    const int64_t centre = first_atom(m, count == 2 ? 15.999 : count == 3 ? 14.007 : 12.011);
    molecule_grow(m, centre, 1.008, 1.01, u);
    for (int x = 0; x < 3; ++x) back[x] = -u[x];
    branches(m, s, centre, back, count - 1, 1.008, 1.01);
}

void make_neopentane(molecule *m, random_stream *s)
{
    double u[3], n[3], d[3];
    random_direction(s, u);
    unit_normal(s, u, n);
    const int64_t centre = first_atom(m, 12.011);
    for (int c = 0; c < 4; ++c) {
        turned(u, n, c == 0 ? 0 : acos(-1.0 / 3), 2 * pi * c / 3, d);
        const int64_t carbon = molecule_grow(m, centre, 12.011, 1.53, d);
        branches(m, s, carbon, d, 3, 1.008, 1.09);
    }
}

/** A backbone with torsions at random and two hydrogens on every carbon atom, three at its ends. */
void make_alkane(molecule *m, random_stream *s, int64_t size)
{
    double u[3], n[3], next[3], side[3];
    random_direction(s, u);
    int64_t carbon = first_atom(m, 12.011);
    double back[3] = {-u[0], -u[1], -u[2]};
    branches(m, s, carbon, back, size > 1 ? 3 : 4, 1.008, 1.09);
    for (int64_t k = 1; k < size; ++k) {
        carbon = molecule_grow(m, carbon, 12.011, 1.53, u);
        if (k + 1 == size) {
            branches(m, s, carbon, u, 3, 1.008, 1.09);
            return;
        }
        unit_normal(s, u, n);
        for (int c = 0; c < 3; ++c) {
            turned(u, n, acos(1.0 / 3), 2 * pi * c / 3, c ? side : next);
            if (c) molecule_grow(m, carbon, 1.008, 1.09, side);
        }
        for (int x = 0; x < 3; ++x) u[x] = next[x];
    }
}

/** turn < 0: a random walk. light: every other backbone atom has this mass, if it is positive. */
void make_comb(molecule *m, random_stream *s, int64_t size, double turn, double light)
{
    double u[3], n[3], next[3], side[3];
    random_direction(s, u);
    int64_t at = first_atom(m, 1);
    for (int64_t k = 0; k < size; ++k) {
        if (k > 0) {
            if (turn < 0) {
                random_direction(s, next);
            } else {
                unit_normal(s, u, n);
                turned(u, n, turn, 0, next);
            }
            for (int x = 0; x < 3; ++x) u[x] = next[x];
            at = molecule_grow(m, at, light > 0 && k % 2 ? light : 1, 1, u);
        }
        random_direction(s, side);
        molecule_grow(m, at, 1, 0.8, side);
    }
}

void make_dendrimer(molecule *m, random_stream *s, int64_t generations)
{
    double u[3];
    first_atom(m, 1);
    int64_t low = 0, high = 1;
    for (int64_t g = 0; g < generations; ++g) {
        for (int64_t i = low; i < high; ++i)
            for (int c = 0; c < (g == 0 ? 3 : 2); ++c) {
                random_direction(s, u);
                const int64_t inner = molecule_grow(m, i, 1, 1, u);
                random_direction(s, u);
                molecule_grow(m, inner, 1.5, 1.2, u);
            }
        low = high;
        high = m->n_atoms;
    }
}

void make_star(molecule *m, random_stream *s, int64_t arms)
{
    double u[3];
    first_atom(m, 2);
    for (int64_t c = 0; c < arms; ++c) {
        random_direction(s, u);
        const int64_t inner = molecule_grow(m, 0, 1, 1, u);
        random_direction(s, u);
        molecule_grow(m, inner, 0.5, 0.7, u);
    }
}

void make_tree(molecule *m, random_stream *s, int64_t n_bonds, int valence)
{
    double u[3];
    int *bonds = calloc((size_t)n_bonds + 1, sizeof *bonds); /* of each atom */
    first_atom(m, 1);
    while (m->n_bonds < n_bonds) {
        const int64_t to = random_integer(s, 0, m->n_atoms - 1);
        if (bonds[to] >= valence) continue;
        ++bonds[to], ++bonds[m->n_atoms];
        random_direction(s, u);
        molecule_grow(m, to, pow(10, 2 * random_uniform(s) - 1), 0.7 + 0.8 * random_uniform(s), u);
    }
    free(bonds);
}

void make_taut(molecule *m, random_stream *s, int64_t size, double turn)
{
    double u[3] = {0.6, 0, 0.8}, n[3], next[3], side[3];
    int64_t at = first_atom(m, 0);
    for (int64_t k = 1; k <= size; ++k) {
        unit_normal(s, u, n);
        turned(u, n, turn, 0, next);
        const int exact = turn == 0; /* along an axis, where coordinates are exact */
        for (int x = 0; x < 3; ++x) u[x] = exact ? x == 0 : next[x];
        at = molecule_grow(m, at, k == size ? 0 : 1, 1, u);
        if (k == size || k % 2) continue;
        random_direction(s, side);
        molecule_grow(m, at, 1, 1, side);
    }
}

void make_coplanar_star(molecule *m, random_stream *s)
{
    first_atom(m, 1);
    for (int c = 0; c < 3; ++c) {
        const double angle = 2 * pi * c / 3 + 0.2 * random_uniform(s);
        const double u[3] = {cos(angle), sin(angle), 1e-8 * random_normal(s)};
        const int64_t inner = molecule_grow(m, 0, 1e8, 1, u);
        double d[3];
        random_direction(s, d);
        molecule_grow(m, inner, 1e8, 1, d);
    }
}
