#include "chain.h"

#include <math.h>
#include <stdlib.h>

#include "random.h"

const char *chain_kind_name(chain_kind kind)
{
    static const char *const names[CHAIN_KINDS] = {
        "coil",       "heterogeneous", "nearly straight", "straight",   "lattice",        "folded", "masses 1e3",
        "masses 1e6", "fixed ends",    "bond ratio 1e6",  "offset 1e6", "rod masses 1e9", "taut",
    };
    return names[kind];
}

/** Turns u by an angle, about an axis chosen at random: the new direction is cos u + sin p, p normal to u. */
static void turn(random_stream *s, double u[3], double angle)
{
    double e[3], p[3], q = 0, along = 0;
    random_direction(s, e);
    for (int x = 0; x < 3; ++x) along += e[x] * u[x];
    for (int x = 0; x < 3; ++x) {
        p[x] = e[x] - along * u[x];
        q += p[x] * p[x];
    }
    q = sqrt(q);
    double size = 0;
    for (int x = 0; x < 3; ++x) {
        u[x] = cos(angle) * u[x] + (q > 0 ? sin(angle) * p[x] / q : 0);
        size += u[x] * u[x];
    }
    size = sqrt(size);
    for (int x = 0; x < 3; ++x) u[x] /= size;
}

static void next_direction(chain_kind kind, random_stream *s, int64_t k, double u[3])
{
    const double degree = 3.14159265358979323846 / 180;
    switch (kind) {
        case CHAIN_STRAIGHT:
            u[0] = 1;
            u[1] = u[2] = 0;
            return;
        case CHAIN_LATTICE:
            u[0] = u[1] = u[2] = 0;
            u[k % 3] = random_bits(s) & 1 ? 1 : -1;
            return;
        case CHAIN_NEARLY_STRAIGHT:
        case CHAIN_OFFSET_1E6:
            if (k == 0) break;
            turn(s, u, 5 * degree * random_uniform(s));
            return;
        case CHAIN_ROD_MASSES_1E9:
            u[0] = 0.31;
            u[1] = 0.52;
            u[2] = sqrt(1 - u[0] * u[0] - u[1] * u[1]);
            return;
        case CHAIN_TAUT:
            if (k == 0) break;
            turn(s, u, 1e-5 * random_uniform(s));
            return;
        case CHAIN_FOLDED:
            if (k == 0) break;
            for (int x = 0; x < 3; ++x) u[x] = -u[x];
            turn(s, u, 1e-3 * random_uniform(s));
            return;
        default:
            break;
    }
    random_direction(s, u);
}

static double bond_length(chain_kind kind, random_stream *s, int64_t k)
{
    if (kind == CHAIN_BOND_RATIO_1E6) return k % 2 ? 1 : 1e-6;
    if (kind == CHAIN_HETEROGENEOUS) return 0.7 + 0.8 * random_uniform(s);
    return 1;
}

static double atom_mass(chain_kind kind, random_stream *s, int64_t i, int64_t n_bonds)
{
    if ((kind == CHAIN_FIXED_ENDS || kind == CHAIN_TAUT) && (i == 0 || i == n_bonds)) return 0;
    if (kind == CHAIN_HETEROGENEOUS) return pow(10, 2 * random_uniform(s) - 1);
    if (kind == CHAIN_MASSES_1E3) return i % 2 ? 1 : 1e3;
    if (kind == CHAIN_MASSES_1E6) return i % 2 ? 1 : 1e6;
    if (kind == CHAIN_ROD_MASSES_1E9) return i % 2 ? 1 : 1e9;
    return 1;
}

chain chain_make(chain_kind kind, int64_t n_bonds, uint64_t seed)
{
    random_stream s = random_seed(seed * 64 + (uint64_t)kind);
    const size_t n = (size_t)n_bonds, atoms = n + 1;
    double *memory = calloc(atoms + n + 9 * atoms, sizeof *memory);
    if (!memory) abort();
    chain c = {n_bonds, memory, memory + atoms, memory + atoms + n, 0, 0};
    c.v = c.r + 3 * atoms;
    c.f = c.v + 3 * atoms;
    if (kind == CHAIN_OFFSET_1E6)
        for (int x = 0; x < 3; ++x) c.r[x] = 1e6 * (x + 1);
    double u[3] = {1, 0, 0};
    for (size_t k = 0; k < n; ++k) {
        const double a = bond_length(kind, &s, (int64_t)k);
        double q = 0;
        next_direction(kind, &s, (int64_t)k, u);
        for (size_t x = 0; x < 3; ++x) {
            c.r[3 * k + 3 + x] = c.r[3 * k + x] + a * u[x];
            const double d = c.r[3 * k + 3 + x] - c.r[3 * k + x];
            q += d * d;
        }
        c.length[k] = sqrt(q);
    }
    for (size_t i = 0; i < atoms; ++i) {
        c.mass[i] = atom_mass(kind, &s, (int64_t)i, n_bonds);
        const double root = sqrt(c.mass[i]);
        for (size_t x = 0; x < 3; ++x) {
            const double nv = random_normal(&s), nf = random_normal(&s);
            c.v[3 * i + x] = root > 0 ? nv / root : 0;
            c.f[3 * i + x] = root > 0 ? nf * root : nf;
        }
    }
    return c;
}

void chain_free(chain *c)
{
    free(c->mass);
    c->mass = c->length = c->r = c->v = c->f = 0;
}
