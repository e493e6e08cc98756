/** What results of large molecules of repeating units do not depend on, to the last bit: threads, the order of bonds,
 * the layout of arrays, what was set before. */
#include "input.h"
#include "layout.h"
#include "residue_checks.h"
#include "residue_flock.h"

static const double dt = 2e-3;

static int64_t size_of_test(void)
{
    return quick_run() ? 400 : 1400;
}

static void share_threads(residues *s)
{
    molecule all = residue_copies(&s->m, 7);
    hol_chains *chains = residue_chains(&all, NULL);
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
    static const int recipes[] = {RANDOM_SEQUENCE, BRIDGES, SHORT_HOMOPOLYMER, TREE, UNEQUAL_KINDS, -1};
    for_some_residues(recipes, size_of_test(), share_threads);
}

static void turn_bonds(residues *s)
{
    molecule other = molecule_copy(&s->m);
    int64_t *place = malloc((size_t)other.n_bonds * sizeof *place);
    residues_shuffle(&other, 5, place);
    hol_chains *chains = residue_chains(&other, residues_box(s));
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
    static const int recipes[] = {
        RANDOM_SEQUENCE, CLOSED,     SHORT_HOMOPOLYMER, SUGARS, PROLINES,         COMB,          STAR,      TREE,
        OWN_KINDS,       FIXED_ENDS, FIXED_BACKBONE,    IN_BOX, IN_TRICLINIC_BOX, UNEQUAL_ATOMS, BACKWARDS, ANY_ORDER,
        ISOTOPES,        -1};
    for_some_residues(recipes, size_of_test(), turn_bonds);
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
        CHECK(hol_forces_view(s->chains, INPUT(&r.view), INPUT(&v.view), INPUT(&f.view), lambda, tension, &g.view,
                              HOL_WRITE, virial));
        assert_same_bits(lambda, x.bond[0], n);
        assert_same_bits(tension, x.bond[1], n);
        assert_same_bits(virial, x.virial, 9);
        assert_laid_out(&g, x.atom[0], how->name);
        CHECK(hol_solve_view(s->chains, INPUT(&r.view), m->length, lambda, NULL, HOL_WRITE, NULL));
        assert_same_bits(lambda, x.bond[2], n);
        CHECK(hol_project_velocities_view(s->chains, INPUT(&r.view), &v.view, lambda, NULL));
        assert_same_bits(lambda, x.bond[3], n);
        assert_laid_out(&v, x.atom[1], other->name);
        CHECK(hol_project_positions_view(s->chains, INPUT(&r.view), &moved.view, NULL, dt, lambda, 0, NULL, NULL));
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
    static const int recipes[] = {RANDOM_SEQUENCE, BRIDGES, SHORT_HOMOPOLYMER, TREE, FIXED_ENDS, -1};
    for_some_residues(recipes, size_of_test() / 2, lay_out_arrays);
}

static void change(residues *s)
{
    molecule other = molecule_copy(&s->m);
    for (int64_t i = 0; i < other.n_atoms; ++i) other.mass[i] *= 1 + (double)(i % 7);
    for (int64_t k = 0; k < other.n_bonds; ++k) other.length[k] *= 1 + 1e-3 * (double)(k % 3);
    hol_chains *changed = residue_chains(&other, residues_box(s));
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
    static const int recipes[] = {RANDOM_SEQUENCE, BRIDGES, SHORT_HOMOPOLYMER, TREE, IN_BOX, -1};
    for_some_residues(recipes, size_of_test(), change);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(number_of_threads_changes_no_bit),
        cmocka_unit_test(order_and_direction_of_bonds_change_no_bit),
        cmocka_unit_test(layout_changes_no_bit),
        cmocka_unit_test(masses_and_lengths_given_later_are_as_those_of_a_new_set),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
