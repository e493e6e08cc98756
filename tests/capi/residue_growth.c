#include "residue_growth.h"

#include "check.h"
#include "molecule_shapes.h"
#include "residue_kind.h"

/** What has grown so far. Of each atom: the direction of the bond to its parent, a normal to it (in a ring towards its
 * middle), how many bonds it has and how many residues or side atoms hang at it. */
typedef struct growth {
    molecule m;
    const residue_recipe *recipe;
    random_stream *random;
    int64_t *residue, *first, *exit; /* of each atom; of each residue */
    int64_t n_residues, room;
    double (*u)[3], (*normal)[3];
    int *bonds, *beside;
} growth;

static const double tetrahedral = 1.2309594173407747; /* acos(1/3) */
static const double pi = 3.14159265358979323846;

/** Into u and a normal that a further turn by the angle goes on with. */
static void turn(const double u[3], const double n[3], double angle, double side, double *to, double *normal)
{
    double quarter[3];
    turned(u, n, angle + pi / 2, 0, quarter);
    turned(u, n, angle, 0, to);
    for (int c = 0; c < 3; ++c) normal[c] = side * quarter[c];
}

/** Where the bond from p to a ring's next atom goes: round the ring, or away from the ring that p is of. */
static void in_ring(growth *g, const residue_kind *k, int a, int64_t p, double *u, double *normal)
{
    const int ring = k->ring[a], before = k->ring[k->parent[a]];
    const double angle = 2 * pi / k->size[ring];
    double n[3];
    if (k->parent[a] == k->closing[ring][0]) {
        unit_normal(g->random, g->u[p], n);
        turn(g->u[p], n, angle / 2 - pi / 2, 1, u, normal);
    } else {
        turn(g->u[p], g->normal[p], before == ring ? angle : -angle, before == ring ? 1 : -1, u, normal);
    }
}

/** Where a bond from p goes that is of no ring. `here`: p in its kind; `straight`: along the backbone. */
static void out_of_ring(growth *g, const residue_kind *k, int here, int64_t p, int straight, double *u)
{
    const int beside = g->beside[p]++, ring = k->ring[here];
    double out[3], normal[3];
    if (straight && g->recipe->bend > 0) {
        turned(g->u[p], g->normal[p], g->recipe->bend, 2 * pi * random_uniform(g->random), u);
    } else if (ring < 0 || beside >= k->sides[here]) {
        turned(g->u[p], g->normal[p], tetrahedral, 2 * pi / 3 * beside, u);
    } else {
        turn(g->u[p], g->normal[p], pi / k->size[ring] - pi / 2, 1, out, normal);
        turned(out, normal, k->sides[here] > 1 ? (beside ? -0.95 : 0.95) : 0, pi / 2, u);
    }
}

static double mass_of(growth *g, const char *text, int a, char element)
{
    const double decades = g->recipe->decades;
    if (decades < 0) return residue_mass(element) * pow(10, -decades * (2 * random_uniform(g->random) - 1));
    random_stream of_kind = random_seed((uint64_t)a * 1000 + (uint64_t)(unsigned char)text[3] + 7 * strlen(text));
    return residue_mass(element) * pow(10, decades * (2 * random_uniform(&of_kind) - 1));
}

static void make_room(growth *g)
{
    if (g->m.n_atoms + RESIDUE_ATOMS < g->room) return;
    g->room = 2 * g->room + 4 * RESIDUE_ATOMS;
    const size_t n = (size_t)g->room;
    g->residue = realloc(g->residue, n * sizeof *g->residue);
    g->first = realloc(g->first, n * sizeof *g->first);
    g->exit = realloc(g->exit, n * sizeof *g->exit);
    g->u = realloc(g->u, n * sizeof *g->u);
    g->normal = realloc(g->normal, n * sizeof *g->normal);
    g->bonds = realloc(g->bonds, n * sizeof *g->bonds);
    g->beside = realloc(g->beside, n * sizeof *g->beside);
    if (!g->residue || !g->first || !g->exit || !g->u || !g->normal || !g->bonds || !g->beside) abort();
}

static void join(growth *g, int64_t i, int64_t j)
{
    molecule_add_bond(&g->m, i, j);
    ++g->bonds[i], ++g->bonds[j];
}

/** A residue at an atom of another one, which is `here` in that one's kind; at -1: the first. */
static void add_residue(growth *g, const char *text, int64_t at, const residue_kind *of_at)
{
    const residue_kind k = residue_kind_of(text);
    make_room(g);
    const int64_t first = g->first[g->n_residues] = g->m.n_atoms;
    for (int a = 0; a < k.n_atoms; ++a) {
        const int64_t p = a > 0 ? first + k.parent[a] : at, i = g->m.n_atoms;
        double r[3] = {0};
        if (p < 0)
            random_direction(g->random, g->u[i]);
        else if (k.ring[a] >= 0)
            in_ring(g, &k, a, p, g->u[i], g->normal[i]);
        else if (a > 0)
            out_of_ring(g, &k, k.parent[a], p, k.backbone[a], g->u[i]);
        else
            out_of_ring(g, of_at, (int)(p - g->first[g->residue[p]]), p, 1, g->u[i]);
        if (p < 0 || k.ring[a] < 0) unit_normal(g->random, g->u[i], g->normal[i]);
        const double length = k.element[a] == 'H' ? 1.05 : k.ring[a] >= 0 ? 1.4 : 1.5;
        for (int c = 0; c < 3 && p >= 0; ++c) r[c] = g->m.r[3 * p + c] + length * g->u[i][c];
        molecule_add_atom(&g->m, mass_of(g, text, a, k.element[a]), r);
        g->residue[i] = g->n_residues;
        g->bonds[i] = g->beside[i] = 0;
        if (p >= 0) join(g, p, i);
    }
    for (int ring = 0; ring < k.n_rings; ++ring) join(g, first + k.closing[ring][0], first + k.closing[ring][1]);
    const int isotopes = g->recipe->isotopes;
    if (isotopes && random_integer(g->random, 1, isotopes) == 1) g->m.mass[first] *= 2;
    g->exit[g->n_residues++] = first + k.exit;
    g->first[g->n_residues] = g->m.n_atoms;
}

/** An atom of a residue that is no end and has fewer than so many bonds; -1 if there is none. */
static int64_t free_atom(growth *g, int64_t residue, int most)
{
    const int64_t first = g->first[residue], n = g->first[residue + 1] - first;
    for (int64_t start = random_integer(g->random, 0, n - 1), step = 0; step < n; ++step) {
        const int64_t i = first + (start + step) % n;
        if (g->bonds[i] > 1 && g->bonds[i] < most) return i;
    }
    return -1;
}

/** The atom that the next residue hangs at: one beside, or where there is none the end of the residue before. */
static int64_t next_place(growth *g)
{
    const int64_t k = g->n_residues;
    int64_t beside = -1;
    if (k == 0) return -1;
    if (g->recipe->order == RESIDUES_AS_COMB && k % 4 == 0) return g->exit[k - 4];
    if (g->recipe->order == RESIDUES_AS_COMB && k % 4 == 1) beside = free_atom(g, k - 1, 5);
    if (g->recipe->order == RESIDUES_AS_STAR && k % 10 == 1) beside = free_atom(g, 0, 12);
    if (g->recipe->order == RESIDUES_AS_TREE) beside = free_atom(g, random_integer(g->random, 0, k - 1), 5);
    return beside >= 0 ? beside : g->exit[k - 1];
}

/** A kind that no other residue is of: a side chain with as many atoms as its number says. */
static void write_own_kind(int64_t number, char *text)
{
    strcpy(text, number % 3 ? "NHCH(" : "CHHCH(");
    for (int64_t n = number % 7; n > 0; --n) strcat(text, "CHH");
    for (int64_t n = number / 7 % 7; n > 0; --n) strcat(text, "O");
    strcat(text, number % 2 ? "C1CHCHCHCHCH1)" : "CHHH)");
    for (int64_t n = number / 49 % 3; n >= 0; --n) strcat(text, "C(O)");
}

static int bonded(const molecule *m, int64_t i, int64_t j)
{
    for (int64_t k = 0; k < m->n_bonds; ++k)
        if ((m->pairs[2 * k] == i && m->pairs[2 * k + 1] == j) || (m->pairs[2 * k] == j && m->pairs[2 * k + 1] == i))
            return 1;
    return 0;
}

static void add_bridges(growth *g)
{
    const int64_t n = g->n_residues;
    for (int b = 0; b < g->recipe->bridges;) {
        const int64_t one = random_integer(g->random, 0, n - 1), other = random_integer(g->random, 0, n - 1);
        if (llabs(one - other) < 3) continue;
        const int64_t i = free_atom(g, one, 5), j = free_atom(g, other, 5);
        if (i >= 0 && j >= 0 && !bonded(&g->m, i, j)) join(g, i, j), ++b;
    }
    if (g->recipe->closed && !bonded(&g->m, g->exit[n - 1], g->first[0])) join(g, g->exit[n - 1], g->first[0]);
}

/** The last end atom of some residues, and atoms where others end. */
static void hold_fixed(growth *g)
{
    const int64_t n = g->n_residues;
    for (int x = 0; x < g->recipe->fixed + g->recipe->fixed_backbone; ++x) {
        const int64_t k = n * (x + 1) / (g->recipe->fixed + g->recipe->fixed_backbone + 1);
        int64_t i = g->exit[k];
        if (x < g->recipe->fixed)
            for (i = g->first[k + 1] - 1; g->bonds[i] > 1;) --i;
        g->m.mass[i] = 0;
    }
}

molecule residues_grow(const residue_recipe *recipe, int64_t n_bonds, random_stream *random, int64_t **residue)
{
    growth g;
    residue_kind before;
    char own[RESIDUE_ATOMS];
    memset(&g, 0, sizeof g);
    g.m = molecule_empty(), g.recipe = recipe, g.random = random;
    const char **texts = calloc((size_t)n_bonds + 2, sizeof *texts);
    for (int last = 0; !last;) {
        last = g.m.n_bonds >= n_bonds - 10;
        const int64_t at = next_place(&g),
                      kind = recipe->n_kinds > 0 ? random_integer(random, 0, recipe->n_kinds - 1) : 0;
        const char *text = recipe->n_kinds > 0 ? residue_texts[recipe->first_kind + kind] : own;
        if (recipe->n_kinds == 0) write_own_kind(g.n_residues, own);
        if (recipe->caps && last) text = "NHCHHH";
        if (recipe->caps && g.n_residues == 0) text = "CHHHC(O)";
        if (at >= 0 && recipe->n_kinds > 0) before = residue_kind_of(texts[g.residue[at]]);
        add_residue(&g, text, at, &before);
        texts[g.n_residues - 1] = text;
        if (recipe->n_kinds == 0) before = residue_kind_of(text);
    }
    add_bridges(&g);
    hold_fixed(&g);
    *residue = g.residue;
    free(texts), free(g.first), free(g.exit), free(g.u), free(g.normal), free(g.bonds), free(g.beside);
    return g.m;
}
