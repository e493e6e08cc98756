/*
 * What the messages of positions that can't be projected, and of bonds that depend on each other, say: the bond that is
 * farthest off, its atoms, the length wanted, those in the reference and in the trial, and whether a box is set.
 */
#include "check.h"

enum { N_MOLECULES = 3, MOST_ATOMS = 6, BAD = 1 };

/* Flat molecules of unequal bonds. An atom lifted out of the plane can't be brought back along bonds that lie in it. */
typedef struct flat {
    const char *name;
    int64_t n_atoms, n_bonds, lifted, pairs[12];
    double xy[2 * MOST_ATOMS];
} flat;

static const flat shapes[] = {
    {"one bond", 2, 1, 1, {0, 1}, {0, 0, 1.1, 0}},
    {"two bonds", 3, 2, 2, {0, 1, 1, 2}, {0, 0, 1, 0.1, 1.2, 1.3}},
    {"linear", 5, 4, 2, {0, 1, 1, 2, 2, 3, 3, 4}, {0, 0, 1, 0.1, 1.2, 1.3, 2.1, 1.9, 2.2, 3.1}},
    {"star", 4, 3, 2, {0, 1, 0, 2, 0, 3}, {0, 0, 1, 0.1, -0.7, 0.9, 0.2, -1.3}},
    {"tree", 6, 5, 4, {0, 1, 1, 2, 1, 3, 3, 4, 3, 5}, {0, 0, 1, 0.1, 1.2, 1.3, 2.1, -0.4, 2.9, 0.5, 2.4, -1.6}},
    {"water", 3, 3, 1, {0, 1, 0, 2, 1, 2}, {0, 0, 1, 0.1, -0.3, 0.9}},
    {"ring", 5, 5, 3, {0, 1, 1, 2, 2, 3, 3, 4, 0, 4}, {0, 0, 1.1, 0, 1.4, 1, 0.5, 1.8, -0.4, 1}},
    {"two triangles", 4, 5, 3, {0, 1, 0, 2, 1, 2, 1, 3, 2, 3}, {0, 0, 1, 0.1, 0.4, 0.9, 1.5, 1.2}},
};
enum { N_SHAPES = sizeof shapes / sizeof *shapes };

typedef struct scene {
    hol_chains *chains;
    int64_t n_atoms;
    double r_ref[3 * N_MOLECULES * MOST_ATOMS], length[12];
} scene;

static double distance(const double *a, const double *b)
{
    double sum = 0;
    for (int c = 0; c < 3; ++c) sum += (b[c] - a[c]) * (b[c] - a[c]);
    return sqrt(sum);
}

static scene scene_of(const flat *shape, int base)
{
    scene s = {NULL, shape->n_atoms * N_MOLECULES, {0}, {0}};
    double mass[N_MOLECULES * MOST_ATOMS];
    int64_t pairs[12];
    for (int64_t i = 0; i < s.n_atoms; ++i) {
        for (int c = 0; c < 2; ++c) s.r_ref[3 * i + c] = shape->xy[2 * (i % shape->n_atoms) + c];
        s.r_ref[3 * i] += 6.0 * (double)(i / shape->n_atoms);
        mass[i] = 1 + 0.2 * (double)(i % shape->n_atoms);
    }
    for (int64_t k = 0; k < 2 * shape->n_bonds; ++k) pairs[k] = shape->pairs[k] + base;
    for (int64_t k = 0; k < shape->n_bonds; ++k)
        s.length[k] = distance(s.r_ref + 3 * shape->pairs[2 * k], s.r_ref + 3 * shape->pairs[2 * k + 1]);
    CHECK(hol_chains_create(s.n_atoms, mass, &s.chains));
    CHECK(hol_chains_set_index_base(s.chains, base));
    CHECK(hol_chains_add_molecules(s.chains, N_MOLECULES, shape->n_atoms, base, shape->n_bonds, pairs, s.length));
    return s;
}

/* The message has the bond of the list with its atoms, and these words. */
static void assert_bond_is_named(const scene *s, const flat *shape, int64_t listed, int base, const char *lengths)
{
    int64_t molecule, bond, bonds[12];
    char atoms[60];
    hol_error_location(&molecule, &bond, NULL, NULL);
    assert_int_equal(molecule, BAD + base);
    CHECK(hol_chains_bonds(s->chains, molecule, bonds));
    assert_in_range(bond, base, shape->n_bonds - 1 + base);
    assert_int_equal(bonds[bond - base], BAD * shape->n_bonds + listed + base);
    const int64_t first = BAD * shape->n_atoms + base;
    const int64_t i = first + shape->pairs[2 * listed], j = first + shape->pairs[2 * listed + 1];
    snprintf(atoms, sizeof atoms, "atoms %lld and %lld)", (long long)i, (long long)j);
    assert_message_names(atoms);
    snprintf(atoms, sizeof atoms, "bond %lld (", (long long)bond);
    assert_message_names(atoms);
    assert_message_names(lengths);
}

static void steps_that_do_not_converge(void **state)
{
    (void)state;
    const double box[9] = {40, 0, 0, 0, 40, 0, 0, 0, 40};
    for (int which = 0; which < 4 * N_SHAPES; ++which) {
        const flat *const shape = &shapes[which / 4];
        const int base = which % 2, boxed = which / 2 % 2;
        scene s = scene_of(shape, base);
        double r[3 * N_MOLECULES * MOST_ATOMS], before[3 * N_MOLECULES * MOST_ATOMS], v[3 * N_MOLECULES * MOST_ATOMS];
        if (boxed) CHECK(hol_chains_set_box(s.chains, box));
        memcpy(r, s.r_ref, sizeof r);
        memset(v, 0, sizeof v);
        r[3 * (BAD * shape->n_atoms + shape->lifted) + 2] = 3;
        memcpy(before, r, sizeof r);

        /* Which bond is how long, found here. */
        int64_t worst = 0;
        double length[12];
        for (int64_t k = 0; k < shape->n_bonds; ++k) {
            const double *const first = r + 3 * (BAD * shape->n_atoms);
            length[k] = distance(first + 3 * shape->pairs[2 * k], first + 3 * shape->pairs[2 * k + 1]);
            if (length[k] / s.length[k] > length[worst] / s.length[worst]) worst = k;
        }
        char words[200];
        snprintf(words, sizeof words,
                 "it should be %.6g long, is %.6g in the reference and %.6g in the positions to be projected; %s",
                 s.length[worst], s.length[worst], length[worst], boxed ? "a box is set" : "no box is set");

        CHECK_FAILS(HOL_ERR_NO_CONVERGENCE, hol_project_positions(s.chains, s.r_ref, r, v, 1, NULL, 0, NULL, NULL));
        assert_bond_is_named(&s, shape, worst, base, words);
        assert_same_bits(r, before, (size_t)(3 * s.n_atoms));
        for (int64_t i = 0; i < 3 * s.n_atoms; ++i) assert_true(v[i] == 0);
        hol_chains_destroy(s.chains);
    }
}

/* At the acceleration level there is one length; at the position level those of the reference and the trial. */
static void bonds_of_length_zero(void **state)
{
    (void)state;
    for (int which = 0; which < 2 * N_SHAPES; ++which) {
        const flat *const shape = &shapes[which / 2];
        const int base = which % 2;
        scene s = scene_of(shape, base);
        const int64_t first = BAD * shape->n_atoms;
        double good[3 * N_MOLECULES * MOST_ATOMS], g[3 * N_MOLECULES * MOST_ATOMS] = {0}, before[3 * MOST_ATOMS];
        memcpy(good, s.r_ref, sizeof good);
        CHECK(hol_project_positions(s.chains, good, good, NULL, 1, NULL, 0, NULL, NULL)); /* the check at the start */
        memcpy(s.r_ref + 3 * (first + shape->pairs[1]), s.r_ref + 3 * (first + shape->pairs[0]), 3 * sizeof(double));
        char words[200];
        CHECK_FAILS(HOL_ERR_DEGENERATE, hol_forces(s.chains, s.r_ref, NULL, NULL, NULL, NULL, g, HOL_WRITE, NULL));
        snprintf(words, sizeof words, "it should be %.6g long and is 0; no box is set", s.length[0]);
        assert_bond_is_named(&s, shape, 0, base, words);
        assert_message_names("has length zero");

        const double stretch = 1.02; /* a trial that needs a correction */
        for (int64_t i = 0; i < 3 * s.n_atoms; ++i) good[i] *= stretch;
        memcpy(before, good + 3 * first, sizeof(double) * 3 * (size_t)shape->n_atoms);
        CHECK_FAILS(HOL_ERR_DEGENERATE, hol_project_positions(s.chains, s.r_ref, good, NULL, 1, NULL, 0, NULL, NULL));
        snprintf(words, sizeof words,
                 "it should be %.6g long, is 0 in the reference and %.6g in the positions to be projected; no box",
                 s.length[0], stretch * s.length[0]);
        assert_bond_is_named(&s, shape, 0, base, words);
        assert_same_bits(good + 3 * first, before, (size_t)(3 * shape->n_atoms));
        hol_chains_destroy(s.chains);
    }
}

static void assert_refused(hol_chains *chains, const double *r, const char *what, const char *atoms, const char *length)
{
    double g[18] = {0};
    const double zero[18] = {0};
    CHECK_FAILS(HOL_ERR_DEGENERATE, hol_forces(chains, r, NULL, NULL, NULL, NULL, g, HOL_WRITE, NULL));
    assert_message_names(what);
    assert_message_names(atoms);
    assert_message_names(length);
    assert_same_bits(g, zero, 18);
    hol_chains_destroy(chains);
}

static void bonds_that_depend_on_each_other(void **state)
{
    (void)state;
    const double lengths[4] = {1.5, 1.5, 3, 0}, box[9] = {20, 0, 0, 0, 20, 0, 0, 0, 20};
    hol_chains *chains;

    const double held[3] = {0, 1, 0}, line[9] = {0, 0, 0, 1.5, 0, 0, 3, 0, 0};
    const int64_t triangle[6] = {0, 1, 1, 2, 0, 2};
    CHECK(hol_chains_create(3, held, &chains));
    CHECK(hol_chains_add_block(chains, 1, 2, 0, lengths));
    assert_refused(chains, line, "taut between atoms that are held fixed", "atoms 1 and 2)",
                   "it should be 1.5 long and is 1.5; no box is set");

    const double mass[4] = {1, 2, 3, 4}, nearly[3] = {1.5, 1.5, 2.99}; /* 2.999 would be straight */
    CHECK(hol_chains_create(3, mass, &chains));
    CHECK(hol_chains_add_bonds(chains, 3, triangle, nearly));
    CHECK(hol_chains_set_box(chains, box));
    assert_refused(chains, line, "depends on the others", "atoms ", "a box is set");

    /* A straight ring round the cell: three of its lengths and the side of the box make the fourth. */
    const double round[12] = {0, 0, 0, 5, 0, 0, 10, 0, 0, 15, 0, 0}, fives[4] = {5, 5, 5, 5};
    const int64_t ring[8] = {0, 1, 1, 2, 2, 3, 0, 3};
    CHECK(hol_chains_create(4, mass, &chains));
    CHECK(hol_chains_add_bonds(chains, 4, ring, fives));
    CHECK(hol_chains_set_box(chains, box));
    assert_refused(chains, round, "depends on the others", "atoms ", "it should be 5 long and is 5; a box is set");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(steps_that_do_not_converge),
        cmocka_unit_test(bonds_of_length_zero),
        cmocka_unit_test(bonds_that_depend_on_each_other),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
