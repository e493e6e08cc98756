#include "alkane_forces.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define KCAL (4.184 * KJ_PER_MOL)
#define DEGREE (3.14159265358979323846 / 180)

enum { HYDROGEN, CARBON };

static int element(const alkane *m, int atom)
{
    return atom < m->n_carbons ? CARBON : HYDROGEN;
}

static double dot(const double *a, const double *b)
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(const double *a, const double *b, double *c)
{
    c[0] = a[1] * b[2] - a[2] * b[1];
    c[1] = a[2] * b[0] - a[0] * b[2];
    c[2] = a[0] * b[1] - a[1] * b[0];
}

static void difference(const double *r, int to, int from, double *d)
{
    for (int x = 0; x < 3; ++x) d[x] = r[3 * to + x] - r[3 * from + x];
}

static void add(double *f, int atom, double factor, const double *d)
{
    for (int x = 0; x < 3; ++x) f[3 * atom + x] += factor * d[x];
}

/* ---------------------------------------------------------------------------------------------------- the molecule */

/** A hydrogen of carbon c, in the direction u. */
static void add_hydrogen(alkane *m, int c, const double *u)
{
    const int h = m->n_atoms++, k = m->n_bonds++;
    m->bonds[2 * k] = c, m->bonds[2 * k + 1] = h;
    m->lengths[k] = 1.09;
    m->mass[h] = 1.008;
    m->charge[h] = 0.06;
    m->charge[c] -= 0.06;
    for (int x = 0; x < 3; ++x) m->r[3 * h + x] = m->r[3 * c + x] + 1.09 / sqrt(dot(u, u)) * u[x];
}

static void place_atoms(alkane *m)
{
    const double half = 112.7 / 2 * DEGREE;
    for (int c = 0; c < m->n_carbons; ++c) {
        m->mass[c] = 12.011;
        m->r[3 * c] = 1.529 * sin(half) * c;
        m->r[3 * c + 2] = 1.529 * cos(half) * (c % 2);
        if (c == 0) continue;
        m->bonds[2 * m->n_bonds] = c - 1, m->bonds[2 * m->n_bonds + 1] = c;
        m->lengths[m->n_bonds++] = 1.529;
    }
    m->n_atoms = m->n_carbons;
    for (int c = 0; c < m->n_carbons; ++c) {
        const double up = c % 2 ? 1 : -1; /* away from the neighbours */
        const double side[2][3] = {{0, sqrt(2.0), up}, {0, -sqrt(2.0), up}};
        for (int h = 0; h < 2; ++h) add_hydrogen(m, c, side[h]);
        if (c > 0 && c < m->n_carbons - 1) continue;
        const double end[3] = {(c ? 1 : -1) * sin(half), 0, -up * cos(half)};
        add_hydrogen(m, c, end);
    }
}

/** Bonds between every two atoms, by paths of one bond more. */
static void find_separations(alkane *m)
{
    const int n = m->n_atoms;
    memset(m->separation, 4, (size_t)(n * n));
    for (int i = 0; i < n; ++i) m->separation[i * n + i] = 0;
    for (int far = 1; far <= 3; ++far)
        for (int k = 0; k < 2 * m->n_bonds; ++k) {
            const int from = (int)m->bonds[k], to = (int)m->bonds[k ^ 1];
            for (int i = 0; i < n; ++i)
                if (m->separation[i * n + from] == far - 1 && m->separation[i * n + to] > far)
                    m->separation[i * n + to] = m->separation[to * n + i] = (unsigned char)far;
        }
}

int alkane_make(int n_carbons, alkane *m)
{
    const size_t n = (size_t)(3 * n_carbons + 2);
    memset(m, 0, sizeof *m);
    m->n_carbons = n_carbons;
    m->bonds = calloc(2 * n, sizeof *m->bonds);
    m->lengths = calloc(n, sizeof *m->lengths);
    m->mass = calloc(n, sizeof *m->mass);
    m->charge = calloc(n, sizeof *m->charge);
    m->r = calloc(3 * n, sizeof *m->r);
    m->separation = calloc(n * n, 1);
    if (!m->bonds || !m->lengths || !m->mass || !m->charge || !m->r || !m->separation) return 1;
    place_atoms(m);
    find_separations(m);
    return 0;
}

void alkane_free(alkane *m)
{
    free(m->bonds), free(m->lengths), free(m->mass), free(m->charge), free(m->r), free(m->separation);
}

/* ------------------------------------------------------------------------------------------------------ the forces */

/** K (theta - theta_0)^2 of the angle i - j - k. */
static double angle(const alkane *m, const double *r, int i, int j, int k, double *f)
{
    const int carbons = element(m, i) + element(m, k);
    const double stiffness[3] = {33.0 * KCAL, 37.5 * KCAL, 58.35 * KCAL}, rest[3] = {107.8, 110.7, 112.7};
    double a[3], b[3], toward_i[3], toward_k[3];
    difference(r, i, j, a);
    difference(r, k, j, b);
    const double aa = dot(a, a), bb = dot(b, b), ab = sqrt(aa * bb), cosine = dot(a, b) / ab;
    const double bend = acos(cosine) - rest[carbons] * DEGREE;
    const double slope = 2 * stiffness[carbons] * bend / sqrt(1 - cosine * cosine); /* - dU/dcos */
    for (int x = 0; x < 3; ++x) {
        toward_i[x] = b[x] / ab - cosine * a[x] / aa;
        toward_k[x] = a[x] / ab - cosine * b[x] / bb;
    }
    add(f, i, slope, toward_i), add(f, k, slope, toward_k);
    add(f, j, -slope, toward_i), add(f, j, -slope, toward_k);
    return stiffness[carbons] * bend * bend;
}

/** V_1/2 (1 + cos phi) + V_2/2 (1 - cos 2 phi) + V_3/2 (1 + cos 3 phi) about the bond j - k; trans is phi = 180. */
static double torsion(const alkane *m, const double *r, int i, int j, int k, int l, double *f)
{
    const int carbons = element(m, i) + element(m, l);
    const double v[3][3] = {{0, 0, 0.318}, {0, 0, 0.366}, {1.740, -0.157, 0.279}}, *u = v[carbons];
    double a[3], b[3], c[3], n[3], o[3], side[3];
    difference(r, j, i, a);
    difference(r, k, j, b);
    difference(r, l, k, c);
    cross(a, b, n);
    cross(b, c, o);
    cross(n, o, side);
    const double bb = dot(b, b), length = sqrt(bb), nn = dot(n, n), oo = dot(o, o);
    const double phi = atan2(dot(side, b) / length, dot(n, o));
    const double slope =
        KCAL / 2 * (-u[0] * sin(phi) + 2 * u[1] * sin(2 * phi) - 3 * u[2] * sin(3 * phi)); /* dU/dphi */
    /* Blondel and Karplus 1996: no singularity but at straight angles */
    const double toward_i = slope * length / nn, toward_l = -slope * length / oo;
    const double p = dot(a, b) / bb, q = dot(c, b) / bb;
    add(f, i, toward_i, n), add(f, l, toward_l, o);
    add(f, j, -(1 + p) * toward_i, n), add(f, j, q * toward_l, o);
    add(f, k, -(1 + q) * toward_l, o), add(f, k, p * toward_i, n);
    return KCAL / 2 * (u[0] * (1 + cos(phi)) + u[1] * (1 - cos(2 * phi)) + u[2] * (1 + cos(3 * phi)));
}

/** Lennard-Jones and charges of atoms three bonds apart (half) or more. */
static double pair(const alkane *m, const double *r, int i, int j, double factor, double *f)
{
    const double sigma[2] = {2.50, 3.50}, epsilon[2] = {0.030 * KCAL, 0.066 * KCAL};
    const double four_epsilon = 4 * factor * sqrt(epsilon[element(m, i)] * epsilon[element(m, j)]);
    double d[3];
    difference(r, i, j, d);
    const double square = dot(d, d), six = pow(sigma[element(m, i)] * sigma[element(m, j)] / square, 3);
    const double charges = factor * 1389.35458 * KJ_PER_MOL * m->charge[i] * m->charge[j] / sqrt(square);
    const double slope = (6 * four_epsilon * six * (2 * six - 1) + charges) / square;
    add(f, i, slope, d), add(f, j, -slope, d);
    return four_epsilon * six * (six - 1) + charges;
}

double alkane_forces(const alkane *m, const double *r, double *f)
{
    const int n = m->n_atoms;
    double energy = 0;
    memset(f, 0, sizeof(double) * 3 * (size_t)n);
    for (int k = 0; k < 2 * m->n_bonds; ++k) { /* of each bond both directions, j to l */
        const int j = (int)m->bonds[k], l = (int)m->bonds[k ^ 1];
        for (int i = 0; i < n; ++i) {
            if (m->separation[i * n + j] != 1 || i == l) continue;
            if (i < l) energy += angle(m, r, i, j, l, f);
            if (k % 2) continue;
            for (int o = 0; o < n; ++o)
                if (m->separation[o * n + l] == 1 && o != j) energy += torsion(m, r, i, j, l, o, f);
        }
    }
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < i; ++j)
            if (m->separation[i * n + j] >= 3) energy += pair(m, r, i, j, m->separation[i * n + j] == 3 ? 0.5 : 1, f);
    return energy;
}
