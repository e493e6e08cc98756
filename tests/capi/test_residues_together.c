/** Several large molecules of repeating units in one set: each has the bits that it has alone. */
#include "residue_checks.h"
#include "residue_flock.h"

static const double dt = 2e-3;

static int64_t size_of_test(void)
{
    return quick_run() ? 400 : 1400;
}

/** In one call for all copies, and as a list of bonds. */
static void stand_together(residues *s)
{
    enum { COPIES = 5 };
    const molecule *m = &s->m;
    molecule all = residue_copies(m, COPIES);
    hol_chains *together[2] = {NULL, residue_chains(&all, NULL)};
    CHECK(hol_chains_create(all.n_atoms, all.mass, &together[0]));
    CHECK(hol_chains_add_molecules(together[0], COPIES, m->n_atoms, 0, m->n_bonds, m->pairs, m->length));
    residue_results x[2];
    for (int i = 0; i < 2; ++i) x[i] = residue_compute(together[i], &all, dt);
    assert_same_results(&x[0], &x[1], 0, 0);
    for (int64_t c = 0; c < COPIES; ++c) {
        molecule one = residue_copy(&all, m, c);
        residue_results alone = residue_compute(s->chains, &one, dt);
        assert_same_results(&alone, &x[0], c * m->n_bonds, c * m->n_atoms);
        residue_results_free(&alone);
        molecule_free(&one);
    }
    for (int i = 0; i < 2; ++i) residue_results_free(&x[i]), hol_chains_destroy(together[i]);
    molecule_free(&all);
}
static void each_of_several_copies_has_the_bits_of_one_alone(void **state)
{
    (void)state;
    static const int recipes[] = {
        RANDOM_SEQUENCE, SUGARS,     RINGED_HOMOPOLYMER, SHORT_HOMOPOLYMER, BRIDGES,   CLOSED,    COMB,     TREE,
        OWN_KINDS,       FIXED_ENDS, UNEQUAL_KINDS,      UNEQUAL_ATOMS,     BACKWARDS, ANY_ORDER, ISOTOPES, -1};
    for_some_residues(recipes, size_of_test(), stand_together);
}

/** Appends a molecule to another one's arrays. */
static void append(molecule *all, const molecule *m)
{
    const int64_t atoms = all->n_atoms, bonds = all->n_bonds;
    for (int64_t i = 0; i < m->n_atoms; ++i) {
        molecule_add_atom(all, m->mass[i], m->r + 3 * i);
        memcpy(all->v + 3 * (atoms + i), m->v + 3 * i, 3 * sizeof *m->v);
        memcpy(all->f + 3 * (atoms + i), m->f + 3 * i, 3 * sizeof *m->f);
    }
    for (int64_t k = 0; k < m->n_bonds; ++k) {
        molecule_add_bond(all, m->pairs[2 * k] + atoms, m->pairs[2 * k + 1] + atoms);
        all->length[bonds + k] = m->length[k];
    }
}

/** Different molecules of residues, with water between them. */
static void neighbours_change_no_bit(void **state)
{
    (void)state;
    enum { PARTS = 8 };
    molecule all = molecule_empty(), water = molecule_make(MOLECULE_WATER, 3, 1);
    residues part[PARTS];
    int64_t bond[PARTS], atom[PARTS];
    for (int p = 0; p < PARTS; ++p) {
        part[p] = residues_make(&residue_recipes[p], size_of_test() / 2, (uint64_t)p);
        bond[p] = all.n_bonds, atom[p] = all.n_atoms;
        append(&all, &part[p].m);
        append(&all, &water);
    }
    hol_chains *chains = residue_chains(&all, NULL);
    residue_results together = residue_compute(chains, &all, dt);
    for (int p = 0; p < PARTS; ++p) {
        residue_results alone = residue_compute(part[p].chains, &part[p].m, dt);
        assert_same_results(&alone, &together, bond[p], atom[p]);
        residue_results_free(&alone);
        residues_free(&part[p]);
    }
    residue_results_free(&together);
    hol_chains_destroy(chains);
    molecule_free(&all), molecule_free(&water);
}

/** The new number of each atom of two copies whose residues take turns. */
static int64_t *alternate(const residues *s)
{
    const int64_t n = s->m.n_atoms;
    int64_t *number = malloc(2 * (size_t)n * sizeof *number), next = 0;
    for (int64_t first = 0, end; first < n; first = end) {
        for (end = first; end < n && s->residue[end] == s->residue[first];) ++end;
        for (int64_t copy = 0; copy < 2; ++copy)
            for (int64_t i = first; i < end; ++i) number[copy * n + i] = next++;
    }
    return number;
}

static void take_turns(residues *s)
{
    const int64_t n = s->m.n_atoms;
    molecule all = residue_copies(&s->m, 2), mixed = molecule_copy(&all);
    int64_t *number = alternate(s);
    for (int64_t i = 0; i < 2 * n; ++i) {
        mixed.mass[number[i]] = all.mass[i];
        memcpy(mixed.r + 3 * number[i], all.r + 3 * i, 3 * sizeof *all.r);
        memcpy(mixed.v + 3 * number[i], all.v + 3 * i, 3 * sizeof *all.v);
        memcpy(mixed.f + 3 * number[i], all.f + 3 * i, 3 * sizeof *all.f);
    }
    for (int64_t e = 0; e < 2 * all.n_bonds; ++e) mixed.pairs[e] = number[all.pairs[e]];
    hol_chains *one_by_one = residue_chains(&all, NULL), *in_turns = residue_chains(&mixed, NULL);
    residue_results x = residue_compute(one_by_one, &all, dt), y = residue_compute(in_turns, &mixed, dt);
    for (int b = 0; b < BOND_RESULTS; ++b) assert_same_bits(y.bond[b], x.bond[b], x.n_bonds);
    for (int a = 0; a < ATOM_RESULTS; ++a)
        for (int64_t i = 0; i < 2 * n; ++i) assert_same_bits(y.atom[a] + 3 * number[i], x.atom[a] + 3 * i, 3);
    residue_results_free(&x), residue_results_free(&y);
    hol_chains_destroy(one_by_one), hol_chains_destroy(in_turns);
    molecule_free(&all), molecule_free(&mixed);
    free(number);
}
static void molecules_whose_residues_take_turns_have_the_same_bits(void **state)
{
    (void)state;
    static const int recipes[] = {RANDOM_SEQUENCE, RINGED_HOMOPOLYMER, BRIDGES, TREE, FIXED_ENDS, -1};
    for_some_residues(recipes, size_of_test(), take_turns);
}

/** Some inactive, and with outcomes kept. */
static void leave_some_out(residues *s)
{
    enum { COPIES = 4 };
    const int64_t n = s->m.n_bonds, atoms = s->m.n_atoms;
    const unsigned char active[COPIES] = {1, 0, 1, 1};
    molecule all = residue_copies(&s->m, COPIES);
    hol_chains *chains = residue_chains(&all, NULL);
    residue_results x = residue_compute(chains, &all, dt);
    int status[COPIES], iterations[COPIES];
    CHECK(hol_chains_set_outcomes(chains, 1));
    residue_results kept = residue_compute(chains, &all, dt);
    CHECK(hol_outcomes(chains, status, iterations));
    for (int c = 0; c < COPIES; ++c) assert_true(status[c] == HOL_OK && iterations[c] > 0);
    assert_same_results(&kept, &x, 0, 0);
    CHECK(hol_chains_set_outcomes(chains, 0));
    CHECK(hol_chains_set_active(chains, active));
    for (int64_t i = 3 * atoms; i < 6 * atoms; ++i) all.r[i] = NAN; /* not read */
    residue_results some = residue_compute(chains, &all, dt);
    for (int64_t c = 0; c < COPIES; ++c)
        for (int b = 0; b < BOND_RESULTS; ++b)
            active[c] ? assert_same_bits(some.bond[b] + c * n, x.bond[b] + c * n, (size_t)n)
                      : assert_untouched(some.bond[b] + c * n, (size_t)n);
    for (int64_t c = 0; c < COPIES; c += 2)
        for (int a = 0; a < ATOM_RESULTS; ++a)
            assert_same_bits(some.atom[a] + 3 * c * atoms, x.atom[a] + 3 * c * atoms, 3 * (size_t)atoms);
    residue_results_free(&x), residue_results_free(&kept), residue_results_free(&some);
    hol_chains_destroy(chains);
    molecule_free(&all);
}
static void those_left_out_are_neither_read_nor_written(void **state)
{
    (void)state;
    static const int recipes[] = {RANDOM_SEQUENCE, RINGED_HOMOPOLYMER, BRIDGES, COMB, -1};
    for_some_residues(recipes, size_of_test(), leave_some_out);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_of_several_copies_has_the_bits_of_one_alone),
        cmocka_unit_test(neighbours_change_no_bit),
        cmocka_unit_test(molecules_whose_residues_take_turns_have_the_same_bits),
        cmocka_unit_test(those_left_out_are_neither_read_nor_written),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
