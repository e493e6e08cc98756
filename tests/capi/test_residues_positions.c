/** Positions of large molecules of repeating units: put back on the constraints, with what is told of it. */
#include "equations.h"
#include "residue_checks.h"

enum { DENSE = 330, LARGE = 2400 };

typedef struct step {
    double dt, *start, *r, *v, *lambda, virial[9];
    hol_report report;
} step;

/** A step after which no bond is off by more than a part of its length. */
static step make_step(residues *s, double part, int projected)
{
    const size_t n = (size_t)s->m.n_bonds, size = 3 * (size_t)s->m.n_atoms;
    if (projected) residues_project(s);
    step x = {.dt = residues_step(s, part)};
    x.start = molecule_drifted(&s->m, x.dt);
    x.r = copy_of(x.start, size), x.v = copy_of(s->m.v, size), x.lambda = untouched(n);
    CHECK(hol_project_positions(s->chains, s->m.r, x.r, x.v, x.dt, x.lambda, 0, x.virial, &x.report));
    assert_int_equal(x.report.n_failed, 0);
    return x;
}

static void free_step(step *x)
{
    free(x->start), free(x->r), free(x->v), free(x->lambda);
}

/** r - start = dt^2 w G and v - before = dt w G, with G along the bonds there were. */
static void move_as_multipliers_say(const residues *s, const step *x)
{
    check_displacements(s, x->start, x->r, x->lambda, x->dt);
    pulls p = pulls_of(s, x->lambda);
    const long double images = residues_box(s) ? s->box[0] : 0;
    for (int64_t i = 0; i < 3 * s->m.n_atoms; ++i) {
        const long double w = s->m.inverse_mass[i / 3], move = x->dt * x->dt * w * p.g[i];
        const long double size = (16 + images) * DBL_EPSILON * x->dt * w * p.size[i / 3];
        CHECK_AT_MOST(fabsl(s->m.v[i] + move / x->dt - x->v[i]), 8 * DBL_EPSILON * fabs(s->m.v[i]) + 4 * size);
    }
    pulls_free(&p);
}

static void take_steps(residues *s)
{
    const size_t n = (size_t)s->m.n_bonds, size = 3 * (size_t)s->m.n_atoms;
    step x = make_step(s, 0.05, 1);
    hol_report report;
    assert_int_equal(x.report.n_corrected, s->n_molecules);
    CHECK_AT_MOST(x.report.max_error, length_rounding(s));
    check_lengths(s, x.r);
    move_as_multipliers_say(s, &x);
    check_pulls(s, x.lambda, NULL, NULL, x.virial);
    double *alone = copy_of(x.start, size), *with_lambda = copy_of(x.start, size), *lambda = untouched(n);
    CHECK(hol_project_positions(s->chains, s->m.r, alone, NULL, x.dt, NULL, 0, NULL, NULL));
    assert_same_bits(alone, x.r, size);
    CHECK(hol_project_positions(s->chains, s->m.r, with_lambda, NULL, x.dt, lambda, 0, NULL, NULL));
    assert_same_bits(lambda, x.lambda, n);
    /* Once more, with these as a guess: nothing but roundings can have changed. */
    double *again = copy_of(x.start, size);
    CHECK(hol_project_positions(s->chains, s->m.r, again, NULL, x.dt, lambda, 1, NULL, &report));
    assert_true(report.iterations <= x.report.iterations);
    check_lengths(s, again);
    const double rounding = length_rounding(s);
    for (size_t i = 0; i < size; ++i) CHECK_AT_MOST(fabs(again[i] - x.r[i]), 64 * rounding);
    /* What obeys the constraints is left alone. */
    CHECK(hol_project_positions(s->chains, s->m.r, again, NULL, x.dt, lambda, 0, NULL, &report));
    assert_true(report.n_corrected == 0 || s->recipe->decades != 0);
    free(alone), free(with_lambda), free(again), free(lambda);
    free_step(&x);
}
static void bonds_get_their_lengths_by_the_forces_that_lambda_says(void **state)
{
    (void)state;
    for_each_residues(LARGE, 1, take_steps);
}

static void agree(residues *s)
{
    const molecule_problem p = residues_problem(s);
    step x = make_step(s, 0.02, 1);
    molecule_solution exact;
    assert_int_equal(molecule_positions(&p, x.start, residues_box(s), s->m.length, x.dt, &exact), 0);
    for (int64_t i = 0; i < 3 * s->m.n_atoms; ++i) {
        const long double after = s->m.v[i] + (exact.moved[i] - x.start[i]) / x.dt;
        CHECK_AT_MOST(fabsl(x.v[i] - after), residue_unit(s) * (fabs(s->m.v[i]) + exact.moved_scale[i / 3] / x.dt));
    }
    for (int c = 0; c < 9; ++c)
        CHECK_AT_MOST(fabsl(x.virial[c] - exact.virial[c]), residue_unit(s) * exact.virial_scale);
    check_solution(s, x.lambda, x.r, &exact);
    free_step(&x);
}
static void positions_agree_with_newton_in_many_digits(void **state)
{
    (void)state;
    for_each_residues(DENSE, 1, agree);
}

/** Velocities that do not obey the constraints, a quarter of a bond; then the multipliers of another step as a guess.
 */
static void take_a_large_step(residues *s)
{
    step x = make_step(s, 0.25, 0);
    check_lengths(s, x.r);
    move_as_multipliers_say(s, &x);
    double *r = molecule_drifted(&s->m, 0.5 * x.dt);
    CHECK(hol_project_positions(s->chains, s->m.r, r, NULL, 0.5 * x.dt, x.lambda, 1, NULL, NULL));
    check_lengths(s, r);
    free(r);
    free_step(&x);
}
static void large_steps_and_poor_guesses_end_on_the_constraints(void **state)
{
    (void)state;
    for_each_residues(LARGE / 2, 1, take_a_large_step);
}

/** Vectors in place of reference positions. */
static void go_along(residues *s)
{
    step x = make_step(s, 0.05, 1);
    double *b = untouched(3 * (size_t)s->m.n_bonds), *r = copy_of(x.start, 3 * (size_t)s->m.n_atoms);
    for (int64_t k = 0; k < s->m.n_bonds; ++k) {
        long double d[3];
        bond_in_box(s->m.r, s->m.pairs + 2 * k, residues_box(s), d);
        for (int c = 0; c < 3; ++c) b[3 * k + c] = (double)d[c];
    }
    CHECK(hol_project_positions_along(s->chains, b, r, NULL, x.dt, NULL, 0, NULL, NULL));
    check_lengths(s, r);
    const double rounding = length_rounding(s);
    for (int64_t i = 0; i < 3 * s->m.n_atoms; ++i) CHECK_AT_MOST(fabs(r[i] - x.r[i]), 64 * rounding);
    free(b), free(r);
    free_step(&x);
}
static void bond_vectors_do_as_well_as_reference_positions(void **state)
{
    (void)state;
    for_each_residues(LARGE / 2, 1, go_along);
}

static int n_told;
static void end_within_a_tolerance(residues *s)
{
    double *r, error;
    hol_report report;
    int64_t *order = malloc((size_t)s->m.n_bonds * sizeof *order);
    residues_project(s);
    CHECK(hol_chains_set_tolerance(s->chains, 1e-5));
    r = molecule_drifted(&s->m, residues_step(s, 0.1));
    CHECK(hol_project_positions(s->chains, s->m.r, r, NULL, 1, NULL, 0, NULL, &report));
    const int64_t bond = worst_bond(s, r, &error);
    CHECK_AT_MOST(error, 1e-5);
    CHECK_AT_MOST(fabs(report.max_error - error), 4 * length_rounding(s));
    CHECK(hol_chains_bonds(s->chains, report.molecule, order));
    if (error > 1e-8) ++n_told, assert_int_equal(order[report.bond], bond);
    free(r), free(order);
}
static void a_tolerance_is_kept_and_the_worst_bond_told(void **state)
{
    (void)state;
    n_told = 0;
    for_each_residues(LARGE, 1, end_within_a_tolerance);
    assert_true(n_told > 0);
}

/** Pulls all atoms behind a link outwards, of those of a line, and an end atom of another residue. */
static void stretch(const residues *s, int64_t link, double by, int64_t end, double by_end, double *r)
{
    const molecule *m = &s->m;
    long double d[3];
    bond_in_box(m->r, m->pairs + 2 * link, residues_box(s), d);
    const int64_t first = s->residue[m->pairs[2 * link]], behind = s->residue[m->pairs[2 * link + 1]];
    const double side = behind > first ? by : -by;
    for (int64_t i = 0; i < m->n_atoms; ++i)
        for (int c = 0; c < 3 && s->residue[i] >= (behind > first ? behind : first); ++c)
            r[3 * i + c] += side * (double)d[c];
    bond_in_box(m->r, m->pairs + 2 * end, residues_box(s), d);
    for (int c = 0; c < 3; ++c) r[3 * m->pairs[2 * end + 1] + c] += by_end * (double)d[c];
}

/** A link in the middle, and the bond of an atom that has no other, second in its pair. */
static void choose(const residues *s, int64_t *link, int64_t *end)
{
    const molecule *m = &s->m;
    int *bonds = calloc((size_t)m->n_atoms, sizeof *bonds);
    for (int64_t e = 0; e < 2 * m->n_bonds; ++e) ++bonds[m->pairs[e]];
    *link = *end = -1;
    for (int64_t k = 0; k < m->n_bonds; ++k) {
        if (residues_link(s, k) && (*link < 0 || k < m->n_bonds / 2)) *link = k;
        if (bonds[m->pairs[2 * k + 1]] == 1 && k < m->n_bonds * 3 / 4) *end = k;
    }
    free(bonds);
    assert_true(*link >= 0 && *end >= 0);
}

static void tell_worst(residues *s)
{
    const molecule *m = &s->m;
    const size_t n = (size_t)m->n_bonds, size = 3 * (size_t)m->n_atoms;
    int64_t bond[2], *order = malloc(n * sizeof *order);
    double *residual = untouched(n);
    const residue_recipe *of = s->recipe;
    if (of->order == RESIDUES_IN_LINE && !of->bridges && !of->closed && of->numbers != NUMBERS_ANYHOW && !of->fixed) {
        choose(s, &bond[0], &bond[1]);
        CHECK(hol_chains_bonds(s->chains, 0, order));
        for (int within = 0; within < 2; ++within) {
            double *r = copy_of(m->r, size), *was;
            const double by = within ? 0.02 : 0.03, by_end = within ? -0.03 : -0.02;
            const double error = within ? 1 - 0.97 * 0.97 : 1.03 * 1.03 - 1;
            hol_report report;
            hol_worst worst;
            stretch(s, bond[0], by, bond[1], by_end, r);
            was = copy_of(r, size);
            CHECK(hol_violation(s->chains, r, NULL, &worst));
            CHECK_AT_MOST(fabs(worst.length - error), 1e-8); /* lengths have nine digits */
            assert_int_equal(order[worst.length_bond], bond[within]);
            CHECK(hol_residuals(s->chains, r, NULL, residual, NULL));
            const double rounding = length_rounding(s);
            for (size_t k = 0; k < n; ++k)
                CHECK_AT_MOST(fabs(fabs(residual[k]) - length_error(s, r, (int64_t)k)), 4 * rounding);
            CHECK(hol_chains_set_tolerance(s->chains, 0.5)); /* near enough as they are */
            CHECK(hol_project_positions(s->chains, m->r, r, NULL, 1, NULL, 0, NULL, &report));
            assert_same_bits(r, was, size);
            assert_int_equal(report.n_corrected, 0);
            assert_int_equal(report.molecule, 0);
            assert_int_equal(order[report.bond], bond[within]);
            CHECK_AT_MOST(fabs(report.max_error - worst.length), 4 * length_rounding(s));
            CHECK(hol_chains_set_tolerance(s->chains, 0));
            CHECK(hol_project_positions(s->chains, m->r, r, NULL, 1, NULL, 0, NULL, &report));
            assert_int_equal(report.n_corrected, 1);
            check_lengths(s, r);
            free(r), free(was);
        }
    }
    free(order), free(residual);
}
static void the_worst_bond_is_told_be_it_a_link_or_not(void **state)
{
    (void)state;
    for_each_residues(LARGE / 2, 1, tell_worst);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bonds_get_their_lengths_by_the_forces_that_lambda_says),
        cmocka_unit_test(positions_agree_with_newton_in_many_digits),
        cmocka_unit_test(large_steps_and_poor_guesses_end_on_the_constraints),
        cmocka_unit_test(bond_vectors_do_as_well_as_reference_positions),
        cmocka_unit_test(a_tolerance_is_kept_and_the_worst_bond_told),
        cmocka_unit_test(the_worst_bond_is_told_be_it_a_link_or_not),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
