/* When positions are compared with lengths, how it is switched off, and that sound programs see nothing of it. */
#include "check.h"
#include "input.h"
#include "random.h"
#include "water.h"

static hol_chains *water_set(const waters *w)
{
    hol_chains *chains;
    CHECK(hol_chains_create(w->n_atoms, w->mass, &chains));
    CHECK(hol_chains_add_molecules(chains, w->n_molecules, 3, 0, 3, water_pairs, water_lengths));
    CHECK(hol_chains_set_box(chains, w->box));
    return chains;
}

static double worst_length(const hol_chains *chains, const double *r)
{
    hol_worst worst;
    CHECK(hol_violation(chains, r, NULL, &worst));
    return worst.length;
}

static void disturb(double *r, size_t n, double by, uint64_t seed)
{
    random_stream stream = random_seed(seed);
    for (size_t i = 0; i < n; ++i) r[i] += by * (2 * random_uniform(&stream) - 1);
}

static void references_a_thousandth_off_are_sound(void **state)
{
    (void)state;
    waters w = make_waters(5, 1);
    cut_by_the_faces(&w);
    const size_t n = 3 * (size_t)w.n_atoms;
    hol_chains *chains = water_set(&w);
    CHECK(hol_chains_set_checks(chains, HOL_ALWAYS));
    for (uint64_t step = 0; step < 20; ++step) {
        disturb(w.r, n, 1e-3, step);
        double *const r = copy_of(w.r, n);
        disturb(r, n, 0.05, 100 + step);
        CHECK(hol_project_positions(chains, w.r, r, NULL, 1, NULL, 0, NULL, NULL));
        memcpy(w.r, r, sizeof *r * n);
        free(r);
    }
    hol_chains_destroy(chains);
    free_waters(&w);
}

/* A barostat: the box is set before each call, and changes little from one to the next. The check is not made again, as
 * a crude reference shows, until it has changed by more than two per cent. */
static void a_box_that_changes_slowly_is_not_looked_at_again(void **state)
{
    (void)state;
    waters w = make_waters(5, 2);
    const size_t n = 3 * (size_t)w.n_atoms;
    hol_chains *chains = water_set(&w);
    double *const r = copy_of(w.r, n), *const crude = copy_of(w.r, n), box[9];
    CHECK(hol_project_positions(chains, w.r, r, NULL, 1, NULL, 0, NULL, NULL));
    crude[3] += 0.3;
    for (int i = 0; i < 9; ++i) box[i] = 1.015 * w.box[i];
    CHECK(hol_chains_set_box(chains, box));
    r[3] += 0.01;
    CHECK(hol_project_positions(chains, crude, r, NULL, 1, NULL, 0, NULL, NULL));
    for (int i = 0; i < 9; ++i) box[i] = 1.03 * w.box[i];
    CHECK(hol_chains_set_box(chains, box));
    CHECK_FAILS(HOL_ERR_LENGTHS, hol_project_positions(chains, crude, r, NULL, 1, NULL, 0, NULL, NULL));
    assert_message_names("molecule 0");
    CHECK(hol_project_positions(chains, w.r, r, NULL, 1, NULL, 0, NULL, NULL));
    CHECK(hol_project_positions(chains, crude, r, NULL, 1, NULL, 0, NULL, NULL));
    CHECK(hol_chains_set_checks(chains, HOL_ALWAYS));
    CHECK_FAILS(HOL_ERR_LENGTHS, hol_project_positions(chains, crude, r, NULL, 1, NULL, 0, NULL, NULL));
    free(r);
    free(crude);
    hol_chains_destroy(chains);
    free_waters(&w);
}

static void new_lengths_are_looked_at(void **state)
{
    (void)state;
    waters w = make_waters(2, 3);
    hol_chains *chains = water_set(&w);
    double lengths[24];
    CHECK(hol_project_positions(chains, w.r, w.r, NULL, 1, NULL, 0, NULL, NULL));
    for (int k = 0; k < 24; ++k) lengths[k] = 1.2 * water_lengths[k % 3]; /* the reference has those before */
    CHECK(hol_chains_set_lengths(chains, lengths));
    CHECK(hol_project_positions(chains, w.r, w.r, NULL, 1, NULL, 0, NULL, NULL));
    for (int k = 0; k < 24; ++k) lengths[k] = 1.2 * water_lengths[(k + 1) % 3]; /* of other bonds */
    CHECK(hol_chains_set_lengths(chains, lengths));
    CHECK_FAILS(HOL_ERR_LENGTHS, hol_project_positions(chains, w.r, w.r, NULL, 1, NULL, 0, NULL, NULL));
    hol_chains_destroy(chains);
    free_waters(&w);
}

/* The documented way to read a crude file. */
static void crude_positions_are_projected_without_checks(void **state)
{
    (void)state;
    waters w = make_waters(4, 4);
    const size_t n = 3 * (size_t)w.n_atoms;
    disturb(w.r, n, 0.12, 5);
    hol_chains *chains = water_set(&w);
    CHECK_FAILS(HOL_ERR_LENGTHS, hol_project_positions(chains, w.r, w.r, NULL, 1, NULL, 0, NULL, NULL));
    CHECK(hol_chains_set_checks(chains, HOL_NEVER));
    CHECK(hol_project_positions(chains, w.r, w.r, NULL, 1, NULL, 0, NULL, NULL));
    CHECK_AT_MOST(worst_length(chains, w.r), 1e-13);
    CHECK(hol_chains_set_checks(chains, HOL_AT_START));
    CHECK(hol_project_positions(chains, w.r, w.r, NULL, 1, NULL, 0, NULL, NULL));
    CHECK_FAILS(HOL_ERR_VALUE, hol_chains_set_checks(chains, 3));
    CHECK_FAILS(HOL_ERR_NULL, hol_chains_set_checks(NULL, HOL_NEVER));
    hol_chains_destroy(chains);
    free_waters(&w);
}

/* After the first call: a molecule that comes with bonds of several times their lengths is left as it is, also where
 * Newton's method would find the way back: its last atom leaps along the bond to `partner`. Returns whether it would.
 */
static int a_step_over_several_bond_lengths_is_refused(hol_chains *chains, int64_t n_atoms, const double *r_ref,
                                                       int64_t bad, int64_t first_atom, int64_t partner)
{
    const size_t n = 3 * (size_t)n_atoms;
    double *const r = copy_of(r_ref, n), *const sound = copy_of(r_ref, n);
    disturb(r, n, 1e-3, 7);
    memcpy(sound, r, sizeof *r * n);
    CHECK(hol_project_positions(chains, r_ref, sound, NULL, 1, NULL, 0, NULL, NULL));
    int64_t own, list[64], molecule;
    CHECK(hol_chains_molecule(chains, bad, NULL, &own, NULL));
    assert_in_range(own, 2, 64);
    CHECK(hol_chains_atoms(chains, bad, list));
    for (int c = 0; c < 3; ++c)
        r[3 * list[own - 1] + c] += 5 * (r_ref[3 * list[own - 1] + c] - r_ref[3 * (first_atom + partner) + c]);
    double *const before = copy_of(r, n);
    hol_report report;
    CHECK_FAILS(HOL_ERR_NO_CONVERGENCE, hol_project_positions(chains, r_ref, r, NULL, 1, NULL, 0, NULL, &report));
    hol_error_location(&molecule, NULL, NULL, NULL);
    assert_int_equal(molecule, bad);
    assert_message_names("in the positions to be projected");
    assert_int_equal(report.n_failed, 1);
    for (int64_t i = 0; i < own; ++i) {
        assert_in_range(list[i], first_atom, first_atom + own - 1);
        assert_same_bits(r + 3 * list[i], before + 3 * list[i], 3);
    }
    for (int64_t i = 0; i < n_atoms; ++i)
        if (i < first_atom || i >= first_atom + own) assert_same_bits(r + 3 * i, sound + 3 * i, 3);
    /* Nobody is refused for that once the check is off. */
    CHECK(hol_chains_set_checks(chains, HOL_NEVER));
    const int status = hol_project_positions(chains, r_ref, before, NULL, 1, NULL, 0, NULL, NULL);
    assert_true(status == HOL_OK || status == HOL_ERR_NO_CONVERGENCE);
    CHECK(hol_chains_set_checks(chains, HOL_AT_START));
    free(r);
    free(sound);
    free(before);
    return status == HOL_OK;
}

static void water_leaps(void **state)
{
    (void)state;
    waters w = make_waters(3, 8);
    hol_chains *chains;
    CHECK(hol_chains_create(w.n_atoms, w.mass, &chains));
    CHECK(hol_chains_add_molecules(chains, w.n_molecules, 3, 0, 3, water_pairs, water_lengths));
    for (int64_t m = 0; m < w.n_molecules; m += 5)
        assert_true(a_step_over_several_bond_lengths_is_refused(chains, w.n_atoms, w.r, m, 3 * m, 0));
    hol_chains_destroy(chains);
    free_waters(&w);
}

/* Every shape that has a way of its own: single bonds, two and three, chains, stars, trees, rings, cages. */
static void other_shapes_leap(void **state)
{
    (void)state;
    static const int64_t none[1] = {0}, star[6] = {0, 1, 0, 2, 0, 3}, branched[10] = {0, 1, 1, 2, 1, 3, 3, 4, 3, 5};
    static const int64_t ring[10] = {0, 1, 1, 2, 2, 3, 3, 4, 0, 4}, kite[12] = {0, 1, 1, 2, 2, 3, 0, 3, 0, 2, 3, 4};
    static const struct {
        int64_t n_atoms, n_bonds, partner;
        const int64_t *pairs; /* none: linear */
    } shapes[] = {{2, 1, 0, none},    {3, 2, 1, none}, {4, 3, 2, none},     {6, 5, 4, none}, {12, 11, 10, none},
                  {40, 39, 38, none}, {4, 3, 0, star}, {6, 5, 3, branched}, {5, 5, 0, ring}, {5, 6, 3, kite}};
    enum { COPIES = 9, MOST = 40 * COPIES };
    double mass[MOST], r[3 * MOST], length[MOST];
    int found = 0;
    for (size_t s = 0; s < sizeof shapes / sizeof *shapes; ++s) {
        const int64_t size = shapes[s].n_atoms, n_bonds = shapes[s].n_bonds, n = size * COPIES;
        hol_chains *chains;
        for (int64_t i = 0; i < n; ++i) mass[i] = i % size == size - 1 ? 0.01 : 1 + 0.1 * (double)(i % size);
        /* Places on a helix, and lengths as they are there. */
        for (int64_t i = 0; i < n; ++i) {
            const double k = (double)(i % size);
            r[3 * i] = 20 * (double)(i / size) + 0.9 * cos(1.1 * k);
            r[3 * i + 1] = 0.9 * sin(1.1 * k);
            r[3 * i + 2] = 0.4 * k + 0.3 * sin(3 * k);
        }
        for (int64_t k = 0; k < n_bonds; ++k) {
            const int64_t i = shapes[s].pairs == none ? k : shapes[s].pairs[2 * k];
            const int64_t j = shapes[s].pairs == none ? k + 1 : shapes[s].pairs[2 * k + 1];
            length[k] = 0;
            for (int c = 0; c < 3; ++c) length[k] += (r[3 * j + c] - r[3 * i + c]) * (r[3 * j + c] - r[3 * i + c]);
            length[k] = sqrt(length[k]);
        }
        CHECK(hol_chains_create(n, mass, &chains));
        if (shapes[s].pairs == none)
            CHECK(hol_chains_add_block(chains, COPIES, n_bonds, 0, length));
        else
            CHECK(hol_chains_add_molecules(chains, COPIES, size, 0, n_bonds, shapes[s].pairs, length));
        for (int64_t m = 0; m < COPIES; m += 4)
            found += a_step_over_several_bond_lengths_is_refused(chains, n, r, m, size * m, shapes[s].partner);
        hol_chains_destroy(chains);
    }
    print_message("%d of 30 would have been solved\n", found);
    assert_true(found >= 20);
}

static void the_check_on_request(void **state)
{
    (void)state;
    waters w = make_waters(3, 9);
    hol_chains *chains = water_set(&w);
    CHECK(hol_chains_set_checks(chains, HOL_NEVER));
    CHECK(hol_chains_check(chains, w.r, HOL_BOX));
    CHECK_FAILS(HOL_ERR_NULL, hol_chains_check(NULL, w.r, HOL_BOX));
    CHECK_FAILS(HOL_ERR_NULL, hol_chains_check(chains, NULL, HOL_BOX));
    CHECK_FAILS(HOL_ERR_VALUE, hol_chains_check(chains, w.r, 2));
    const hol_view view = {w.r, w.r + 1, w.r + 2, 3 * sizeof(double), HOL_DOUBLE, 0};
    CHECK(hol_chains_check_view(chains, INPUT(&view), HOL_REFERENCE_BOX));
    w.r[9 * 7 + 3] += 0.4;
    CHECK_FAILS(HOL_ERR_LENGTHS, hol_chains_check_view(chains, INPUT(&view), HOL_BOX));
    assert_message_names("molecule 7");
    assert_message_names("1 of 27 molecules");
    unsigned char active[27];
    memset(active, 1, sizeof active);
    active[7] = 0;
    CHECK(hol_chains_set_active(chains, active));
    CHECK(hol_chains_check(chains, w.r, HOL_BOX));
    w.r[0] = NAN;
    CHECK_FAILS(HOL_ERR_NOT_FINITE, hol_chains_check(chains, w.r, HOL_BOX));
    hol_chains_destroy(chains);
    free_waters(&w);
}

static void the_references_own_error_is_reported(void **state)
{
    (void)state;
    waters w = make_waters(3, 10);
    const size_t n = 3 * (size_t)w.n_atoms;
    hol_chains *chains = water_set(&w);
    double *const r = copy_of(w.r, n), error;
    int64_t molecule, bond;
    hol_report report;
    w.r[9 * 11 + 3] += 2e-3;
    hol_worst worst;
    CHECK(hol_violation(chains, w.r, NULL, &worst));
    CHECK(hol_project_positions(chains, w.r, r, NULL, 1, NULL, 0, NULL, &report));
    CHECK(hol_reference_error(chains, &error, &molecule, &bond));
    assert_true(error == worst.length && molecule == 11 && bond == worst.length_bond);
    CHECK(hol_chains_set_checks(chains, HOL_ALWAYS));
    memcpy(r, w.r, sizeof *r * n);
    CHECK(hol_project_positions(chains, r, r, NULL, 1, NULL, 0, NULL, &report)); /* before r is moved */
    CHECK(hol_reference_error(chains, &error, NULL, NULL));
    assert_true(error == worst.length);
    CHECK(hol_project_positions(chains, r, r, NULL, 1, NULL, 0, NULL, NULL));
    CHECK(hol_reference_error(chains, &error, NULL, NULL));
    CHECK_AT_MOST(error, 1e-13);
    CHECK(hol_chains_set_checks(chains, HOL_NEVER));
    memcpy(r, w.r, sizeof *r * n);
    CHECK(hol_project_positions(chains, r, r, NULL, 1, NULL, 0, NULL, &report));
    CHECK(hol_reference_error(chains, &error, NULL, NULL));
    assert_true(error == worst.length);
    CHECK_AT_MOST(report.max_error, 1e-14);
    free(r);
    hol_chains_destroy(chains);
    free_waters(&w);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(references_a_thousandth_off_are_sound),
        cmocka_unit_test(a_box_that_changes_slowly_is_not_looked_at_again),
        cmocka_unit_test(new_lengths_are_looked_at),
        cmocka_unit_test(crude_positions_are_projected_without_checks),
        cmocka_unit_test(water_leaps),
        cmocka_unit_test(other_shapes_leap),
        cmocka_unit_test(the_check_on_request),
        cmocka_unit_test(the_references_own_error_is_reported),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
