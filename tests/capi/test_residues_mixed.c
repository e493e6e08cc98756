/** Large molecules of repeating units of all sizes and of all sorts of features at once, in states of all sorts. */
#include "equations.h"
#include "input.h"
#include "layout.h"
#include "residue_checks.h"
#include "residue_kind.h"

static void check_forces(const residues *s, const double *v, const double *f)
{
    double *lambda = untouched((size_t)s->m.n_bonds), *g = untouched(3 * (size_t)s->m.n_atoms), virial[9];
    CHECK(hol_forces(s->chains, s->m.r, v, f, lambda, NULL, g, HOL_WRITE, virial));
    leave_roundings_in_box(&s->m, residues_box(s), lambda, v, f, 0, NULL);
    check_pulls(s, lambda, g, NULL, virial);
    free(lambda), free(g);
}

static void check_velocities(const residues *s, const double *v)
{
    double *lambda = untouched((size_t)s->m.n_bonds), *moved = copy_of(v, 3 * (size_t)s->m.n_atoms), virial[9];
    CHECK(hol_project_velocities(s->chains, s->m.r, moved, lambda, virial));
    leave_roundings_in_box(&s->m, residues_box(s), lambda, v, NULL, 1, NULL);
    check_pulls(s, lambda, NULL, NULL, virial);
    check_rates(s, v, moved, NULL);
    free(lambda), free(moved);
}

/** From positions that the molecule's are after a drift. */
static void check_positions(const residues *s, const double *start, double dt)
{
    const size_t size = 3 * (size_t)s->m.n_atoms;
    double *r = copy_of(start, size), *lambda = untouched((size_t)s->m.n_bonds), virial[9];
    CHECK(hol_project_positions(s->chains, s->m.r, r, NULL, dt, lambda, 0, virial, NULL));
    check_lengths(s, r);
    check_pulls(s, lambda, NULL, NULL, virial);
    check_displacements(s, start, r, lambda, dt);
    free(r), free(lambda);
}

static void check_all(residues *s)
{
    check_forces(s, s->m.v, s->m.f);
    check_velocities(s, s->m.v);
    residues_project(s);
    const double dt = residues_step(s, s->recipe->bend > 0 ? 0.01 : 0.05); /* what is taut can't be moved by more */
    double *start = molecule_drifted(&s->m, dt);
    check_positions(s, start, dt);
    free(start);
}

/** Any number of residues of each kind, so that they fill lanes or not. */
static void every_number_of_residues_is_solved(void **state)
{
    (void)state;
    static const int recipes[] = {RINGED_HOMOPOLYMER, PROLINES, SHORT_HOMOPOLYMER, RANDOM_SEQUENCE, BRIDGES};
    for (int i = 0; i < (quick_run() ? 1 : 5); ++i)
        for (int64_t n = 200; n < (quick_run() ? 300 : 620); n += 17) {
            residues s = residues_make(&residue_recipes[recipes[i]], n, (uint64_t)n);
            check_all(&s);
            residues_free(&s);
        }
}

/** Any of the features together. */
static residue_recipe any_recipe(random_stream *random)
{
    static const double bends[] = {0, 0, 0, 0.3, 1e-2}, offsets[] = {0, 0, 100, -3e3};
    residue_recipe x = {.name = "any"};
    x.n_kinds = (int)random_integer(random, 1, RESIDUE_TEXTS);
    x.first_kind = (int)random_integer(random, 0, RESIDUE_TEXTS - x.n_kinds);
    x.order = (residue_order)random_integer(random, RESIDUES_IN_LINE, RESIDUES_AS_TREE);
    x.bridges = (int)random_integer(random, -4, 6);
    x.closed = random_integer(random, 0, 4) == 0;
    x.caps = random_integer(random, 0, 1) == 0;
    x.fixed = (int)random_integer(random, -4, 4);
    x.isotopes = (int)random_integer(random, -4, 6);
    x.decades = random_integer(random, 0, 3) == 0 ? random_uniform(random) - 0.5 : 0;
    x.bend = bends[random_integer(random, 0, 4)];
    x.offset = offsets[random_integer(random, 0, 3)];
    x.box = (residue_box)(random_integer(random, 0, 1) * random_integer(random, 1, 2));
    x.shuffled = random_integer(random, 0, 1) == 0;
    x.numbers = (residue_numbers)(random_integer(random, 0, 1) * random_integer(random, 0, NUMBERS_ANYHOW));
    if (x.bridges < 0) x.bridges = 0;
    if (x.fixed < 0) x.fixed = 0;
    if (x.isotopes < 0) x.isotopes = 0;
    return x;
}

static void molecules_of_all_sorts_are_solved(void **state)
{
    (void)state;
    random_stream random = random_seed(20);
    for (int i = 0; i < (quick_run() ? 6 : 400); ++i) {
        const residue_recipe recipe = any_recipe(&random);
        const int64_t n = random_integer(&random, 300, quick_run() ? 600 : i % 10 ? 1500 : 3000);
        print_message("%d: kinds %d from %d, order %d, bridges %d, closed %d, fixed %d, decades %g, bend %g, box %d\n",
                      i, recipe.n_kinds, recipe.first_kind, (int)recipe.order, recipe.bridges, recipe.closed,
                      recipe.fixed, recipe.decades, recipe.bend, (int)recipe.box);
        residues s = residues_make(&recipe, n, (uint64_t)i);
        check_all(&s);
        residues_free(&s);
    }
}

/** One atom, or one residue alone, has a force, a velocity, a displacement; all others have none. */
static void stir_one(residues *s)
{
    const int64_t n = s->m.n_atoms;
    const size_t size = 3 * (size_t)n;
    residues_project(s);
    const double dt = residues_step(s, 0.05);
    for (int which = 0; which < 4; ++which) {
        double *f = calloc(size, sizeof *f), *v = calloc(size, sizeof *v), *start = copy_of(s->m.r, size);
        const int64_t atom = n * (which + 1) / 6, residue = s->residue[atom];
        for (int64_t i = 0; i < 3 * n; ++i) {
            if (s->m.mass[i / 3] == 0 || (which % 2 ? s->residue[i / 3] != residue : i / 3 != atom)) continue;
            f[i] = s->m.f[i], v[i] = s->m.v[i], start[i] += dt * v[i];
        }
        check_forces(s, NULL, f);
        check_forces(s, v, NULL);
        check_velocities(s, v);
        check_positions(s, start, dt);
        free(f), free(v), free(start);
    }
}
static void what_stirs_one_residue_alone_is_felt_rightly_by_all(void **state)
{
    (void)state;
    for_each_residues(1200, 1, stir_one);
}

/** Off by a tenth in any direction. */
static void impose(residues *s)
{
    const int64_t size = 3 * s->m.n_atoms;
    random_stream random = random_seed(6);
    double *r = copy_of(s->m.r, (size_t)size);
    hol_report report;
    for (int64_t i = 0; i < size; ++i) r[i] += s->m.mass[i / 3] > 0 ? 0.1 * (2 * random_uniform(&random) - 1) : 0;
    CHECK(hol_impose(s->chains, r, &report));
    assert_int_equal(report.n_corrected, s->n_molecules);
    check_lengths(s, r);
    free(r);
}
static void crude_positions_are_put_on_the_constraints(void **state)
{
    (void)state;
    for_each_residues(1200, 1, impose);
}

/** A molecule in a plane, of all three components and of two. */
static void flatten(residues *s)
{
    molecule *m = &s->m;
    const size_t n = (size_t)m->n_bonds, size = 3 * (size_t)m->n_atoms;
    double *lambda = untouched(n), *flat = untouched(n), *g = untouched(size);
    for (size_t i = 2; i < size; i += 3) m->r[i] = m->v[i] = m->f[i] = 0;
    for (int k = 0; k < n_double_layouts; ++k) {
        laid_out r = lay_out(&layouts[k], m->n_atoms, m->r, 2), v = lay_out(&layouts[k], m->n_atoms, m->v, 2),
                 f = lay_out(&layouts[k], m->n_atoms, m->f, 2), out = lay_out(&layouts[k], m->n_atoms, m->f, 2);
        CHECK(hol_forces(s->chains, m->r, m->v, m->f, lambda, NULL, g, HOL_WRITE, NULL));
        CHECK(hol_forces_view(s->chains, INPUT(&r.view), INPUT(&v.view), INPUT(&f.view), flat, NULL, &out.view,
                              HOL_WRITE, NULL));
        assert_same_bits(flat, lambda, n);
        assert_laid_out(&out, g, layouts[k].name);
        CHECK(hol_project_velocities_view(s->chains, INPUT(&r.view), &v.view, flat, NULL));
        double *moved = copy_of(m->v, size);
        CHECK(hol_project_velocities(s->chains, m->r, moved, lambda, NULL));
        assert_same_bits(flat, lambda, n);
        assert_laid_out(&v, moved, layouts[k].name);
        free(moved);
        laid_out_free(&r), laid_out_free(&v), laid_out_free(&f), laid_out_free(&out);
    }
    free(lambda), free(flat), free(g);
}
static void two_dimensions_are_three_without_the_last(void **state)
{
    (void)state;
    static const int recipes[] = {RANDOM_SEQUENCE, SUGARS, BRIDGES, COMB, -1};
    for_some_residues(recipes, 600, flatten);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_number_of_residues_is_solved),
        cmocka_unit_test(molecules_of_all_sorts_are_solved),
        cmocka_unit_test(what_stirs_one_residue_alone_is_felt_rightly_by_all),
        cmocka_unit_test(crude_positions_are_put_on_the_constraints),
        cmocka_unit_test(two_dimensions_are_three_without_the_last),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
