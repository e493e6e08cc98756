/** What a set was given, what became of it, and copies that are changed apart from it. */
#include "check.h"

/* A square with its diagonals, whose six distances depend on each other; a bond at it; one between two fixed atoms. */
static const double mass[7] = {1, 1, 1, 1, 2, INFINITY, 0};
static const int64_t pairs[16] = {0, 1, 2, 1, 2, 3, 0, 3, 0, 2, 1, 3, 4, 3, 6, 5};
static const double side = 1, diagonal = 1.4142135623730951;

static hol_chains *square(hol_bodies which, int expected)
{
    const double lengths[8] = {side, side, side, side, diagonal, diagonal, 1.5, 3};
    hol_chains *chains;
    CHECK(hol_chains_create(7, mass, &chains));
    CHECK(hol_chains_set_bodies(chains, which));
    assert_int_equal(hol_chains_add_bonds(chains, 8, pairs, lengths), expected);
    return chains;
}

static void every_bond_has_a_role(void **state)
{
    (void)state;
    hol_chains *chains = square(HOL_BODIES_FOUND, HOL_OK);
    int roles[8];
    int64_t removed[1], found[16];
    double lengths[8], masses[7];
    CHECK(hol_chains_roles(chains, roles, removed));
    for (int k = 0; k < 6; ++k) assert_int_equal(roles[k], HOL_ROLE_BODY);
    assert_int_equal(roles[6], HOL_ROLE_OWN);
    assert_int_equal(roles[7], HOL_ROLE_FIXED);
    assert_int_equal(removed[0], 7);
    assert_int_equal(hol_chains_degrees_of_freedom(chains, 3), 15 - 7);
    CHECK(hol_chains_pairs(chains, found));
    assert_true(found[2] == 1 && found[3] == 2);   /* of a body: the lower one first */
    assert_true(found[14] == 6 && found[15] == 5); /* as it was given */
    CHECK(hol_chains_lengths(chains, lengths));
    assert_true(lengths[4] == diagonal && lengths[6] == 1.5 && lengths[7] == 3);
    CHECK(hol_chains_masses(chains, masses));
    assert_true(memcmp(masses, mass, sizeof mass) == 0);
    CHECK(hol_chains_roles(chains, NULL, NULL));
    CHECK_FAILS(HOL_ERR_NULL, hol_chains_roles(NULL, roles, NULL));
    hol_chains_destroy(chains);
}

static void bodies_of_distances_may_be_refused(void **state)
{
    (void)state;
    hol_chains *chains = square(HOL_BODIES_GIVEN, HOL_ERR_DEGENERATE);
    assert_int_equal(hol_chains_n_bonds(chains), 0);
    CHECK(hol_chains_set_bodies(chains, HOL_BODIES_FOUND));
    CHECK_FAILS(HOL_ERR_VALUE, hol_chains_set_bodies(chains, (hol_bodies)2));
    CHECK_FAILS(HOL_ERR_NULL, hol_chains_set_bodies(NULL, HOL_BODIES_GIVEN));
    hol_chains_destroy(chains);
}

static void a_copy_is_changed_apart_and_gives_the_same(void **state)
{
    (void)state;
    hol_chains *chains = square(HOL_BODIES_FOUND, HOL_OK), *copy;
    const double cube[9] = {9, 0, 0, 0, 9, 0, 0, 0, 9};
    const double r[21] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 2.5, 0, 5, 5, 5, 5, 5, 8};
    double f[21], g[2][21] = {{0}}, box[9], lengths[8];
    for (int i = 0; i < 21; ++i) f[i] = 0.3 * i - 0.02 * i * i;
    CHECK(hol_chains_copy(chains, &copy));
    CHECK(hol_forces(chains, r, NULL, f, NULL, NULL, g[0], HOL_WRITE, NULL));
    CHECK(hol_chains_set_box(copy, cube));
    CHECK(hol_chains_set_length(copy, 6, 1.25));
    CHECK(hol_chains_lengths(chains, lengths));
    assert_true(lengths[6] == 1.5);
    CHECK(hol_chains_lengths(copy, lengths));
    assert_true(lengths[6] == 1.25);
    CHECK(hol_chains_box(chains, HOL_BOX, box));
    assert_true(box[0] == 0);
    CHECK(hol_chains_box(copy, HOL_REFERENCE_BOX, box));
    assert_true(memcmp(box, cube, sizeof box) == 0);
    hol_chains_destroy(chains);
    CHECK(hol_forces(copy, r, NULL, f, NULL, NULL, g[1], HOL_WRITE, NULL));
    assert_same_bits(g[0], g[1], 21);
    CHECK_FAILS(HOL_ERR_INDEX, hol_chains_set_length(copy, 8, 1));
    CHECK_FAILS(HOL_ERR_VALUE, hol_chains_set_length(copy, 6, -1));
    CHECK_FAILS(HOL_ERR_VALUE, hol_chains_box(copy, (hol_which_box)2, box));
    CHECK_FAILS(HOL_ERR_NULL, hol_chains_copy(NULL, &chains));
    assert_null(chains);
    hol_chains_destroy(copy);
}

/* Two handles in turns: each tells of its own reference. */
/* Every setter has a question; the square is a body, the last molecule of a set that has chains, too. */
static void what_was_set_can_be_asked(void **state)
{
    (void)state;
    hol_chains *chains, *copy;
    const double masses[9] = {1, 1, 1, 1, 2, INFINITY, 0, 3, 3};
    const double lengths[8] = {side, side, side, side, diagonal, diagonal, 1.5, 3}, one = 1;
    const double rate[9] = {0, 0.1, 0, 0, 0, 0, 0.3, 0, -0.1};
    const int64_t pair[2] = {8, 9};
    int64_t from_one[16], atoms[9], molecules[2], labels[9];
    unsigned char active[2] = {1, 0}, found[2] = {7, 7};
    double L[9];
    for (int i = 0; i < 16; ++i) from_one[i] = pairs[i] + 1;
    for (int i = 0; i < 9; ++i) labels[i] = 1000 + i;
    CHECK(hol_chains_create(9, masses, &chains));
    assert_int_equal(hol_chains_index_base(chains), 0);
    assert_int_equal(hol_chains_bodies(chains), HOL_BODIES_FOUND);
    assert_int_equal(hol_chains_checks(chains), HOL_AT_START);
    assert_int_equal(hol_chains_threads(chains), 1);
    assert_int_equal(hol_chains_outcomes(chains), 0);
    assert_int_equal(hol_chains_max_iterations(chains), 50);
    assert_int_equal(hol_chains_memory_limit(chains), 0);
    assert_true(hol_chains_tolerance(chains) == 0 && hol_chains_length_tolerance(chains) == 1e-3);
    CHECK(hol_chains_box_rate(chains, L));
    for (int i = 0; i < 9; ++i) assert_true(L[i] == 0);
    CHECK(hol_chains_set_index_base(chains, 1));
    CHECK(hol_chains_set_length_tolerance(chains, 2e-3));
    CHECK(hol_chains_add_bonds(chains, 8, from_one, lengths));
    CHECK(hol_chains_add_bonds(chains, 1, pair, &one));
    CHECK(hol_chains_active(chains, found));
    assert_true(found[0] == 1 && found[1] == 1);
    CHECK(hol_chains_labels(chains, atoms, molecules));
    assert_true(atoms[0] == 1 && atoms[8] == 9 && molecules[0] == 1 && molecules[1] == 2);
    CHECK(hol_chains_set_bodies(chains, HOL_BODIES_GIVEN));
    CHECK(hol_chains_set_checks(chains, HOL_NEVER));
    CHECK(hol_chains_set_threads(chains, 3));
    CHECK(hol_chains_set_outcomes(chains, 1));
    CHECK(hol_chains_set_max_iterations(chains, 7));
    CHECK(hol_chains_set_memory_limit(chains, INT64_C(1) << 40));
    CHECK(hol_chains_set_tolerance(chains, 1e-9));
    CHECK(hol_chains_set_box_rate(chains, rate));
    CHECK(hol_chains_set_active(chains, active));
    CHECK(hol_chains_set_labels(chains, labels, NULL));
    CHECK(hol_chains_copy(chains, &copy));
    hol_chains_destroy(chains);
    assert_int_equal(hol_chains_index_base(copy), 1);
    assert_int_equal(hol_chains_bodies(copy), HOL_BODIES_GIVEN);
    assert_int_equal(hol_chains_checks(copy), HOL_NEVER);
    assert_int_equal(hol_chains_threads(copy), 3);
    assert_int_equal(hol_chains_outcomes(copy), 1);
    assert_int_equal(hol_chains_max_iterations(copy), 7);
    assert_true(hol_chains_memory_limit(copy) == INT64_C(1) << 40);
    assert_true(hol_chains_tolerance(copy) == 1e-9 && hol_chains_length_tolerance(copy) == 2e-3);
    CHECK(hol_chains_box_rate(copy, L));
    for (int i = 0; i < 9; ++i) assert_true(L[i] == rate[i]);
    CHECK(hol_chains_active(copy, found));
    assert_true(found[0] == 1 && found[1] == 0);
    CHECK(hol_chains_labels(copy, atoms, molecules));
    assert_true(memcmp(atoms, labels, sizeof atoms) == 0 && molecules[1] == 2);
    CHECK(hol_chains_labels(copy, NULL, NULL));
    CHECK_FAILS(HOL_ERR_NULL, hol_chains_active(copy, NULL));
    CHECK_FAILS(HOL_ERR_NULL, hol_chains_box_rate(copy, NULL));
    CHECK_FAILS(HOL_ERR_NULL, hol_chains_labels(NULL, atoms, NULL));
    assert_true(hol_chains_threads(NULL) == 0 && hol_chains_tolerance(NULL) == 0 && hol_chains_index_base(NULL) == 0);
    hol_chains_destroy(copy);
}

static void the_error_of_a_reference_is_that_of_its_handle(void **state)
{
    (void)state;
    const double two[2] = {1, 1}, length = 1;
    hol_chains *handle[2];
    double error;
    for (int h = 0; h < 2; ++h) {
        CHECK(hol_chains_create(2, two, handle + h));
        CHECK(hol_chains_add_block(handle[h], 1, 1, 0, &length));
        CHECK_FAILS(HOL_ERR_STATE, hol_reference_error(handle[h], &error, NULL, NULL));
    }
    for (int h = 0; h < 2; ++h) {
        double r[6] = {0, 0, 0, 1 + 0.01 * (h + 1), 0, 0};
        CHECK(hol_project_positions(handle[h], r, r, NULL, 1, NULL, 0, NULL, NULL));
    }
    for (int h = 0; h < 2; ++h) {
        const double d = 1 + 0.01 * (h + 1);
        CHECK(hol_reference_error(handle[h], &error, NULL, NULL));
        CHECK_AT_MOST(fabs(error - (d * d - 1)), 1e-15);
        hol_chains_destroy(handle[h]);
    }
    CHECK_FAILS(HOL_ERR_NULL, hol_reference_error(NULL, &error, NULL, NULL));
}

/* A process without atoms calls what all others call. */
static void nothing_needs_no_pointers(void **state)
{
    (void)state;
    hol_chains *none;
    double virial[9] = {7}, energy = 7;
    hol_report report;
    hol_worst worst;
    CHECK(hol_chains_create(0, NULL, &none));
    CHECK(hol_chains_add_rigid(none, 0, NULL, NULL, NULL, 0, NULL, NULL));
    CHECK(hol_chains_set_lengths(none, NULL));
    CHECK(hol_chains_set_masses(none, NULL));
    CHECK(hol_forces(none, NULL, NULL, NULL, NULL, NULL, NULL, HOL_WRITE, virial));
    assert_true(virial[0] == 0);
    CHECK(hol_forces_view(none, NULL, NULL, NULL, NULL, NULL, NULL, HOL_WRITE, virial));
    CHECK(hol_solve(none, NULL, NULL, NULL, NULL, HOL_WRITE, NULL));
    CHECK(hol_project_velocities(none, NULL, NULL, NULL, NULL));
    CHECK(hol_project_positions(none, NULL, NULL, NULL, 1, NULL, 0, NULL, &report));
    CHECK(hol_project_positions_along(none, NULL, NULL, NULL, 1, NULL, 0, NULL, NULL));
    CHECK(hol_impose(none, NULL, &report));
    CHECK(hol_violation(none, NULL, NULL, &worst));
    CHECK(hol_residuals(none, NULL, NULL, NULL, NULL));
    CHECK(hol_metric(none, NULL, 1, NULL, NULL, &energy, NULL, HOL_WRITE));
    CHECK(hol_reactions(none, NULL, HOL_BOX, NULL, NULL, NULL, HOL_WRITE, NULL, NULL));
    CHECK(hol_chains_pairs(none, NULL));
    hol_chains_destroy(none);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_bond_has_a_role),
        cmocka_unit_test(what_was_set_can_be_asked),
        cmocka_unit_test(bodies_of_distances_may_be_refused),
        cmocka_unit_test(a_copy_is_changed_apart_and_gives_the_same),
        cmocka_unit_test(the_error_of_a_reference_is_that_of_its_handle),
        cmocka_unit_test(nothing_needs_no_pointers),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
