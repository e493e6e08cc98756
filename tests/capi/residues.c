#include "residues.h"

#include "check.h"
#include "equations.h"
#include "residue_growth.h"

const residue_recipe residue_recipes[RESIDUE_RECIPES] = {
    [RANDOM_SEQUENCE] = {.name = "random sequence", .n_kinds = 12},
    [RINGED_HOMOPOLYMER] = {.name = "homopolymer, a ring in each", .first_kind = 2, .n_kinds = 1},
    [SHORT_HOMOPOLYMER] = {.name = "homopolymer of three atoms", .first_kind = 10, .n_kinds = 1},
    [SUGARS] = {.name = "homopolymer, rings through the backbone", .first_kind = 8, .n_kinds = 1, .caps = 1},
    [PROLINES] = {.name = "rings through the backbone beside others", .first_kind = 2, .n_kinds = 4},
    [BRIDGES] = {.name = "bridges", .n_kinds = 9, .bridges = 6, .caps = 1},
    [CLOSED] = {.name = "closed, with bridges", .n_kinds = 12, .bridges = 3, .closed = 1},
    [COMB] = {.name = "comb", .n_kinds = 12, .order = RESIDUES_AS_COMB},
    [STAR] = {.name = "star", .n_kinds = 8, .order = RESIDUES_AS_STAR, .bridges = 2},
    [TREE] = {.name = "tree of residues", .n_kinds = 11, .order = RESIDUES_AS_TREE},
    [OWN_KINDS] = {.name = "each of its own kind", .n_kinds = 0, .caps = 1},
    [FIXED_ENDS] = {.name = "fixed ends", .n_kinds = 8, .fixed = 5},
    [FIXED_BACKBONE] = {.name = "fixed atoms in the backbone", .n_kinds = 8, .fixed = 2, .fixed_backbone = 3},
    [SHUFFLED] = {.name = "shuffled bonds", .n_kinds = 12, .bridges = 2, .shuffled = 1},
    [SCATTERED_ATOMS] =
        {.name = "scattered atoms", .n_kinds = 12, .bridges = 2, .numbers = NUMBERS_ANYHOW, .shuffled = 1},
    [BACKWARDS] = {.name = "numbered backwards", .n_kinds = 12, .bridges = 2, .numbers = NUMBERS_BACK},
    [ANY_ORDER] = {.name = "residues in any order", .n_kinds = 9, .numbers = NUMBERS_OF_RESIDUES, .shuffled = 1},
    [ISOTOPES] = {.name = "tree of homopolymers, isotopes",
                  .first_kind = 2,
                  .n_kinds = 1,
                  .order = RESIDUES_AS_TREE,
                  .isotopes = 3},
    [IN_BOX] = {.name = "orthorhombic box", .n_kinds = 12, .box = ORTHORHOMBIC_BOX},
    [IN_TRICLINIC_BOX] = {.name = "comb in a triclinic box",
                          .n_kinds = 12,
                          .order = RESIDUES_AS_COMB,
                          .box = TRICLINIC_BOX},
    [FAR_AWAY] = {.name = "far from the origin", .n_kinds = 12, .offset = 1e5},
    [UNEQUAL_KINDS] = {.name = "unequal masses of each kind", .n_kinds = 12, .decades = 3, .caps = 1},
    [UNEQUAL_ATOMS] = {.name = "unequal masses of each atom, bridges", .n_kinds = 12, .decades = -3, .bridges = 3},
    [STRAIGHT] = {.name = "nearly straight backbone", .n_kinds = 8, .bend = 1e-3, .offset = 10},
    [STRAIGHT_UNEQUAL] = {.name = "straight and unequal", .n_kinds = 12, .bend = 1e-5, .decades = 2},
};

static int64_t *random_order(int64_t n, random_stream *random)
{
    int64_t *order = malloc((size_t)n * sizeof *order);
    for (int64_t i = 0; i < n; ++i) order[i] = i;
    for (int64_t i = n - 1; i > 0; --i) {
        const int64_t j = random_integer(random, 0, i), kept = order[i];
        order[i] = order[j], order[j] = kept;
    }
    return order;
}

/** The new number of each atom. */
static int64_t *make_numbers(const residues *s, random_stream *random)
{
    const int64_t n = s->m.n_atoms, whole = s->recipe->numbers == NUMBERS_OF_RESIDUES;
    if (s->recipe->numbers == NUMBERS_ANYHOW) return random_order(n, random);
    int64_t *number = malloc((size_t)n * sizeof *number), *order = random_order(s->residue[n - 1] + 1, random);
    int64_t next = 0;
    for (int64_t i = 0; i < n; ++i) number[i] = n - 1 - i;
    for (int64_t k = 0; whole && k <= s->residue[n - 1]; ++k)
        for (int64_t i = 0; i < n; ++i)
            if (s->residue[i] == order[k]) number[i] = next++;
    free(order);
    return number;
}

/** Atom i becomes number[i]. */
static void renumber(residues *s, const int64_t *number)
{
    molecule *m = &s->m;
    double *mass = copy_of(m->mass, (size_t)m->n_atoms), *r = copy_of(m->r, 3 * (size_t)m->n_atoms);
    int64_t *residue = malloc((size_t)m->n_atoms * sizeof *residue);
    memcpy(residue, s->residue, (size_t)m->n_atoms * sizeof *residue);
    for (int64_t i = 0; i < m->n_atoms; ++i) {
        m->mass[number[i]] = mass[i];
        s->residue[number[i]] = residue[i];
        memcpy(m->r + 3 * number[i], r + 3 * i, 3 * sizeof *r);
    }
    for (int64_t e = 0; e < 2 * m->n_bonds; ++e) m->pairs[e] = number[m->pairs[e]];
    free(mass), free(r), free(residue);
}

void residues_shuffle(molecule *m, uint64_t seed, int64_t *place)
{
    random_stream random = random_seed(seed);
    int64_t *order = random_order(m->n_bonds, &random), *pairs = malloc(2 * (size_t)m->n_bonds * sizeof *pairs);
    double *length = copy_of(m->length, (size_t)m->n_bonds);
    memcpy(pairs, m->pairs, 2 * (size_t)m->n_bonds * sizeof *pairs);
    for (int64_t k = 0; k < m->n_bonds; ++k) {
        const int64_t turn = random_integer(&random, 0, 1);
        m->pairs[2 * k] = pairs[2 * order[k] + turn];
        m->pairs[2 * k + 1] = pairs[2 * order[k] + 1 - turn];
        m->length[k] = length[order[k]];
        if (place) place[k] = order[k];
    }
    free(order), free(pairs), free(length);
}

/** Far enough for the longest bond, and each atom in the cell. */
static void wrap(residues *s)
{
    const molecule *m = &s->m;
    double longest = 0;
    for (int64_t k = 0; k < m->n_bonds; ++k) longest = fmax(longest, m->length[k]);
    const double side = fmax(9, 3 * longest), skewed = s->recipe->box == TRICLINIC_BOX;
    const double box[9] = {
        side, 0, 0, skewed * 0.3 * side, 1.1 * side, 0, -0.2 * skewed * side, 0.4 * skewed * side, 0.9 * side};
    memcpy(s->box, box, sizeof box);
    for (int64_t i = 0; i < m->n_atoms; ++i)
        for (int h = 2; h >= 0; --h) {
            const double cells = floor(m->r[3 * i + h] / box[4 * h]);
            for (int c = 0; c <= h; ++c) m->r[3 * i + c] -= cells * box[3 * h + c];
        }
}

const double *residues_box(const residues *s)
{
    return s->recipe->box == NO_BOX ? NULL : s->box;
}

/** Lengths of the bonds as they stand, each an image, to nine digits, so that bonds of a kind have the same; where
 * atoms have masses of their own, to all of theirs. */
static void measure(residues *s)
{
    for (int64_t k = 0; k < s->m.n_bonds; ++k) {
        long double d[3], square = 0;
        bond_in_box(s->m.r, s->m.pairs + 2 * k, residues_box(s), d);
        for (int c = 0; c < 3; ++c) square += d[c] * d[c];
        const double length = (double)sqrtl(square);
        s->m.length[k] = s->recipe->decades < 0 ? length : round(length * 1e9) / 1e9;
    }
}

residues residues_make(const residue_recipe *recipe, int64_t n_bonds, uint64_t seed)
{
    random_stream random = random_seed(seed);
    residues s;
    memset(&s, 0, sizeof s);
    s.recipe = recipe;
    s.m = residues_grow(recipe, n_bonds, &random, &s.residue);
    for (int64_t i = 0; i < 3 * s.m.n_atoms; ++i) s.m.r[i] += recipe->offset * (double)(i % 3 + 1);
    if (recipe->numbers != NUMBERS_ALONG) {
        int64_t *number = make_numbers(&s, &random);
        renumber(&s, number);
        free(number);
    }
    for (int64_t i = 0; i < s.m.n_atoms; ++i) s.m.inverse_mass[i] = s.m.mass[i] > 0 ? 1 / s.m.mass[i] : 0;
    molecule_finish(&s.m, &random);
    if (recipe->box != NO_BOX) wrap(&s);
    measure(&s);
    if (recipe->shuffled) residues_shuffle(&s.m, seed + 1, NULL);
    s.chains = residue_chains(&s.m, residues_box(&s));
    s.n_molecules = hol_chains_n_molecules(s.chains);
    assert_true(recipe->fixed_backbone ? s.n_molecules > 1 : s.n_molecules == 1);
    return s;
}

hol_chains *residue_chains(const molecule *m, const double *box)
{
    hol_chains *chains = NULL;
    CHECK(hol_chains_create(m->n_atoms, m->mass, &chains));
    CHECK(hol_chains_set_box(chains, box));
    CHECK(hol_chains_add_bonds(chains, m->n_bonds, m->pairs, m->length));
    return chains;
}

void residues_free(residues *s)
{
    hol_chains_destroy(s->chains);
    molecule_free(&s->m);
    free(s->residue);
}

int residues_link(const residues *s, int64_t bond)
{
    return s->residue[s->m.pairs[2 * bond]] != s->residue[s->m.pairs[2 * bond + 1]];
}

void residues_project(residues *s)
{
    CHECK(hol_project_velocities(s->chains, s->m.r, s->m.v, NULL, NULL));
}

double residues_step(const residues *s, double part)
{
    double dt = HUGE_VAL;
    for (int64_t k = 0; k < s->m.n_bonds; ++k) {
        double square = 0;
        for (int c = 0; c < 3; ++c)
            square += pow(s->m.v[3 * s->m.pairs[2 * k + 1] + c] - s->m.v[3 * s->m.pairs[2 * k] + c], 2);
        if (square > 0) dt = fmin(dt, part * s->m.length[k] / sqrt(square));
    }
    return dt;
}
