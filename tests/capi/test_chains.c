/** Making sets of chains: what goes in comes out, what is wrong is refused and changes nothing. */
#include "check.h"
#include "random.h"

static hol_chains *make(int64_t n_atoms)
{
    double *m = calloc((size_t)n_atoms + 1, sizeof *m);
    for (int64_t i = 0; i < n_atoms; ++i) m[i] = 1;
    hol_chains *c = NULL;
    CHECK(hol_chains_create(n_atoms, m, &c));
    assert_non_null(c);
    free(m);
    return c;
}

static void assert_counts(const hol_chains *c, int64_t atoms, int64_t chains, int64_t bonds)
{
    assert_int_equal(hol_chains_n_atoms(c), atoms);
    assert_int_equal(hol_chains_n_molecules(c), chains);
    assert_int_equal(hol_chains_n_bonds(c), bonds);
}

static void a_new_set_is_empty_and_can_be_used(void **state)
{
    (void)state;
    hol_chains *c = make(5);
    int64_t offsets[1] = {-7};
    assert_counts(c, 5, 0, 0);
    CHECK(hol_chains_offsets(c, offsets));
    assert_int_equal(offsets[0], 0);
    assert_int_equal(hol_chains_degrees_of_freedom(c, 3), 15);
    double r[15], virial[9], lambda[1] = {3};
    for (int i = 0; i < 15; ++i) r[i] = NAN;
    CHECK(hol_forces(c, r, NULL, NULL, lambda, NULL, NULL, HOL_WRITE, virial));
    for (int i = 0; i < 9; ++i) assert_true(virial[i] == 0);
    assert_true(lambda[0] == 3);
    hol_chains_destroy(c);
}

static void a_set_without_atoms_is_allowed(void **state)
{
    (void)state;
    hol_chains *c = NULL;
    double none = 0;
    CHECK(hol_chains_create(0, &none, &c));
    assert_counts(c, 0, 0, 0);
    hol_chains_destroy(c);
}

static void chains_come_out_as_they_went_in(void **state)
{
    (void)state;
    hol_chains *c = make(20);
    const int64_t first[4] = {7, 3, 19, 0}, second[2] = {4, 12};
    const double lengths[3] = {1, 2, 3};
    int64_t atoms[4], offsets[6];
    CHECK(hol_chains_add(c, 3, first, lengths));
    CHECK(hol_chains_add(c, 1, second, lengths));
    CHECK(hol_chains_add_block(c, 3, 1, 13, lengths));
    assert_counts(c, 20, 5, 7);
    CHECK(hol_chains_offsets(c, offsets));
    const int64_t expected[6] = {0, 3, 4, 5, 6, 7};
    for (int i = 0; i < 6; ++i) assert_int_equal(offsets[i], expected[i]);
    CHECK(hol_chains_atoms(c, 0, atoms));
    for (int i = 0; i < 4; ++i) assert_int_equal(atoms[i], first[i]);
    CHECK(hol_chains_atoms(c, 4, atoms));
    assert_int_equal(atoms[0], 17);
    assert_int_equal(atoms[1], 18);
    hol_chains_destroy(c);
}

static void numbers_may_count_from_one(void **state)
{
    (void)state;
    hol_chains *c = make(9);
    const int64_t first[3] = {1, 9, 2}, zero[2] = {0, 3}, ten[2] = {10, 3};
    const double lengths[2] = {1, 1};
    int64_t atoms[3], offsets[4];
    CHECK(hol_chains_set_index_base(c, 1));
    CHECK_FAILS(HOL_ERR_INDEX, hol_chains_add(c, 1, zero, lengths));
    CHECK_FAILS(HOL_ERR_INDEX, hol_chains_add(c, 1, ten, lengths));
    CHECK(hol_chains_add(c, 2, first, lengths));
    CHECK_FAILS(HOL_ERR_INDEX, hol_chains_add_block(c, 1, 1, 0, lengths));
    CHECK(hol_chains_add_block(c, 2, 1, 3, lengths));
    CHECK(hol_chains_offsets(c, offsets));
    assert_int_equal(offsets[0], 1);
    assert_int_equal(offsets[3], 5);
    CHECK(hol_chains_atoms(c, 1, atoms));
    for (int i = 0; i < 3; ++i) assert_int_equal(atoms[i], first[i]);
    CHECK(hol_chains_atoms(c, 3, atoms));
    assert_int_equal(atoms[0], 5);
    CHECK_FAILS(HOL_ERR_INDEX, hol_chains_atoms(c, 0, atoms));
    CHECK_FAILS(HOL_ERR_INDEX, hol_chains_atoms(c, 4, atoms));
    CHECK_FAILS(HOL_ERR_STATE, hol_chains_set_index_base(c, 0)); /* numbers keep their meaning */
    CHECK(hol_chains_set_index_base(c, 1));
    CHECK(hol_chains_atoms(c, 1, atoms));
    for (int i = 0; i < 3; ++i) assert_int_equal(atoms[i], first[i]);
    hol_chains_destroy(c);
}

static void create_refuses_wrong_arguments(void **state)
{
    (void)state;
    double masses[3] = {1, 2, 3};
    hol_chains *c = (hol_chains *)masses;
    CHECK_FAILS(HOL_ERR_NULL, hol_chains_create(3, masses, NULL));
    CHECK_FAILS(HOL_ERR_NULL, hol_chains_create(3, NULL, &c));
    assert_null(c);
    CHECK_FAILS(HOL_ERR_VALUE, hol_chains_create(-1, masses, &c));
    const double wrong[] = {-1, -0x1p-1074, NAN, -INFINITY, 0x1p-1074};
    for (int i = 0; i < 5; ++i) {
        int64_t atom = -5;
        masses[2] = wrong[i];
        c = (hol_chains *)masses;
        CHECK_FAILS(HOL_ERR_VALUE, hol_chains_create(3, masses, &c));
        assert_null(c);
        assert_message_names("2");
        hol_error_location(NULL, NULL, &atom, NULL);
        assert_int_equal(atom, 2);
    }
    const double odd[] = {0, INFINITY, DBL_MIN, DBL_MAX};
    for (int i = 0; i < 4; ++i) {
        masses[2] = odd[i];
        CHECK(hol_chains_create(3, masses, &c));
        hol_chains_destroy(c);
    }
}

static void create_refuses_sizes_that_no_memory_holds(void **state)
{
    (void)state;
    /* The masses are not read before the memory is there. */
    double mass = 1;
    hol_chains *c = NULL;
    const int status = hol_chains_create(INT64_MAX, &mass, &c);
    assert_true(status == HOL_ERR_MEMORY || status == HOL_ERR_VALUE);
    assert_null(c);
}

static void destroying_null_does_nothing(void **state)
{
    (void)state;
    hol_chains_destroy(NULL);
}

static void options_refuse_wrong_values(void **state)
{
    (void)state;
    hol_chains *c = make(4);
    const double bad[9] = {1, 0, 0, 0, NAN, 0, 0, 0, 1}, flat[9] = {1, 0, 0, 1, 0, 0, 0, 0, 1};
    const double infinite[9] = {1, 0, 0, 0, INFINITY, 0, 0, 0, 1};
    CHECK_FAILS(HOL_ERR_NULL, hol_chains_set_index_base(NULL, 0));
    CHECK_FAILS(HOL_ERR_VALUE, hol_chains_set_index_base(c, 2));
    CHECK_FAILS(HOL_ERR_VALUE, hol_chains_set_index_base(c, -1));
    CHECK_FAILS(HOL_ERR_NULL, hol_chains_set_box(NULL, bad));
    CHECK_FAILS(HOL_ERR_VALUE, hol_chains_set_box(c, bad));
    CHECK_FAILS(HOL_ERR_VALUE, hol_chains_set_box(c, infinite));
    CHECK_FAILS(HOL_ERR_VALUE, hol_chains_set_box(c, flat));
    CHECK(hol_chains_set_box(c, NULL));
    CHECK_FAILS(HOL_ERR_NULL, hol_chains_set_threads(NULL, 1));
    CHECK_FAILS(HOL_ERR_VALUE, hol_chains_set_threads(c, 0));
    CHECK_FAILS(HOL_ERR_VALUE, hol_chains_set_threads(c, -2));
    CHECK_FAILS(HOL_ERR_NULL, hol_chains_set_active(NULL, NULL));
    CHECK(hol_chains_set_active(c, NULL));
    CHECK_FAILS(HOL_ERR_NULL, hol_chains_set_tolerance(NULL, 1e-8));
    CHECK_FAILS(HOL_ERR_VALUE, hol_chains_set_tolerance(c, -1e-8));
    CHECK_FAILS(HOL_ERR_VALUE, hol_chains_set_tolerance(c, NAN));
    CHECK_FAILS(HOL_ERR_VALUE, hol_chains_set_tolerance(c, INFINITY));
    CHECK(hol_chains_set_tolerance(c, 0));
    CHECK_FAILS(HOL_ERR_NULL, hol_chains_set_max_iterations(NULL, 5));
    CHECK_FAILS(HOL_ERR_VALUE, hol_chains_set_max_iterations(c, 0));
    CHECK_FAILS(HOL_ERR_VALUE, hol_chains_set_max_iterations(c, 1001));
    CHECK(hol_chains_set_max_iterations(c, 1000));
    hol_chains_destroy(c);
}

static void getters_take_null(void **state)
{
    (void)state;
    int64_t atoms[4];
    hol_chains *c = make(4);
    assert_counts(NULL, 0, 0, 0);
    assert_int_equal(hol_chains_memory(NULL), 0);
    assert_int_equal(hol_chains_degrees_of_freedom(NULL, 3), -1);
    assert_int_equal(hol_chains_degrees_of_freedom(c, 1), -1);
    assert_int_equal(hol_chains_degrees_of_freedom(c, 4), -1);
    CHECK_FAILS(HOL_ERR_NULL, hol_chains_offsets(NULL, atoms));
    CHECK_FAILS(HOL_ERR_NULL, hol_chains_offsets(c, NULL));
    CHECK_FAILS(HOL_ERR_NULL, hol_chains_atoms(NULL, 0, atoms));
    CHECK_FAILS(HOL_ERR_INDEX, hol_chains_atoms(c, 0, atoms));
    CHECK_FAILS(HOL_ERR_INDEX, hol_chains_atoms(c, -1, atoms));
    const double length = 1;
    CHECK(hol_chains_add_block(c, 1, 1, 0, &length));
    CHECK_FAILS(HOL_ERR_NULL, hol_chains_atoms(c, 0, NULL));
    CHECK_FAILS(HOL_ERR_INDEX, hol_chains_atoms(c, 1, atoms));
    hol_chains_destroy(c);
}

static void degrees_of_freedom_count_what_can_move(void **state)
{
    (void)state;
    /* atoms 0 1 2 | 3 4 | 5; 1 is fixed, 3 and 4 are fixed, so their bond takes away nothing */
    const double masses[6] = {1, 0, 2, 0, INFINITY, 1}, lengths[2] = {1, 1};
    const unsigned char active[2] = {0, 1};
    hol_chains *c;
    CHECK(hol_chains_create(6, masses, &c));
    CHECK(hol_chains_add_block(c, 1, 2, 0, lengths));
    CHECK(hol_chains_add_block(c, 1, 1, 3, lengths));
    assert_int_equal(hol_chains_degrees_of_freedom(c, 3), 3 * 3 - 2);
    assert_int_equal(hol_chains_degrees_of_freedom(c, 2), 2 * 3 - 2);
    CHECK(hol_chains_set_active(c, active));
    assert_int_equal(hol_chains_degrees_of_freedom(c, 3), 3 * 3);
    CHECK(hol_chains_set_active(c, NULL));
    assert_int_equal(hol_chains_degrees_of_freedom(c, 3), 3 * 3 - 2);
    hol_chains_destroy(c);
}

static void memory_grows_with_the_bonds_and_is_modest(void **state)
{
    (void)state;
    const int64_t n = 100000;
    double *masses = malloc(sizeof *masses * 4 * (size_t)n), lengths[3] = {1, 2, 3};
    hol_chains *c;
    for (int64_t i = 0; i < 4 * n; ++i) masses[i] = 1 + 1e-6 * (double)i;
    CHECK(hol_chains_create(4 * n, masses, &c));
    const int64_t before = hol_chains_memory(c);
    CHECK(hol_chains_add_block(c, n, 3, 0, lengths));
    const int64_t after = hol_chains_memory(c);
    assert_true(after >= before);
    assert_true(before >= 8 * 4 * n);                        /* the masses at least, as no two are equal */
    CHECK_AT_MOST((double)after / (3.0 * (double)n), 100.0); /* bytes per bond */
    hol_chains_destroy(c);
    free(masses);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_new_set_is_empty_and_can_be_used),
        cmocka_unit_test(a_set_without_atoms_is_allowed),
        cmocka_unit_test(chains_come_out_as_they_went_in),
        cmocka_unit_test(numbers_may_count_from_one),
        cmocka_unit_test(create_refuses_wrong_arguments),
        cmocka_unit_test(create_refuses_sizes_that_no_memory_holds),
        cmocka_unit_test(destroying_null_does_nothing),
        cmocka_unit_test(options_refuse_wrong_values),
        cmocka_unit_test(getters_take_null),
        cmocka_unit_test(degrees_of_freedom_count_what_can_move),
        cmocka_unit_test(memory_grows_with_the_bonds_and_is_modest),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
