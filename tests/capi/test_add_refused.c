/**
 * Chains, lists of bonds and blocks of molecules: what is refused, with nothing added; blocks are lists of their
 * bonds; questions about what was added; lengths and masses that are refused.
 */
#include "check.h"
#include "random.h"

static hol_chains *make(int64_t n_atoms)
{
    double *m = malloc((size_t)n_atoms * sizeof *m);
    for (int64_t i = 0; i < n_atoms; ++i) m[i] = 1;
    hol_chains *c = NULL;
    CHECK(hol_chains_create(n_atoms, m, &c));
    free(m);
    return c;
}

static void assert_counts(const hol_chains *c, int64_t chains, int64_t bonds)
{
    assert_int_equal(hol_chains_n_molecules(c), chains);
    assert_int_equal(hol_chains_n_bonds(c), bonds);
}

/** A length of zero takes another way, which has to look at the atoms, too. */
static void atoms_are_looked_at_beside_a_length_of_zero(void **state)
{
    (void)state;
    hol_chains *c = make(10);
    const double lengths[2] = {0, 1};
    const int64_t wrong[][2] = {{2, 10}, {2, INT64_MAX}, {-1, 2}, {INT64_MIN, 2}};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; ++i) {
        const int64_t pairs[4] = {0, 1, wrong[i][0], wrong[i][1]}, images[6] = {0};
        CHECK_FAILS(HOL_ERR_INDEX, hol_chains_add_bonds(c, 2, pairs, lengths));
        CHECK_FAILS(HOL_ERR_INDEX, hol_chains_add_molecules(c, 1, 10, 0, 2, pairs, lengths));
        assert_int_not_equal(hol_chains_add_bonds_with_images(c, 2, pairs, lengths, images), HOL_OK);
    }
    const int64_t itself[4] = {0, 1, 2, 2}, at_zero[4] = {3, 3, 0, 1};
    CHECK_FAILS(HOL_ERR_VALUE, hol_chains_add_bonds(c, 2, itself, lengths));
    CHECK_FAILS(HOL_ERR_VALUE, hol_chains_add_bonds(c, 2, at_zero, lengths));
    assert_counts(c, 0, 0);
    hol_chains_destroy(c);
}

static void add_refuses_wrong_arguments_and_adds_nothing(void **state)
{
    (void)state;
    hol_chains *c = make(10);
    const int64_t good[3] = {0, 1, 2}, low[3] = {0, -1, 2}, high[3] = {0, 1, 10}, twice[3] = {4, 5, 4},
                  far[3] = {0, INT64_MIN, 1};
    const int64_t huge[3] = {3, INT64_MAX, 4}, shared[3] = {6, 7, 1};
    const double lengths[2] = {1, 1};
    CHECK(hol_chains_add(c, 2, good, lengths));
    CHECK_FAILS(HOL_ERR_NULL, hol_chains_add(NULL, 2, good, lengths));
    CHECK_FAILS(HOL_ERR_NULL, hol_chains_add(c, 2, NULL, lengths));
    CHECK_FAILS(HOL_ERR_NULL, hol_chains_add(c, 2, good, NULL));
    CHECK(hol_chains_add(c, 0, NULL, NULL));
    CHECK_FAILS(HOL_ERR_VALUE, hol_chains_add(c, -1, good, lengths));
    CHECK_FAILS(HOL_ERR_INDEX, hol_chains_add(c, 2, low, lengths));
    CHECK_FAILS(HOL_ERR_INDEX, hol_chains_add(c, 2, high, lengths));
    CHECK_FAILS(HOL_ERR_INDEX, hol_chains_add(c, 2, far, lengths));
    CHECK_FAILS(HOL_ERR_INDEX, hol_chains_add(c, 2, huge, lengths));
    CHECK_FAILS(HOL_ERR_SHARED_ATOM, hol_chains_add(c, 2, twice, lengths));
    assert_message_names("4");
    CHECK_FAILS(HOL_ERR_SHARED_ATOM, hol_chains_add(c, 2, shared, lengths));
    assert_message_names("1");
    CHECK_FAILS(HOL_ERR_SHARED_ATOM, hol_chains_add(c, 2, good, lengths));
    const double wrong[] = {0, -1, NAN, INFINITY, -INFINITY};
    const int64_t others[3] = {7, 8, 9};
    for (int i = 0; i < 5; ++i) {
        const double bad[2] = {1, wrong[i]};
        CHECK_FAILS(HOL_ERR_VALUE, hol_chains_add(c, 2, others, bad));
        CHECK_FAILS(HOL_ERR_VALUE, hol_chains_add_block(c, 1, 2, 7, bad));
    }
    assert_counts(c, 1, 2);
    /* An atom that a refused chain named is free. */
    const int64_t again[7] = {4, 5, 6, 7, 8, 9, 3};
    const double six[6] = {1, 1, 1, 1, 1, 1};
    CHECK(hol_chains_add(c, 6, again, six));
    assert_counts(c, 2, 8);
    hol_chains_destroy(c);
}

static void add_block_refuses_wrong_arguments_and_adds_nothing(void **state)
{
    (void)state;
    hol_chains *c = make(10);
    const double lengths[3] = {1, 1, 1};
    CHECK_FAILS(HOL_ERR_NULL, hol_chains_add_block(NULL, 1, 1, 0, lengths));
    CHECK_FAILS(HOL_ERR_NULL, hol_chains_add_block(c, 1, 1, 0, NULL));
    CHECK(hol_chains_add_block(c, 0, 1, 0, NULL));
    CHECK(hol_chains_add_block(c, 1, 0, 0, NULL));
    CHECK_FAILS(HOL_ERR_VALUE, hol_chains_add_block(c, -1, 1, 0, lengths));
    CHECK_FAILS(HOL_ERR_VALUE, hol_chains_add_block(c, 1, -1, 0, lengths));
    CHECK_FAILS(HOL_ERR_INDEX, hol_chains_add_block(c, 1, 1, -1, lengths));
    CHECK_FAILS(HOL_ERR_INDEX, hol_chains_add_block(c, 1, 1, 9, lengths));
    CHECK_FAILS(HOL_ERR_INDEX, hol_chains_add_block(c, 3, 3, 0, lengths));
    CHECK_FAILS(HOL_ERR_INDEX, hol_chains_add_block(c, INT64_MAX, 3, 0, lengths));
    CHECK_FAILS(HOL_ERR_INDEX, hol_chains_add_block(c, INT64_MAX / 2, 1, 0, lengths));
    CHECK_FAILS(HOL_ERR_INDEX, hol_chains_add_block(c, 1, 1, INT64_MAX, lengths));
    CHECK(hol_chains_add_block(c, 1, 1, 4, lengths));
    CHECK_FAILS(HOL_ERR_SHARED_ATOM, hol_chains_add_block(c, 2, 2, 0, lengths));
    assert_counts(c, 1, 1);
    CHECK(hol_chains_add_block(c, 1, 3, 0, lengths));
    CHECK(hol_chains_add_block(c, 2, 1, 6, lengths));
    assert_counts(c, 4, 6);
    hol_chains_destroy(c);
}

static void wrong_bonds_are_refused_and_nothing_is_added(void **state)
{
    (void)state;
    hol_chains *c = make(10);
    const double ones[12] = {1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1};
    const int64_t good[4] = {1, 0, 2, 1}, low[4] = {5, 6, -1, 7}, high[4] = {5, 6, 10, 7},
                  far[4] = {INT64_MIN, 5, 5, 6}, huge[4] = {5, INT64_MAX, 5, 6}, self[4] = {5, 6, 7, 7},
                  twice[6] = {5, 6, 7, 8, 6, 5}, joins[4] = {5, 6, 6, 2};
    CHECK(hol_chains_add_bonds(c, 2, good, ones));
    CHECK_FAILS(HOL_ERR_NULL, hol_chains_add_bonds(NULL, 2, good, ones));
    CHECK_FAILS(HOL_ERR_NULL, hol_chains_add_bonds(c, 2, NULL, ones));
    CHECK_FAILS(HOL_ERR_NULL, hol_chains_add_bonds(c, 2, good, NULL));
    CHECK(hol_chains_add_bonds(c, 0, NULL, NULL));
    CHECK_FAILS(HOL_ERR_VALUE, hol_chains_add_bonds(c, -1, good, ones));
    CHECK_FAILS(HOL_ERR_VALUE, hol_chains_add_bonds(c, INT64_MAX, good, ones));
    CHECK_FAILS(HOL_ERR_INDEX, hol_chains_add_bonds(c, 2, low, ones));
    assert_message_names("bond 1");
    CHECK_FAILS(HOL_ERR_INDEX, hol_chains_add_bonds(c, 2, high, ones));
    CHECK_FAILS(HOL_ERR_INDEX, hol_chains_add_bonds(c, 2, far, ones));
    CHECK_FAILS(HOL_ERR_INDEX, hol_chains_add_bonds(c, 2, huge, ones));
    CHECK_FAILS(HOL_ERR_VALUE, hol_chains_add_bonds(c, 2, self, ones));
    int64_t bond, atom;
    hol_error_location(NULL, &bond, NULL, NULL);
    assert_int_equal(bond, 1);
    CHECK_FAILS(HOL_ERR_DEGENERATE, hol_chains_add_bonds(c, 3, twice, ones));
    hol_error_location(NULL, &bond, NULL, NULL);
    assert_int_equal(bond, 2);
    CHECK_FAILS(HOL_ERR_SHARED_ATOM, hol_chains_add_bonds(c, 2, joins, ones));
    hol_error_location(NULL, NULL, &atom, NULL);
    assert_int_equal(atom, 2);
    assert_message_names("atom 2");
    const int64_t linear[3] = {4, 3, 2};
    CHECK_FAILS(HOL_ERR_SHARED_ATOM, hol_chains_add(c, 2, linear, ones));
    assert_message_names("hol_chains_add: atom 2");
    const double wrong[] = {-1, NAN, INFINITY, 1e-160, 1e160};
    const int64_t free_pair[4] = {5, 6, 7, 8};
    for (int i = 0; i < 5; ++i) {
        const double bad[2] = {1, wrong[i]};
        CHECK_FAILS(HOL_ERR_VALUE, hol_chains_add_bonds(c, 2, free_pair, bad));
        assert_message_names("bond 1");
    }
    assert_counts(c, 1, 2);
    const int64_t rest[12] = {9, 3, 3, 4, 4, 5, 5, 6, 6, 7, 7, 8}; /* whatever a refused list named is free */
    CHECK(hol_chains_add_bonds(c, 6, rest, ones));
    assert_counts(c, 2, 8);
    hol_chains_destroy(c);
}

static void blocks_of_molecules_are_lists_of_their_bonds(void **state)
{
    (void)state;
    /* propane without hydrogens and a virtual site behind it: atoms 2 .. 9, twice four */
    const int64_t pairs[4] = {2, 1, 0, 1}, all[8] = {4, 3, 2, 3, 8, 7, 6, 7};
    const double lengths[2] = {1.5, 1.25}, both[4] = {1.5, 1.25, 1.5, 1.25};
    double masses[11], r[33], f[33], l1[4], l2[4];
    random_stream stream = random_seed(3);
    for (int i = 0; i < 11; ++i) masses[i] = 1 + i % 4;
    for (int i = 0; i < 33; ++i) r[i] = random_normal(&stream), f[i] = random_normal(&stream);
    hol_chains *a, *b;
    CHECK(hol_chains_create(11, masses, &a));
    CHECK(hol_chains_create(11, masses, &b));
    CHECK(hol_chains_add_molecules(a, 2, 4, 2, 2, pairs, lengths));
    CHECK(hol_chains_add_bonds(b, 4, all, both));
    assert_counts(a, 2, 4);
    assert_int_equal(hol_chains_n_kinds(a), hol_chains_n_kinds(b));
    CHECK(hol_forces(a, r, NULL, f, l1, NULL, NULL, HOL_WRITE, NULL));
    CHECK(hol_forces(b, r, NULL, f, l2, NULL, NULL, HOL_WRITE, NULL));
    assert_same_bits(l1, l2, 4);
    int64_t bonds[2], atoms[3], molecule[4];
    CHECK(hol_chains_bonds(a, 1, bonds));
    CHECK(hol_chains_atoms(a, 1, atoms));
    CHECK(hol_chains_molecules_of_bonds(a, molecule));
    assert_true(bonds[0] == 3 && bonds[1] == 2 && atoms[0] == 6 && atoms[1] == 7 && atoms[2] == 8);
    assert_true(molecule[0] == 0 && molecule[1] == 0 && molecule[2] == 1 && molecule[3] == 1);
    hol_chains_destroy(a), hol_chains_destroy(b);
}

static void wrong_blocks_are_refused_and_nothing_is_added(void **state)
{
    (void)state;
    hol_chains *c = make(10);
    const int64_t pairs[4] = {0, 1, 1, 2}, outside[4] = {0, 1, 1, 3}, below[4] = {0, 1, -1, 2};
    const double lengths[2] = {1, 1}, bad[2] = {1, -1};
    CHECK_FAILS(HOL_ERR_NULL, hol_chains_add_molecules(NULL, 1, 3, 0, 2, pairs, lengths));
    CHECK_FAILS(HOL_ERR_NULL, hol_chains_add_molecules(c, 1, 3, 0, 2, NULL, lengths));
    CHECK_FAILS(HOL_ERR_NULL, hol_chains_add_molecules(c, 1, 3, 0, 2, pairs, NULL));
    CHECK(hol_chains_add_molecules(c, 0, 3, 0, 2, NULL, NULL));
    CHECK_FAILS(HOL_ERR_VALUE, hol_chains_add_molecules(c, 1, 1, 0, 2, pairs, lengths));
    CHECK(hol_chains_add_molecules(c, 1, 3, 0, 0, NULL, NULL));
    CHECK_FAILS(HOL_ERR_VALUE, hol_chains_add_molecules(c, 1, 3, 0, INT64_MAX, pairs, lengths));
    CHECK_FAILS(HOL_ERR_VALUE, hol_chains_add_molecules(c, INT64_MAX, 3, 0, 2, pairs, lengths));
    CHECK_FAILS(HOL_ERR_VALUE, hol_chains_add_molecules(c, 1, 3, 0, 2, pairs, bad));
    CHECK_FAILS(HOL_ERR_INDEX, hol_chains_add_molecules(c, 4, 3, 0, 2, pairs, lengths));
    CHECK_FAILS(HOL_ERR_INDEX, hol_chains_add_molecules(c, 1, 3, 8, 2, pairs, lengths));
    CHECK_FAILS(HOL_ERR_INDEX, hol_chains_add_molecules(c, 1, 3, -1, 2, pairs, lengths));
    CHECK_FAILS(HOL_ERR_INDEX, hol_chains_add_molecules(c, 1, INT64_MAX, 0, 2, pairs, lengths));
    CHECK_FAILS(HOL_ERR_INDEX, hol_chains_add_molecules(c, 1, 3, 0, 2, outside, lengths));
    CHECK_FAILS(HOL_ERR_INDEX, hol_chains_add_molecules(c, 1, 3, 0, 2, below, lengths));
    assert_counts(c, 0, 0);
    CHECK(hol_chains_add_molecules(c, 1, 3, 7, 2, pairs, lengths));
    CHECK_FAILS(HOL_ERR_SHARED_ATOM, hol_chains_add_molecules(c, 3, 3, 0, 2, pairs, lengths));
    assert_counts(c, 1, 2);
    hol_chains_destroy(c);
}

static void queries_refuse_wrong_arguments(void **state)
{
    (void)state;
    hol_chains *c = make(6);
    const int64_t pairs[4] = {0, 1, 3, 4};
    const double lengths[2] = {1, 1};
    int64_t out[4];
    int shape = -1;
    CHECK(hol_chains_add_bonds(c, 2, pairs, lengths));
    CHECK_FAILS(HOL_ERR_NULL, hol_chains_molecule(NULL, 0, &shape, out, out));
    CHECK_FAILS(HOL_ERR_INDEX, hol_chains_molecule(c, 2, &shape, out, out));
    CHECK_FAILS(HOL_ERR_INDEX, hol_chains_molecule(c, -1, &shape, out, out));
    CHECK_FAILS(HOL_ERR_INDEX, hol_chains_molecule(c, INT64_MIN, &shape, out, out));
    assert_int_equal(shape, -1);
    CHECK_FAILS(HOL_ERR_NULL, hol_chains_bonds(NULL, 0, out));
    CHECK_FAILS(HOL_ERR_NULL, hol_chains_bonds(c, 0, NULL));
    CHECK_FAILS(HOL_ERR_INDEX, hol_chains_bonds(c, 2, out));
    CHECK_FAILS(HOL_ERR_NULL, hol_chains_molecules_of_bonds(NULL, out));
    CHECK_FAILS(HOL_ERR_NULL, hol_chains_molecules_of_bonds(c, NULL));
    assert_int_equal(hol_chains_n_kinds(NULL), 0);
    assert_int_equal(hol_chains_n_of_shape(NULL, HOL_SHAPE_CHAIN), 0);
    assert_int_equal(hol_chains_n_of_shape(c, 17), 0);
    assert_int_equal(hol_chains_n_of_shape(c, HOL_SHAPE_CHAIN), 2);
    assert_int_equal(hol_chains_n_kinds(c), 1);
    CHECK(hol_chains_molecule(c, 1, NULL, NULL, NULL));
    hol_chains_destroy(c);
}

static void offsets_are_told_only_where_there_are_any(void **state)
{
    (void)state;
    hol_chains *c = make(9);
    const double ones[4] = {1, 1, 1, 1};
    const int64_t good[8] = {0, 1, 1, 2, 3, 4, 4, 5}, reversed[4] = {8, 7, 7, 6};
    int64_t offsets[4] = {-7, -7, -7, -7};
    CHECK(hol_chains_add_bonds(c, 4, good, ones));
    CHECK(hol_chains_offsets(c, offsets));
    assert_true(offsets[0] == 0 && offsets[1] == 2 && offsets[2] == 4 && offsets[3] == -7);
    CHECK(hol_chains_add_bonds(c, 2, reversed, ones));
    offsets[0] = -7;
    CHECK_FAILS(HOL_ERR_VALUE, hol_chains_offsets(c, offsets));
    assert_message_names("molecule 2");
    assert_int_equal(offsets[0], -7);
    hol_chains_destroy(c);
}

static void wrong_lengths_and_masses_change_nothing(void **state)
{
    (void)state;
    const double masses[5] = {1, 2, 0, 4, 5}, lengths[3] = {1, 1.5, 2};
    const int64_t pairs[6] = {3, 2, 1, 0, 4, 3};
    hol_chains *c;
    CHECK(hol_chains_create(5, masses, &c));
    CHECK(hol_chains_add_bonds(c, 3, pairs, lengths));
    double r[15], worst_before, bad_lengths[3] = {1, 1, -1}, bad_masses[5] = {1, 2, 0, 4, NAN};
    for (int i = 0; i < 15; ++i) r[i] = 0.3 * i * i;
    hol_worst worst;
    CHECK(hol_violation(c, r, NULL, &worst));
    worst_before = worst.length;
    CHECK_FAILS(HOL_ERR_NULL, hol_chains_set_lengths(NULL, lengths));
    CHECK_FAILS(HOL_ERR_NULL, hol_chains_set_lengths(c, NULL));
    CHECK_FAILS(HOL_ERR_VALUE, hol_chains_set_lengths(c, bad_lengths));
    assert_message_names("bond 2");
    CHECK_FAILS(HOL_ERR_NULL, hol_chains_set_masses(NULL, masses));
    CHECK_FAILS(HOL_ERR_NULL, hol_chains_set_masses(c, NULL));
    CHECK_FAILS(HOL_ERR_VALUE, hol_chains_set_masses(c, bad_masses));
    assert_message_names("atom 4");
    bad_masses[4] = 5;
    bad_masses[2] = 1; /* it was fixed */
    CHECK_FAILS(HOL_ERR_VALUE, hol_chains_set_masses(c, bad_masses));
    assert_message_names("atom 2");
    bad_masses[2] = INFINITY;
    bad_masses[3] = 0; /* it could move */
    CHECK_FAILS(HOL_ERR_VALUE, hol_chains_set_masses(c, bad_masses));
    assert_message_names("atom 3");
    CHECK(hol_violation(c, r, NULL, &worst));
    assert_true(worst.length == worst_before);
    bad_masses[3] = 7;
    CHECK(hol_chains_set_masses(c, bad_masses));
    hol_chains_destroy(c);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(atoms_are_looked_at_beside_a_length_of_zero),
        cmocka_unit_test(add_refuses_wrong_arguments_and_adds_nothing),
        cmocka_unit_test(add_block_refuses_wrong_arguments_and_adds_nothing),
        cmocka_unit_test(wrong_lengths_and_masses_change_nothing),
        cmocka_unit_test(wrong_bonds_are_refused_and_nothing_is_added),
        cmocka_unit_test(blocks_of_molecules_are_lists_of_their_bonds),
        cmocka_unit_test(wrong_blocks_are_refused_and_nothing_is_added),
        cmocka_unit_test(queries_refuse_wrong_arguments),
        cmocka_unit_test(offsets_are_told_only_where_there_are_any),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
