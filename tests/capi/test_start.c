/*
 * Mistakes that are made where a program begins: each is an error, at the first call that can know of it, which names
 * atoms and lengths; and nothing is moved.
 */
#include "check.h"
#include "input.h"
#include "water.h"

enum { SIDE = 10, DT = 1 };

static hol_chains *water_set(const waters *w, const double *lengths)
{
    hol_chains *chains;
    CHECK(hol_chains_create(w->n_atoms, w->mass, &chains));
    CHECK(hol_chains_add_molecules(chains, w->n_molecules, 3, 0, 3, water_pairs, lengths));
    return chains;
}

/* The first step with these positions: refused, nothing is written, and the message has these words. */
static void assert_refused(const hol_chains *chains, const waters *w, const char *const *words)
{
    const size_t n = 3 * (size_t)w->n_atoms;
    double *const r = copy_of(w->r, n), *const v = untouched(n), *const lambda = untouched(n);
    double *const virial = untouched(9);
    hol_report report = {-7, -7, -7, -7, -7, -7};
    int64_t molecule, bond, n_bad;
    for (size_t i = 0; i < n; i += 7) r[i] += 1e-3; /* a drift */
    double *const before = copy_of(r, n);
    CHECK_FAILS(HOL_ERR_LENGTHS, hol_project_positions(chains, w->r, r, v, DT, lambda, 0, virial, &report));
    for (; *words; ++words) assert_message_names(*words);
    hol_error_location(&molecule, &bond, NULL, &n_bad);
    assert_in_range(molecule, 0, w->n_molecules - 1);
    assert_in_range(bond, 0, 2);
    assert_true(n_bad >= 1);
    assert_same_bits(r, before, n);
    assert_untouched(v, n);
    assert_untouched(lambda, n);
    assert_untouched(virial, 9);
    assert_true(report.iterations == -7 && report.max_error == -7);
    /* And so again: one call does not let the next one pass. */
    CHECK_FAILS(HOL_ERR_LENGTHS, hol_project_positions(chains, w->r, r, NULL, DT, NULL, 0, NULL, NULL));
    CHECK_FAILS(HOL_ERR_LENGTHS, hol_chains_check(chains, w->r, HOL_BOX));
    assert_same_bits(r, before, n);
    free(r);
    free(before);
    free(v);
    free(lambda);
    free(virial);
}
#define WORDS(...) ((const char *const[]){__VA_ARGS__, NULL})

static void molecules_cut_by_the_cell_without_a_box(void **state)
{
    (void)state;
    waters w = make_waters(SIDE, 1);
    cut_by_the_faces(&w);
    hol_chains *chains = water_set(&w, water_lengths);
    assert_refused(chains, &w, WORDS("atoms ", "no box is set", "cut by a face", "should be 1"));
    CHECK(hol_chains_set_box(chains, w.box));
    CHECK(hol_project_positions(chains, w.r, w.r, NULL, DT, NULL, 0, NULL, NULL));
    hol_chains_destroy(chains);
    free_waters(&w);
}

static void lengths_in_another_unit(void **state)
{
    (void)state;
    waters w = make_waters(4, 2);
    for (int which = 0; which < 2; ++which) {
        const double unit = which ? 10 : 0.1;
        const double lengths[3] = {unit * WATER_OH, unit * WATER_OH, unit * WATER_HH};
        hol_chains *chains = water_set(&w, lengths);
        assert_refused(chains, &w, WORDS("atoms ", which ? "about 0.1 times" : "about 10 times", "same unit"));
        if (!which) CHECK(hol_chains_set_box(chains, w.box));
        if (!which) assert_refused(chains, &w, WORDS("same unit", "a box is set"));
        hol_chains_destroy(chains);
    }
    free_waters(&w);
}

/* One bond of three is: no word of all of them. */
static void one_length_that_is_wrong(void **state)
{
    (void)state;
    const double lengths[3] = {1, 1, 1}, masses[4] = {1, 1, 1, 1};
    const double r[12] = {0, 0, 0, 1, 0, 0, 1, 1.18, 0, 2, 1.18, 0};
    hol_chains *chains = NULL;
    CHECK(hol_chains_create(4, masses, &chains));
    CHECK(hol_chains_add_block(chains, 1, 3, 0, lengths));
    CHECK_FAILS(HOL_ERR_LENGTHS, hol_chains_check(chains, r, HOL_BOX));
    assert_message_names("atoms 1 and 2");
    assert_message_names("1.18 long");
    assert_null(strstr(hol_error_message(), "all bonds"));
    hol_chains_destroy(chains);
}

static void lengths_in_another_order(void **state)
{
    (void)state;
    waters w = make_waters(4, 3);
    const double lengths[3] = {WATER_HH, WATER_OH, WATER_OH};
    hol_chains *chains = water_set(&w, lengths);
    CHECK(hol_chains_set_box(chains, w.box));
    assert_refused(chains, &w, WORDS("atoms ", "1.63299", "another order", "64 of 64 molecules"));
    hol_chains_destroy(chains);
    free_waters(&w);
}

/* A list that counts from 1, in a set that counts from 0, but for the last molecule. */
static void atoms_counted_from_one(void **state)
{
    (void)state;
    waters w = make_waters(4, 4);
    const int64_t n_bonds = 3 * (w.n_molecules - 1);
    int64_t *const pairs = malloc(sizeof *pairs * 2 * (size_t)n_bonds);
    double *const lengths = malloc(sizeof *lengths * (size_t)n_bonds);
    for (int64_t k = 0; k < n_bonds; ++k) {
        for (int e = 0; e < 2; ++e) pairs[2 * k + e] = 1 + 3 * (k / 3) + water_pairs[2 * (k % 3) + e];
        lengths[k] = water_lengths[k % 3];
    }
    hol_chains *chains;
    CHECK(hol_chains_create(w.n_atoms, w.mass, &chains));
    CHECK(hol_chains_add_bonds(chains, n_bonds, pairs, lengths));
    CHECK(hol_chains_set_box(chains, w.box));
    w.n_molecules -= 1;
    assert_refused(chains, &w, WORDS("atoms counted from 1 (here from 0)"));
    hol_chains_destroy(chains);
    CHECK(hol_chains_create(w.n_atoms, w.mass, &chains));
    CHECK(hol_chains_set_index_base(chains, 1));
    CHECK(hol_chains_add_bonds(chains, n_bonds, pairs, lengths));
    CHECK(hol_chains_check(chains, w.r, HOL_BOX));
    hol_chains_destroy(chains);
    free(pairs);
    free(lengths);
    free_waters(&w);
}

/* The same in separate arrays and in single precision: no layout passes by the check. */
static void a_mistake_is_seen_in_every_layout(void **state)
{
    (void)state;
    waters w = make_waters(4, 7);
    const size_t n = (size_t)w.n_atoms;
    const double tenths[3] = {0.1 * WATER_OH, 0.1 * WATER_OH, 0.1 * WATER_HH};
    hol_chains *chains = water_set(&w, tenths);
    double *const x = malloc(sizeof *x * 3 * n), *const next = malloc(sizeof *next * 3 * n);
    float *const packed = malloc(sizeof *packed * 3 * n), *const moved = malloc(sizeof *moved * 3 * n);
    for (size_t i = 0; i < 3 * n; ++i) {
        next[n * (i % 3) + i / 3] = x[n * (i % 3) + i / 3] = w.r[i];
        moved[i] = packed[i] = (float)w.r[i];
    }
    double *const before = copy_of(next, 3 * n);
    const hol_view apart = {x, x + n, x + 2 * n, sizeof *x, HOL_DOUBLE, 0};
    const hol_view apart_next = {next, next + n, next + 2 * n, sizeof *x, HOL_DOUBLE, 0};
    const hol_view single = {packed, packed + 1, packed + 2, 3 * sizeof(float), HOL_FLOAT, 0};
    const hol_view single_next = {moved, moved + 1, moved + 2, 3 * sizeof(float), HOL_FLOAT, 0};
    CHECK_FAILS(HOL_ERR_LENGTHS,
                hol_project_positions_view(chains, INPUT(&apart), &apart_next, NULL, DT, NULL, 0, NULL, NULL));
    assert_message_names("about 10 times");
    assert_same_bits(next, before, 3 * n);
    CHECK_FAILS(HOL_ERR_LENGTHS,
                hol_project_positions_view(chains, INPUT(&single), &single_next, NULL, DT, NULL, 0, NULL, NULL));
    assert_message_names("about 10 times");
    assert_memory_equal(moved, packed, sizeof *moved * 3 * n);
    free(x);
    free(next);
    free(before);
    free(packed);
    free(moved);
    hol_chains_destroy(chains);
    free_waters(&w);
}

static void a_stale_box(void **state)
{
    (void)state;
    waters w = make_waters(4, 5);
    cut_by_the_faces(&w);
    double stale[9];
    for (int i = 0; i < 9; ++i) stale[i] = 1.1 * w.box[i];
    hol_chains *chains = water_set(&w, water_lengths);
    CHECK(hol_chains_set_box(chains, stale));
    assert_refused(chains, &w, WORDS("a box is set", "another time"));
    CHECK(hol_chains_set_box(chains, w.box));
    CHECK(hol_chains_set_reference_box(chains, stale));
    const size_t n = 3 * (size_t)w.n_atoms;
    double *const r = copy_of(w.r, n);
    CHECK_FAILS(HOL_ERR_LENGTHS, hol_project_positions(chains, w.r, r, NULL, DT, NULL, 0, NULL, NULL));
    assert_same_bits(r, w.r, n);
    CHECK(hol_chains_check(chains, w.r, HOL_BOX));
    CHECK_FAILS(HOL_ERR_LENGTHS, hol_chains_check(chains, w.r, HOL_REFERENCE_BOX));
    free(r);
    hol_chains_destroy(chains);
    free_waters(&w);
}

/* Off by so little that every bond is within a tenth of its length: those across the faces are not right, all others
 * are.
 */
static void a_box_that_is_slightly_off(void **state)
{
    (void)state;
    static const double factors[] = {1.01, 0.99, 1.002};
    waters w = make_waters(4, 5);
    cut_by_the_faces(&w);
    hol_chains *chains = water_set(&w, water_lengths);
    for (int k = 0; k < 3; ++k) {
        double off[9];
        for (int i = 0; i < 9; ++i) off[i] = factors[k] * w.box[i];
        CHECK(hol_chains_set_box(chains, off));
        assert_refused(chains, &w, WORDS("a face of the box cuts it", "hardly the box of these positions"));
        assert_in_range(strlen(hol_error_message()), 60, 240);
    }
    CHECK(hol_chains_set_box(chains, w.box));
    CHECK(hol_chains_check(chains, w.r, HOL_BOX));
    /* All positions as crude as those at the faces: no word of the box. */
    for (int64_t i = 0; i < 3 * w.n_atoms; ++i) w.r[i] += 4e-3 * sin(7.0 * (double)i);
    CHECK(hol_chains_check(chains, w.r, HOL_BOX));
    hol_chains_destroy(chains);
    free_waters(&w);
}

/* Forces that are too large, in the first step as in the second: however far the atoms fly, one status and one message,
 * and no word of units, order or counting, for the reference fits. */
static void a_step_that_explodes(void **state)
{
    (void)state;
    static const double far[] = {2, 3, 4.5, 6, 20, 1e3, 1e6};
    waters w = make_waters(4, 4);
    const size_t n = 3 * (size_t)w.n_atoms;
    for (int boxed = 0; boxed < 2; ++boxed)
        for (int later = 0; later < 2; ++later)
            for (int k = 0; k < 7; ++k) {
                if (boxed && far[k] > 6) continue; /* comes back by another face */
                hol_chains *chains = water_set(&w, water_lengths);
                CHECK(hol_chains_set_box(chains, boxed ? w.box : NULL));
                double *const r = copy_of(w.r, n), *const first = copy_of(w.r, n);
                if (later) CHECK(hol_project_positions(chains, w.r, first, NULL, DT, NULL, 0, NULL, NULL));
                r[3 * 4 + 0] += far[k] * 0.6, r[3 * 4 + 1] -= far[k] * 0.8, r[3 * 4 + 2] += 0.3 * far[k];
                double *const before = copy_of(r, n);
                CHECK_FAILS(HOL_ERR_NO_CONVERGENCE,
                            hol_project_positions(chains, w.r, r, NULL, DT, NULL, 0, NULL, NULL));
                assert_message_names("in the positions to be projected");
                assert_message_names("forces or time step too large");
                assert_null(strstr(hol_error_message(), "unit"));
                assert_null(strstr(hol_error_message(), "order"));
                assert_null(strstr(hol_error_message(), "counted"));
                assert_in_range(strlen(hol_error_message()), 60, 240);
                int64_t molecule;
                hol_error_location(&molecule, NULL, NULL, NULL);
                assert_int_equal(molecule, 1);
                assert_same_bits(r + 9, before + 9, 9);
                free(r);
                free(first);
                free(before);
                hol_chains_destroy(chains);
            }
    free_waters(&w);
}

/* A process whose atoms are all held fixed calls what all others call. */
static void atoms_that_are_all_fixed(void **state)
{
    (void)state;
    const double zero[4] = {0, 0, 0, 0}, length[3] = {1, 1, 1}, r[12] = {0, 0, 0, 1, 0, 0, 2, 0, 0, 3, 0, 0};
    const double held[4] = {INFINITY, INFINITY, INFINITY, INFINITY};
    for (int k = 0; k < 2; ++k) {
        double lambda[3] = {7, 7, 7}, g[12] = {0}, virial[9];
        hol_chains *chains;
        CHECK(hol_chains_create(4, k ? held : zero, &chains));
        CHECK(hol_chains_add_block(chains, 1, 3, 0, length));
        CHECK(hol_chains_set_masses(chains, k ? held : zero));
        assert_int_equal(hol_chains_degrees_of_freedom(chains, 3), 0);
        CHECK(hol_forces(chains, r, NULL, NULL, lambda, NULL, g, HOL_WRITE, virial));
        assert_true(lambda[0] == 0 && lambda[2] == 0 && virial[0] == 0);
        hol_chains_destroy(chains);
    }
}

static void boxes_that_are_no_cell(void **state)
{
    (void)state;
    const double three[9] = {20, 21, 22, 0, 0, 0, 0, 0, 0}, slab[9] = {20, 0, 0, 5, 20, 0, 0, 0, 0};
    const double tilted_out[9] = {20, 0, 3, 0, 20, 0, 0, 0, 0}, mass[2] = {1, 1}, a[1] = {1};
    hol_chains *chains;
    CHECK(hol_chains_create(2, mass, &chains));
    CHECK(hol_chains_add_block(chains, 1, 1, 0, a));
    CHECK_FAILS(HOL_ERR_VALUE, hol_chains_set_box(chains, three));
    assert_message_names("box vector 1 has a component (21)");
    assert_message_names("diagonal");
    CHECK_FAILS(HOL_ERR_VALUE, hol_chains_set_reference_box(chains, three));
    CHECK_FAILS(HOL_ERR_VALUE, hol_chains_set_box(chains, tilted_out));
    CHECK(hol_chains_set_box(chains, slab));
    hol_chains_destroy(chains);
}

static void boxes_narrower_than_two_bonds(void **state)
{
    (void)state;
    waters w = make_waters(6, 6);
    double nm[9], other[9] = {40, 0, 0, 39, 3, 0, 0, 0, 40};
    for (int i = 0; i < 9; ++i) nm[i] = 0.1 * w.box[i]; /* beside lengths in angstrom */
    hol_chains *chains = water_set(&w, water_lengths);
    CHECK_FAILS(HOL_ERR_VALUE, hol_chains_set_box(chains, nm));
    assert_message_names("1.86 wide");
    assert_message_names("longest bond, 1.63299 (atoms 1 and 2)");
    assert_message_names("same unit");
    CHECK_FAILS(HOL_ERR_VALUE, hol_chains_set_reference_box(chains, nm));
    CHECK_FAILS(HOL_ERR_VALUE, hol_chains_set_box(chains, other)); /* 3 high, and its planes are nearer */
    CHECK(hol_chains_set_box(chains, w.box));
    double *const lengths = malloc(sizeof *lengths * 3 * (size_t)w.n_molecules);
    for (int64_t k = 0; k < 3 * w.n_molecules; ++k) lengths[k] = 10 * water_lengths[k % 3];
    CHECK_FAILS(HOL_ERR_VALUE, hol_chains_set_lengths(chains, lengths));
    assert_message_names("longest bond, 16.3299 (atoms 1 and 2)");
    hol_chains_destroy(chains);
    CHECK(hol_chains_create(w.n_atoms, w.mass, &chains));
    CHECK(hol_chains_set_box(chains, nm));
    CHECK_FAILS(HOL_ERR_VALUE, hol_chains_add_molecules(chains, w.n_molecules, 3, 0, 3, water_pairs, water_lengths));
    assert_message_names("longest bond, 1.63299 (atoms 1 and 2)");
    assert_int_equal(hol_chains_n_bonds(chains), 0);
    hol_chains_destroy(chains);
    free(lengths);
    free_waters(&w);
}

static void lengths_that_make_no_triangle(void **state)
{
    (void)state;
    const double mass[8] = {1, 1, 1, 1, 1, 1, 1, 1}, angle[3] = {1, 1, 2.1}, line[3] = {1, 1, 2};
    hol_chains *chains;
    CHECK(hol_chains_create(8, mass, &chains));
    CHECK_FAILS(HOL_ERR_VALUE, hol_chains_add_molecules(chains, 2, 3, 2, 3, water_pairs, angle));
    assert_message_names("bond 2 (atoms 3 and 4) has the length 2.1");
    assert_message_names("triangle with atom 2");
    int64_t bond;
    hol_error_location(NULL, &bond, NULL, NULL);
    assert_int_equal(bond, 2);
    assert_int_equal(hol_chains_n_bonds(chains), 0);
    CHECK(hol_chains_add_molecules(chains, 1, 3, 5, 3, water_pairs, line)); /* what it is at is found by the calls */
    CHECK_FAILS(HOL_ERR_VALUE, hol_chains_set_lengths(chains, angle));
    assert_message_names("atoms 6 and 7");
    const double degrees[3] = {1, 1, 109.47};
    CHECK_FAILS(HOL_ERR_VALUE, hol_chains_set_lengths(chains, degrees));
    assert_message_names("has the length 109.47");
    hol_chains_destroy(chains);

    /* Within a larger molecule, and a ring. */
    const int64_t kite[10] = {0, 1, 1, 2, 2, 3, 3, 1, 0, 4}, ring[8] = {0, 1, 1, 2, 2, 3, 3, 0};
    const double kite_lengths[5] = {1, 1, 3, 1, 1}, ring_lengths[4] = {1, 1, 3.5, 1};
    CHECK(hol_chains_create(8, mass, &chains));
    CHECK_FAILS(HOL_ERR_VALUE, hol_chains_add_bonds(chains, 5, kite, kite_lengths));
    assert_message_names("bond 2 (atoms 2 and 3) has the length 3");
    assert_message_names("with atom 1");
    CHECK_FAILS(HOL_ERR_VALUE, hol_chains_add_bonds(chains, 4, ring, ring_lengths));
    assert_message_names("ring can't close");
    hol_chains_destroy(chains);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(molecules_cut_by_the_cell_without_a_box),
        cmocka_unit_test(lengths_in_another_unit),
        cmocka_unit_test(one_length_that_is_wrong),
        cmocka_unit_test(lengths_in_another_order),
        cmocka_unit_test(atoms_counted_from_one),
        cmocka_unit_test(a_mistake_is_seen_in_every_layout),
        cmocka_unit_test(a_stale_box),
        cmocka_unit_test(a_box_that_is_slightly_off),
        cmocka_unit_test(a_step_that_explodes),
        cmocka_unit_test(atoms_that_are_all_fixed),
        cmocka_unit_test(boxes_that_are_no_cell),
        cmocka_unit_test(boxes_narrower_than_two_bonds),
        cmocka_unit_test(lengths_that_make_no_triangle),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
