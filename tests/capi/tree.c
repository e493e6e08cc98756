#include "tree.h"

#include "check.h"

static tree sapling(int64_t most_atoms, uint64_t seed)
{
    const size_t n = (size_t)most_atoms;
    tree t;
    memset(&t, 0, sizeof t);
    t.pairs = malloc(2 * n * sizeof *t.pairs), t.end = malloc(n * sizeof *t.end);
    t.neighbours = calloc(n, sizeof *t.neighbours);
    t.mass = untouched(n), t.length = untouched(n);
    t.r = untouched(3 * n), t.v = untouched(3 * n), t.f = untouched(3 * n);
    t.stream = random_seed(seed);
    return t;
}

void tree_fell(tree *t)
{
    free(t->pairs), free(t->end), free(t->neighbours), free(t->mass), free(t->length);
    free(t->r), free(t->v), free(t->f);
}

static void put_atom(tree *t, int64_t i, const double *r)
{
    t->mass[i] = pow(10, random_uniform(&t->stream));
    for (int c = 0; c < 3; ++c) {
        t->r[3 * i + c] = r[c];
        t->v[3 * i + c] = random_normal(&t->stream);
        t->f[3 * i + c] = random_normal(&t->stream);
    }
}

static void put_bond(tree *t, int64_t i, int64_t j)
{
    t->pairs[2 * t->n_bonds] = i, t->pairs[2 * t->n_bonds + 1] = j;
    t->length[t->n_bonds++] = 1;
}

/** An arm of n bonds from any end; with the first number at its far end if `inwards`. Each bond is turned by `bend` at
 * the most; above 1: anywhere. */
static void grow(tree *t, int64_t n, int inwards, double bend)
{
    if (t->n_atoms == 0) {
        put_atom(t, 0, (const double[]){0, 0, 0});
        t->n_atoms = t->n_ends = 1;
        t->end[0] = 0;
    }
    int64_t from;
    do from = random_integer(&t->stream, 0, t->n_ends - 1);
    while (t->neighbours[from] > 3);
    ++t->neighbours[from];
    int64_t last = t->end[from];
    double u[3], r[3];
    random_direction(&t->stream, u);
    for (int64_t k = 0; k < n; ++k) {
        const int64_t i = t->n_atoms + (inwards ? n - 1 - k : k);
        double turn[3], size = 0;
        random_direction(&t->stream, turn);
        for (int c = 0; c < 3; ++c) u[c] = bend > 1 ? turn[c] : u[c] + bend * turn[c], size += u[c] * u[c];
        for (int c = 0; c < 3; ++c) u[c] /= sqrt(size), r[c] = t->r[3 * last + c] + u[c];
        put_atom(t, i, r);
        put_bond(t, last, i);
        last = i;
    }
    t->n_atoms += n;
    t->end[t->n_ends] = last, t->neighbours[t->n_ends++] = 1;
}

hol_chains *tree_chains(const tree *t)
{
    hol_chains *chains = NULL;
    CHECK(hol_chains_create(t->n_atoms, t->mass, &chains));
    CHECK(hol_chains_add_bonds(chains, t->n_bonds, t->pairs, t->length));
    assert_int_equal(hol_chains_n_chains(chains), 1);
    assert_int_equal(hol_chains_n_of_shape(chains, HOL_SHAPE_TREE), 1);
    return chains;
}

tree tree_of_lengths(int64_t first, int64_t last, double bend)
{
    tree t = sapling((last - first + 1) * (first + last) + 1, (uint64_t)first);
    for (int64_t n = first; n <= last; ++n)
        for (int inwards = 0; inwards < 2; ++inwards) grow(&t, n, inwards, bend);
    return t;
}

tree tree_mixed(int64_t n)
{
    tree t = sapling(2 * (n + 1500), 7);
    for (int i = 0; t.n_atoms < n; ++i) {
        const double bend[] = {2, 1e-3, 2, 0.2, 1e-7};
        grow(&t, random_integer(&t.stream, 70, 700), i % 2, bend[i % 5]);
        if (i % 7 == 3) t.neighbours[t.n_ends - 1] = 4; /* nothing else grows there */
    }
    for (int64_t e = 1; e < t.n_ends; ++e)
        if (e % 7 == 4) {
            const int64_t i = t.end[e];
            t.mass[i] = 0;
            for (int c = 0; c < 3; ++c) t.v[3 * i + c] = 0;
        }
    return t;
}
