#include "mixture.h"

#include "check.h"
#include "random.h"

static void *room_for(size_t bytes)
{
    void *p = calloc(bytes + 1, 1);
    if (!p) abort();
    return p;
}

static void swap(int64_t *a, int64_t *b)
{
    const int64_t c = *a;
    *a = *b;
    *b = c;
}

static void shuffle(int64_t *list, int64_t n, random_stream *s)
{
    for (int64_t i = n - 1; i > 0; --i) swap(list + i, list + random_integer(s, 0, i));
}

/** Which part each atom belongs to; n_parts for none. */
static int64_t *owners(const molecule *parts, mixture *m, mixing how, random_stream *s)
{
    const int64_t gap = how == MIXED ? 7 : 0;
    m->n_atoms = m->first_atom[m->n_parts] + gap;
    int64_t *owner = room_for(sizeof *owner * (size_t)m->n_atoms), i = 0;
    for (int64_t p = 0; p < m->n_parts; ++p)
        for (int64_t k = 0; k < parts[p].n_atoms; ++k) owner[i++] = p;
    while (i < m->n_atoms) owner[i++] = m->n_parts;
    if (how == MIXED) shuffle(owner, m->n_atoms, s);
    return owner;
}

static void place_atoms(mixture *m, const int64_t *owner)
{
    int64_t *next = room_for(sizeof *next * (size_t)(m->n_parts + 1));
    for (int64_t i = 0; i < m->n_atoms; ++i) {
        m->mass[i] = 1;
        for (int x = 0; x < 3; ++x) m->r[3 * i + x] = m->v[3 * i + x] = m->f[3 * i + x] = NAN;
        if (owner[i] == m->n_parts) continue;
        const molecule *part = m->parts + owner[i];
        const int64_t k = next[owner[i]]++;
        m->atoms[m->first_atom[owner[i]] + k] = i;
        m->mass[i] = part->mass[k];
        for (int x = 0; x < 3; ++x) {
            m->r[3 * i + x] = part->r[3 * k + x];
            m->v[3 * i + x] = part->v[3 * k + x];
            m->f[3 * i + x] = part->f[3 * k + x];
        }
    }
    free(next);
}

static void place_bonds(mixture *m, mixing how, random_stream *s)
{
    int64_t *place = room_for(sizeof *place * (size_t)m->n_bonds);
    for (int64_t k = 0; k < m->n_bonds; ++k) place[k] = k;
    if (how == MIXED) shuffle(place, m->n_bonds, s);
    for (int64_t p = 0; p < m->n_parts; ++p)
        for (int64_t k = 0; k < m->parts[p].n_bonds; ++k) {
            const int64_t at = place[m->first_bond[p] + k];
            m->bonds[m->first_bond[p] + k] = at;
            m->length[at] = m->parts[p].length[k];
            for (int e = 0; e < 2; ++e)
                m->pairs[2 * at + e] = m->atoms[m->first_atom[p] + m->parts[p].pairs[2 * k + e]];
            if (how == MIXED && random_bits(s) & 1) swap(m->pairs + 2 * at, m->pairs + 2 * at + 1);
        }
    free(place);
}

mixture mixture_make(const molecule *parts, int64_t n_parts, mixing how, uint64_t seed)
{
    mixture m;
    memset(&m, 0, sizeof m);
    random_stream s = random_seed(seed);
    m.n_parts = n_parts;
    m.parts = room_for(sizeof *m.parts * (size_t)n_parts);
    m.first_atom = room_for(sizeof *m.first_atom * (size_t)(n_parts + 1));
    m.first_bond = room_for(sizeof *m.first_bond * (size_t)(n_parts + 1));
    for (int64_t p = 0; p < n_parts; ++p) {
        m.parts[p] = molecule_copy(parts + p);
        m.first_atom[p + 1] = m.first_atom[p] + parts[p].n_atoms;
        m.first_bond[p + 1] = m.first_bond[p] + parts[p].n_bonds;
    }
    m.n_bonds = m.first_bond[n_parts];
    int64_t *owner = owners(parts, &m, how, &s);
    const size_t atoms = (size_t)m.n_atoms, bonds = (size_t)m.n_bonds;
    m.atoms = room_for(sizeof *m.atoms * atoms);
    m.bonds = room_for(sizeof *m.bonds * bonds);
    m.pairs = room_for(sizeof *m.pairs * 2 * bonds);
    m.mass = room_for(sizeof *m.mass * atoms);
    m.length = room_for(sizeof *m.length * bonds);
    m.r = room_for(sizeof *m.r * 3 * atoms);
    m.v = room_for(sizeof *m.v * 3 * atoms);
    m.f = room_for(sizeof *m.f * 3 * atoms);
    place_atoms(&m, owner);
    place_bonds(&m, how, &s);
    free(owner);
    CHECK(hol_chains_create(m.n_atoms, m.mass, &m.chains));
    CHECK(hol_chains_add_bonds(m.chains, m.n_bonds, m.pairs, m.length));
    return m;
}

mixture mixture_of_all(int64_t each, mixing how, uint64_t seed)
{
    const int64_t n = each * MOLECULE_GOOD_KINDS;
    molecule *parts = room_for(sizeof *parts * (size_t)n);
    for (int64_t p = 0; p < n; ++p) {
        const molecule_kind kind = (molecule_kind)(p % MOLECULE_GOOD_KINDS);
        const int64_t more = p / MOLECULE_GOOD_KINDS;
        const int64_t size = kind == MOLECULE_DENDRIMER || kind == MOLECULE_PEPTIDE ? 1 + more % 2 : 4 + 3 * more;
        parts[p] = molecule_make(kind, size, seed + (uint64_t)p);
    }
    mixture m = mixture_make(parts, n, how, seed);
    for (int64_t p = 0; p < n; ++p) molecule_free(parts + p);
    free(parts);
    return m;
}

mixture mixture_of_kind(molecule_kind kind, int64_t n, int64_t low, int64_t high, mixing how, uint64_t seed)
{
    molecule *parts = room_for(sizeof *parts * (size_t)n);
    for (int64_t p = 0; p < n; ++p) parts[p] = molecule_make(kind, low + p % (high - low + 1), seed + (uint64_t)p);
    mixture m = mixture_make(parts, n, how, seed);
    for (int64_t p = 0; p < n; ++p) molecule_free(parts + p);
    free(parts);
    return m;
}

size_t mixture_size(const mixture *m)
{
    return 3 * (size_t)m->n_atoms;
}

void mixture_take(const mixture *m, int64_t part, const double *per_atom, double *out)
{
    for (int64_t i = m->first_atom[part]; i < m->first_atom[part + 1]; ++i)
        for (int x = 0; x < 3; ++x) *out++ = per_atom[3 * m->atoms[i] + x];
}

void mixture_take_bonds(const mixture *m, int64_t part, const double *per_bond, double *out)
{
    for (int64_t k = m->first_bond[part]; k < m->first_bond[part + 1]; ++k) *out++ = per_bond[m->bonds[k]];
}

double *mixture_drifted(const mixture *m, double dt)
{
    double *r = copy_of(m->r, mixture_size(m));
    for (size_t i = 0; i < mixture_size(m); ++i) r[i] += dt * m->v[i];
    return r;
}

void mixture_free(mixture *m)
{
    for (int64_t p = 0; p < m->n_parts; ++p) molecule_free(m->parts + p);
    hol_chains_destroy(m->chains);
    free(m->parts), free(m->first_atom), free(m->first_bond), free(m->atoms), free(m->bonds), free(m->pairs);
    free(m->mass), free(m->length), free(m->r), free(m->v), free(m->f);
}
