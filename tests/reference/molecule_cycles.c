#include "molecule_shapes.h"

#include <math.h>

static const double pi = 3.14159265358979323846;

void make_triangle(molecule *m, random_stream *s, double leg, double degrees, double centre_mass, double end_mass)
{
    double u[3], n[3], d[3];
    random_direction(s, u);
    unit_normal(s, u, n);
    first_atom(m, centre_mass);
    molecule_grow(m, 0, end_mass, leg, u);
    turned(u, n, degrees * pi / 180, 0, d);
    molecule_grow(m, 0, end_mass, leg, d);
    molecule_add_bond(m, 1, 2);
}

/** flatness 1: round but for noise; towards 0: pressed onto a line. */
void make_ring(molecule *m, random_stream *s, int64_t size, double flatness)
{
    const double radius = 0.5 / sin(pi / (double)size);
    for (int64_t i = 0; i < size; ++i) {
        const double phi = 2 * pi * (double)i / (double)size;
        const double r[3] = {radius * cos(phi) + 0.2 * random_normal(s),
                             flatness * (radius * sin(phi) + 0.2 * random_normal(s)),
                             flatness * 0.4 * random_normal(s)};
        molecule_add_atom(m, 1 + random_uniform(s), r);
    }
    for (int64_t i = 0; i < size; ++i) molecule_add_bond(m, i, (i + 1) % size);
}

void make_benzene(molecule *m, random_stream *s, double pucker, int rigid_angles)
{
    (void)s;
    for (int i = 0; i < 6; ++i) {
        const double phi = pi / 3 * i, z = i % 2 ? pucker : -pucker, r[3] = {1.39 * cos(phi), 1.39 * sin(phi), z};
        molecule_add_atom(m, 12.011, r);
    }
    for (int i = 0; i < 6; ++i) {
        const double phi = pi / 3 * i, u[3] = {cos(phi), sin(phi), 0};
        molecule_add_bond(m, i, (i + 1) % 6);
        if (rigid_angles) molecule_add_bond(m, i, (i + 2) % 6);
        molecule_grow(m, i, 1.008, 1.09, u);
    }
}

void make_triangles(molecule *m, random_stream *s, int64_t size, double low, double high, int planar)
{
    double u[3], n[3], next[3];
    random_direction(s, u);
    unit_normal(s, u, n);
    first_atom(m, 14);
    int64_t at = molecule_grow(m, 0, 14, 1.53, u);
    for (int64_t i = 2; i < size; ++i) {
        const double bend = pi / 180 * (180 - (low + (high - low) * random_uniform(s)));
        if (!planar) unit_normal(s, u, n);
        turned(u, n, bend, 0, next);
        if (planar) turned(u, n, bend + pi / 2, 0, n); /* n stays in the plane, at a right angle to the new bond */
        for (int x = 0; x < 3; ++x) {
            u[x] = next[x];
            if (planar) n[x] = -n[x];
        }
        at = molecule_grow(m, at, 14, 1.53, u);
        molecule_add_bond(m, at - 2, at);
    }
}

/** Hexagons in a row, each sharing an edge with the one before. */
void make_fused_rings(molecule *m, random_stream *s, int64_t size)
{
    for (int64_t column = 0; column <= 2 * size; ++column)
        for (int row = 0; row < 2; ++row) {
            const double y = (row ? 1 : -1) * (column % 2 ? 1.4 : 0.7);
            const double r[3] = {1.21 * (double)column + 0.05 * random_normal(s), y + 0.05 * random_normal(s),
                                 0.3 * random_normal(s)};
            molecule_add_atom(m, 12.011, r);
            if (column > 0) molecule_add_bond(m, 2 * column + row - 2, 2 * column + row);
            if (row == 1 && column % 2 == 0) molecule_add_bond(m, 2 * column, 2 * column + 1);
        }
}

void make_cube(molecule *m, random_stream *s)
{
    for (int i = 0; i < 8; ++i) {
        double r[3];
        for (int x = 0; x < 3; ++x) r[x] = (i >> x & 1) + 0.1 * random_normal(s);
        molecule_add_atom(m, 1 + random_uniform(s), r);
    }
    for (int i = 0; i < 8; ++i)
        for (int x = 0; x < 3; ++x)
            if (!(i >> x & 1)) molecule_add_bond(m, i, i | 1 << x);
}

void make_cubane(molecule *m)
{
    const double half = 0.785, diagonal = 1 / sqrt(3.0);
    for (int i = 0; i < 8; ++i) {
        double r[3];
        for (int x = 0; x < 3; ++x) r[x] = i >> x & 1 ? half : -half;
        molecule_add_atom(m, 12.011, r);
    }
    for (int i = 0; i < 8; ++i) {
        double u[3];
        for (int x = 0; x < 3; ++x) {
            u[x] = i >> x & 1 ? diagonal : -diagonal;
            if (!(i >> x & 1)) molecule_add_bond(m, i, i | 1 << x);
        }
        molecule_grow(m, i, 1.008, 1.09, u);
    }
}

void make_naphthalene(molecule *m)
{
    const double side = 1.40, across = side * sqrt(0.75);
    for (int end = -1; end <= 1; end += 2) { /* the bond that the rings share */
        const double r[3] = {0, end * side / 2, 0};
        molecule_add_atom(m, 12.011, r);
    }
    molecule_add_bond(m, 0, 1);
    for (int ring = -1; ring <= 1; ring += 2) {
        const int64_t first = m->n_atoms;
        for (int c = 0; c < 4; ++c) { /* round the ring from the lower end of that bond to the upper one */
            const double angle = pi / 3 * (c - 1.5);
            const double u[3] = {ring * cos(angle), sin(angle), 0};
            const double r[3] = {ring * across + side * u[0], side * u[1], 0};
            molecule_add_atom(m, 12.011, r);
            molecule_add_bond(m, c == 0 ? 0 : first + c - 1, first + c);
        }
        molecule_add_bond(m, first + 3, 1);
        for (int c = 0; c < 4; ++c) {
            const double angle = pi / 3 * (c - 1.5);
            const double u[3] = {ring * cos(angle), sin(angle), 0};
            molecule_grow(m, first + c, 1.008, 1.09, u);
        }
    }
}

/** On every third atom of the ring a tail that branches, nearly straight, of atoms a million times lighter. */
void make_lariat(molecule *m, random_stream *s, int64_t size)
{
    double u[3], n[3], d[3];
    make_ring(m, s, size, 1);
    for (int64_t i = 0; i < size; i += 3) {
        random_direction(s, u);
        unit_normal(s, u, n);
        const int64_t first = molecule_grow(m, i, 1e-6, 1, u);
        for (int c = 0; c < 2; ++c) {
            turned(u, n, 1e-3, pi * c + 0.1, d);
            const int64_t second = molecule_grow(m, first, 1e-6, 1, d);
            molecule_grow(m, second, 1, 1, d);
        }
    }
}

static void add_phenyl(molecule *m, int64_t at, const double u[3], const double n[3])
{
    int64_t ring[6];
    double d[3];
    ring[0] = molecule_grow(m, at, 12.011, 1.51, u);
    for (int c = 1; c < 6; ++c) { /* round from there: the direction turns by 60 degrees at each atom */
        turned(u, n, pi / 3 * (2 - c), 0, d);
        ring[c] = molecule_grow(m, ring[c - 1], 12.011, 1.39, d);
    }
    molecule_add_bond(m, ring[5], ring[0]);
    for (int c = 1; c < 6; ++c) {
        turned(u, n, pi / 3 * (1.5 - c) + pi / 2, 0, d);
        molecule_grow(m, ring[c], 1.008, 1.08, d);
    }
}

void make_peptide(molecule *m, random_stream *s, int64_t residues)
{
    const double bend = pi / 180 * 65;
    double u[3], n[3], d[3], e[3];
    random_direction(s, u);
    int64_t at = first_atom(m, 14.007);
    for (int64_t k = 0; k < residues; ++k) {
        for (int part = 0; part < 3; ++part) { /* N, CA, C */
            unit_normal(s, u, n);
            turned(u, n, bend, 2 * pi / 3, d);
            if (part == 0) molecule_grow(m, at, 1.008, 1.01, d);
            if (part == 2) molecule_grow(m, at, 15.999, 1.23, d);
            if (part == 1) {
                molecule_grow(m, at, 1.008, 1.09, d);
                turned(u, n, bend, 4 * pi / 3, d);
                const int64_t beta = molecule_grow(m, at, 12.011, 1.53, d);
                unit_normal(s, d, e);
                branches(m, s, beta, d, k % 3 == 2 ? 2 : 3, 1.008, 1.09);
                if (k % 3 == 2) add_phenyl(m, beta, d, e);
            }
            turned(u, n, bend, 0, d);
            for (int x = 0; x < 3; ++x) u[x] = d[x];
            at = molecule_grow(m, at, part == 2 ? 14.007 : 12.011, part == 0 ? 1.46 : part == 1 ? 1.53 : 1.33, u);
        }
    }
    molecule_grow(m, at, 1.008, 1.01, u);
}

void make_ten_distances(molecule *m, random_stream *s)
{
    make_xhn(m, s, 4);
    for (int i = 1; i < 5; ++i)
        for (int j = i + 1; j < 5; ++j) molecule_add_bond(m, i, j);
}

void make_planar_square(molecule *m)
{
    for (int i = 0; i < 4; ++i) {
        const double r[3] = {i & 1, i >> 1, 0};
        molecule_add_atom(m, 1, r);
    }
    for (int i = 0; i < 4; ++i)
        for (int j = i + 1; j < 4; ++j) molecule_add_bond(m, i, j);
}
