/** What results of large molecules of repeating units do not depend on, to the last bit: threads, other molecules, the
 * order of bonds, the layout of arrays, what was set before. */
#include "layout.h"
#include "residue_checks.h"
#include "residue_flock.h"

static const double dt = 2e-3;

static int64_t size_of_test(void)
{
    return quick_run() ? 400 : 1400;
}

/** Calls the function with molecules of some recipes. */
static void for_some(const int *recipes, int64_t n_bonds, void (*check)(residues *s))
{
    for (int i = 0; recipes[i] >= 0 && i < (quick_run() ? 2 : 20); ++i) {
        print_message("%s\n", residue_recipes[recipes[i]].name);
        residues s = residues_make(&residue_recipes[recipes[i]], n_bonds, 77 + (uint64_t)i);
        check(&s);
        residues_free(&s);
    }
}

static hol_chains *chains_of(const molecule *m, const double *box)
{
    hol_chains *chains = NULL;
    CHECK(hol_chains_create(m->n_atoms, m->mass, &chains));
    CHECK(hol_chains_set_box(chains, box));
    CHECK(hol_chains_add_bonds(chains, m->n_bonds, m->pairs, m->length));
    return chains;
}

static void share_threads(residues *s)
{
    molecule all = residue_copies(&s->m, 7);
    hol_chains *chains = chains_of(&all, NULL);
    residue_results one = residue_compute(chains, &all, dt);
    for (int threads = 2; threads < 4; ++threads) {
        CHECK(hol_chains_set_threads(chains, threads));
        residue_results several = residue_compute(chains, &all, dt);
        assert_same_results(&several, &one, 0, 0);
        assert_same_bits(several.virial, one.virial, 9);
        residue_results_free(&several);
    }
    residue_results_free(&one);
    hol_chains_destroy(chains);
    molecule_free(&all);
}
static void number_of_threads_changes_no_bit(void **state)
{
    (void)state;
    static const int recipes[] = {0, 5, 2, 9, 18, -1};
    for_some(recipes, size_of_test(), share_threads);
}

/** In one call for all copies, and as a list of bonds. */
static void stand_together(residues *s)
{
    enum { COPIES = 5 };
    const molecule *m = &s->m;
    molecule all = residue_copies(m, COPIES);
    hol_chains *together[2] = {NULL, chains_of(&all, NULL)};
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
    static const int recipes[] = {0, 3, 1, 2, 5, 6, 7, 9, 10, 11, 18, 19, -1};
    for_some(recipes, size_of_test(), stand_together);
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
    hol_chains *chains = chains_of(&all, NULL);
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

static void turn_bonds(residues *s)
{
    molecule other = molecule_copy(&s->m);
    int64_t *place = malloc((size_t)other.n_bonds * sizeof *place);
    residues_shuffle(&other, 5, place);
    hol_chains *chains = chains_of(&other, residues_box(s));
    molecule same = molecule_copy(&s->m); /* right-hand sides of residue_compute are lengths */
    residue_results plain = residue_compute(s->chains, &same, dt), shuffled = residue_compute(chains, &other, dt);
    for (int a = 0; a < ATOM_RESULTS; ++a) assert_same_bits(shuffled.atom[a], plain.atom[a], plain.size);
    for (int b = 0; b < BOND_RESULTS; ++b)
        for (int64_t k = 0; k < other.n_bonds; ++k) assert_same_bits(shuffled.bond[b] + k, plain.bond[b] + place[k], 1);
    assert_same_bits(shuffled.virial, plain.virial, 9);
    residue_results_free(&plain), residue_results_free(&shuffled);
    hol_chains_destroy(chains);
    molecule_free(&other), molecule_free(&same);
    free(place);
}
static void order_and_direction_of_bonds_change_no_bit(void **state)
{
    (void)state;
    static const int recipes[] = {0, 6, 2, 3, 4, 7, 8, 9, 10, 11, 12, 15, 16, 19, -1};
    for_some(recipes, size_of_test(), turn_bonds);
}

static void lay_out_arrays(residues *s)
{
    molecule *m = &s->m;
    const size_t n = (size_t)m->n_bonds, size = 3 * (size_t)m->n_atoms;
    double *lambda = untouched(n), *tension = untouched(n), virial[9];
    for (size_t i = 0; i < size; ++i) m->r[i] = (float)m->r[i], m->v[i] = (float)m->v[i], m->f[i] = (float)m->f[i];
    residue_results x = residue_compute(s->chains, m, dt);
    double *start = molecule_drifted(m, dt);
    for (int k = 0; k < n_layouts; ++k) {
        const layout *how = &layouts[k], *other = &layouts[(k + 5) % n_layouts];
        laid_out r = lay_out(how, m->n_atoms, m->r, 3), v = lay_out(other, m->n_atoms, m->v, 3),
                 f = lay_out(other, m->n_atoms, m->f, 3), g = lay_out(how, m->n_atoms, m->f, 3),
                 moved = lay_out(how, m->n_atoms, start, 3);
        CHECK(hol_forces_view(s->chains, &r.view, &v.view, &f.view, lambda, tension, &g.view, HOL_WRITE, virial));
        assert_same_bits(lambda, x.bond[0], n);
        assert_same_bits(tension, x.bond[1], n);
        assert_same_bits(virial, x.virial, 9);
        assert_laid_out(&g, x.atom[0], how->name);
        CHECK(hol_solve_view(s->chains, &r.view, m->length, lambda, NULL, HOL_WRITE, NULL));
        assert_same_bits(lambda, x.bond[2], n);
        CHECK(hol_project_velocities_view(s->chains, &r.view, &v.view, lambda, NULL));
        assert_same_bits(lambda, x.bond[3], n);
        assert_laid_out(&v, x.atom[1], other->name);
        CHECK(hol_project_positions_view(s->chains, &r.view, &moved.view, NULL, dt, lambda, 0, NULL, NULL));
        if (how->element == HOL_DOUBLE) {
            assert_same_bits(lambda, x.bond[4], n);
            assert_laid_out(&moved, x.atom[2], how->name);
        } else {
            double *end = copy_of(start, size), extent = 1;
            collect(&moved, end);
            for (size_t i = 0; i < size; ++i) extent = fmax(extent, fabs(end[i]));
            for (size_t b = 0; b < n; ++b) CHECK_AT_MOST(length_error(s, end, (int64_t)b), 8 * FLT_EPSILON * extent);
            free(end);
        }
        laid_out_free(&r), laid_out_free(&v), laid_out_free(&f), laid_out_free(&g), laid_out_free(&moved);
    }
    free(lambda), free(tension), free(start);
    residue_results_free(&x);
}
static void layout_changes_no_bit(void **state)
{
    (void)state;
    static const int recipes[] = {0, 5, 2, 9, 11, -1};
    for_some(recipes, size_of_test() / 2, lay_out_arrays);
}

static void change(residues *s)
{
    molecule other = molecule_copy(&s->m);
    for (int64_t i = 0; i < other.n_atoms; ++i) other.mass[i] *= 1 + (double)(i % 7);
    for (int64_t k = 0; k < other.n_bonds; ++k) other.length[k] *= 1 + 1e-3 * (double)(k % 3);
    hol_chains *changed = chains_of(&other, residues_box(s));
    residue_results before = residue_compute(changed, &other, dt), expected = residue_compute(s->chains, &s->m, dt);
    CHECK(hol_chains_set_masses(changed, s->m.mass));
    CHECK(hol_chains_set_lengths(changed, s->m.length));
    residue_results after = residue_compute(changed, &s->m, dt);
    assert_same_results(&after, &expected, 0, 0);
    assert_true(memcmp(before.atom[2], after.atom[2], after.size * sizeof(double)) != 0);
    residue_results_free(&before), residue_results_free(&after), residue_results_free(&expected);
    hol_chains_destroy(changed);
    molecule_free(&other);
}
static void masses_and_lengths_given_later_are_as_those_of_a_new_set(void **state)
{
    (void)state;
    static const int recipes[] = {0, 5, 2, 9, 15, -1};
    for_some(recipes, size_of_test(), change);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(number_of_threads_changes_no_bit),
        cmocka_unit_test(each_of_several_copies_has_the_bits_of_one_alone),
        cmocka_unit_test(neighbours_change_no_bit),
        cmocka_unit_test(order_and_direction_of_bonds_change_no_bit),
        cmocka_unit_test(layout_changes_no_bit),
        cmocka_unit_test(masses_and_lengths_given_later_are_as_those_of_a_new_set),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
