/** Large molecules of repeating units in boxes: reference positions in another one than those that are projected. */
#include "equations.h"
#include "residue_checks.h"

/** Atoms brought beside those that they hang at: bonds of a molecule that has grown lead from an earlier atom to a
 * later one, those that close a ring aside. */
static double *whole(const residues *s)
{
    double *r = copy_of(s->m.r, 3 * (size_t)s->m.n_atoms);
    char *placed = calloc((size_t)s->m.n_atoms, 1);
    placed[0] = 1;
    for (int64_t k = 0; k < s->m.n_bonds; ++k) {
        const int64_t i = s->m.pairs[2 * k], j = s->m.pairs[2 * k + 1];
        long double d[3];
        assert_true(placed[i]);
        if (placed[j]) continue;
        bond_in_box(s->m.r, s->m.pairs + 2 * k, residues_box(s), d);
        for (int c = 0; c < 3; ++c) r[3 * j + c] = r[3 * i + c] + (double)d[c];
        placed[j] = 1;
    }
    free(placed);
    return r;
}

/** A cell that is larger by a part, and sheared; atoms anywhere among its images. */
static void scatter(const residues *s, double *r, double *cell)
{
    random_stream random = random_seed(3);
    for (int n = 0; n < 9; ++n) cell[n] = s->box[n] * 1.2;
    cell[3] += 0.7, cell[6] -= 0.4, cell[7] += 0.3;
    for (int64_t i = 0; i < s->m.n_atoms; ++i)
        for (int h = 0; h < 3; ++h) {
            const double steps = (double)random_integer(&random, -1, 1);
            for (int c = 0; c < 3; ++c) r[3 * i + c] += steps * cell[3 * h + c];
        }
}

static void project_into(residues *s)
{
    const size_t n = (size_t)s->m.n_bonds, size = 3 * (size_t)s->m.n_atoms;
    residues_project(s);
    const double dt = residues_step(s, 0.04);
    double *start = whole(s), *lambda = untouched(n), cell[9], virial[9], extent = 0;
    for (size_t i = 0; i < size; ++i) start[i] += dt * s->m.v[i];
    scatter(s, start, cell);
    double *r = copy_of(start, size);
    CHECK(hol_chains_set_box(s->chains, cell));
    CHECK(hol_chains_set_reference_box(s->chains, residues_box(s)));
    CHECK(hol_project_positions(s->chains, s->m.r, r, NULL, dt, lambda, 0, virial, NULL));
    check_pulls(s, lambda, NULL, NULL, virial);
    for (size_t i = 0; i < size; ++i) extent = fmax(extent, fabs(r[i]));
    for (size_t k = 0; k < n; ++k) {
        const long double a = s->m.length[k];
        long double d[3];
        bond_in_box(r, s->m.pairs + 2 * k, cell, d);
        CHECK_AT_MOST(fabsl((d[0] * d[0] + d[1] * d[1] + d[2] * d[2]) / (a * a) - 1), 8 * DBL_EPSILON * (1 + extent));
    }
    if (s->m.n_bonds < 500) {
        const molecule_problem p = residues_problem(s);
        molecule_solution exact;
        assert_int_equal(molecule_positions(&p, start, cell, s->m.length, dt, &exact), 0);
        const long double unit = residue_unit(s);
        for (size_t k = 0; k < n; ++k) CHECK_AT_MOST(fabsl(lambda[k] - exact.lambda[k]), unit * exact.lambda_scale[k]);
        for (size_t i = 0; i < size; ++i) CHECK_AT_MOST(fabsl(r[i] - exact.moved[i]), unit * exact.moved_scale[i / 3]);
        molecule_solution_free(&exact);
    }
    free(start), free(lambda), free(r);
}
static void bonds_are_images_each_in_its_own_box(void **state)
{
    (void)state;
    static const int recipes[] = {IN_BOX, IN_TRICLINIC_BOX, -1};
    for_some_residues(recipes, 350, project_into);
    for_some_residues(recipes, quick_run() ? 600 : 2500, project_into);
}

/** A box that nothing reaches changes results by rounding alone; one that is taken away again by nothing. */
static void forget_the_box(residues *s)
{
    const size_t n = (size_t)s->m.n_bonds, size = 3 * (size_t)s->m.n_atoms;
    double *lambda = untouched(n), *boxed = untouched(n), *again = untouched(n), extent = 0, largest = 0;
    for (size_t i = 0; i < size; ++i) extent = fmax(extent, fabs(s->m.r[i]));
    for (size_t k = 0; k < n; ++k) extent = fmax(extent, s->m.length[k]);
    const double box[9] = {3 * extent, 0, 0, 0, 4 * extent, 0, 0, 0, 3 * extent};
    CHECK(hol_forces(s->chains, s->m.r, s->m.v, s->m.f, lambda, NULL, NULL, HOL_WRITE, NULL));
    CHECK(hol_chains_set_box(s->chains, box));
    CHECK(hol_forces(s->chains, s->m.r, s->m.v, s->m.f, boxed, NULL, NULL, HOL_WRITE, NULL));
    CHECK(hol_chains_set_box(s->chains, NULL));
    CHECK(hol_forces(s->chains, s->m.r, s->m.v, s->m.f, again, NULL, NULL, HOL_WRITE, NULL));
    assert_same_bits(again, lambda, n);
    for (size_t k = 0; k < n; ++k) largest = fmax(largest, fabs(lambda[k]));
    for (size_t k = 0; k < n; ++k) /* condition numbers are some hundreds */
        CHECK_AT_MOST(fabs(boxed[k] - lambda[k]), 1000 * DBL_EPSILON * largest * (1 + extent));
    free(lambda), free(boxed), free(again);
}
static void a_box_that_is_taken_away_leaves_no_trace(void **state)
{
    (void)state;
    static const int recipes[] = {RANDOM_SEQUENCE, SHORT_HOMOPOLYMER, CLOSED, COMB, FIXED_ENDS, -1};
    for_some_residues(recipes, quick_run() ? 400 : 1500, forget_the_box);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bonds_are_images_each_in_its_own_box),
        cmocka_unit_test(a_box_that_is_taken_away_leaves_no_trace),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
