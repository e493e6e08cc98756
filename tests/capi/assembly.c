#include "assembly.h"

#include "check.h"
#include "random.h"

static double *doubles(int64_t n)
{
    double *p = calloc((size_t)n + 1, sizeof *p);
    if (!p) abort();
    return p;
}

static int64_t *integers(int64_t n)
{
    int64_t *p = calloc((size_t)n + 1, sizeof *p);
    if (!p) abort();
    return p;
}

/** Gives every atom of the chains its number in the arrays. */
static void number_atoms(assembly *a, int64_t used, arrangement how, uint64_t seed)
{
    random_stream s = random_seed(seed);
    int64_t *all = integers(a->n_atoms);
    for (int64_t i = 0; i < a->n_atoms; ++i) all[i] = i;
    if (how == SCATTERED)
        for (int64_t i = a->n_atoms - 1; i > 0; --i) {
            const int64_t j = random_integer(&s, 0, i), t = all[i];
            all[i] = all[j];
            all[j] = t;
        }
    memcpy(a->atoms, all, sizeof *all * (size_t)used);
    free(all);
}

assembly assembly_make(const chain *parts, int64_t n_parts, arrangement how, uint64_t seed)
{
    assembly a;
    memset(&a, 0, sizeof a);
    int64_t used = 0;
    a.n_chains = n_parts;
    a.first_bond = integers(n_parts + 1);
    a.first = integers(n_parts);
    for (int64_t c = 0; c < n_parts; ++c) {
        a.first[c] = used;
        a.first_bond[c + 1] = a.first_bond[c] + parts[c].n_bonds;
        used += parts[c].n_bonds + 1;
    }
    a.n_bonds = a.first_bond[n_parts];
    a.n_atoms = how == SCATTERED ? used + used / 4 + 3 : used;
    a.atoms = integers(used);
    a.mass = doubles(a.n_atoms);
    a.length = doubles(a.n_bonds);
    a.r = doubles(3 * a.n_atoms);
    a.v = doubles(3 * a.n_atoms);
    a.f = doubles(3 * a.n_atoms);
    for (int64_t i = 0; i < a.n_atoms; ++i) a.mass[i] = 1;
    for (int64_t i = 0; i < 3 * a.n_atoms; ++i) a.r[i] = a.v[i] = a.f[i] = NAN;
    number_atoms(&a, used, how, seed);
    for (int64_t c = 0; c < n_parts; ++c) {
        const int64_t *atoms = a.atoms + a.first[c];
        for (int64_t i = 0; i <= parts[c].n_bonds; ++i) {
            a.mass[atoms[i]] = parts[c].mass[i];
            memcpy(a.r + 3 * atoms[i], parts[c].r + 3 * i, 3 * sizeof(double));
            memcpy(a.v + 3 * atoms[i], parts[c].v + 3 * i, 3 * sizeof(double));
            memcpy(a.f + 3 * atoms[i], parts[c].f + 3 * i, 3 * sizeof(double));
        }
        memcpy(a.length + a.first_bond[c], parts[c].length, sizeof(double) * (size_t)parts[c].n_bonds);
    }
    CHECK(hol_chains_create(a.n_atoms, a.mass, &a.chains));
    for (int64_t c = 0; c < n_parts; ++c)
        CHECK(hol_chains_add(a.chains, parts[c].n_bonds, a.atoms + a.first[c], a.length + a.first_bond[c]));
    return a;
}

assembly assembly_of_kind(chain_kind kind, int64_t n, int64_t low, int64_t high, arrangement how, uint64_t seed)
{
    random_stream s = random_seed(seed);
    chain *parts = calloc((size_t)n + 1, sizeof *parts);
    if (!parts) abort();
    for (int64_t c = 0; c < n; ++c) parts[c] = chain_make(kind, random_integer(&s, low, high), random_bits(&s) >> 8);
    assembly a = assembly_make(parts, n, how, seed + 1);
    for (int64_t c = 0; c < n; ++c) chain_free(parts + c);
    free(parts);
    return a;
}

size_t assembly_size(const assembly *a)
{
    return 3 * (size_t)a->n_atoms;
}

int64_t assembly_bonds(const assembly *a, int64_t c)
{
    return a->first_bond[c + 1] - a->first_bond[c];
}

void assembly_take(const assembly *a, int64_t c, const double *per_atom, double *out)
{
    const int64_t *atoms = a->atoms + a->first[c];
    for (int64_t i = 0; i <= assembly_bonds(a, c); ++i)
        memcpy(out + 3 * i, per_atom + 3 * atoms[i], 3 * sizeof(double));
}

chain assembly_chain(const assembly *a, int64_t c)
{
    chain out = chain_make(CHAIN_STRAIGHT, assembly_bonds(a, c), 1);
    assembly_take(a, c, a->r, out.r);
    assembly_take(a, c, a->v, out.v);
    assembly_take(a, c, a->f, out.f);
    for (int64_t i = 0; i <= out.n_bonds; ++i) out.mass[i] = a->mass[a->atoms[a->first[c] + i]];
    memcpy(out.length, a->length + a->first_bond[c], sizeof(double) * (size_t)out.n_bonds);
    return out;
}

void assembly_free(assembly *a)
{
    hol_chains_destroy(a->chains);
    free(a->first_bond);
    free(a->first);
    free(a->atoms);
    free(a->mass);
    free(a->length);
    free(a->r);
    free(a->v);
    free(a->f);
    memset(a, 0, sizeof *a);
}
