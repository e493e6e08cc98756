/* Mistakes that are made in the first hour: none is silent, each message has words that lead to it, and nothing of the
 * caller's is changed. What is wrong at the first step with units, boxes and numbering is in test_start.c, boxes that
 * are slightly wrong in test_cut.c, massless sites in test_held_sites.c. */
#include "check.h"

enum { ATOMS = 9, BONDS = 9 };

/* Three waters, of which the last one is cut by a face of a cube of 10. */
static const double masses[ATOMS] = {16, 1, 1, 16, 1, 1, 16, 1, 1}, lengths[3] = {1, 1, 1.6};
static const int64_t pairs[6] = {0, 1, 0, 2, 1, 2};

static void positions(double r[ATOMS][3])
{
    for (int m = 0; m < 3; ++m)
        for (int i = 0; i < 3; ++i) {
            r[3 * m + i][0] = 2 + 3.8 * m + (i ? 0.6 : 0);
            r[3 * m + i][1] = 5 + (i == 1 ? 0.8 : i == 2 ? -0.8 : 0);
            r[3 * m + i][2] = 5;
            r[3 * m + i][0] -= r[3 * m + i][0] > 10 ? 10 : 0;
        }
}

static hol_chains *waters(void)
{
    hol_chains *chains;
    const double box[9] = {10, 0, 0, 0, 10, 0, 0, 0, 10};
    CHECK(hol_chains_create(ATOMS, masses, &chains));
    CHECK(hol_chains_add_molecules(chains, 3, 3, 0, 3, pairs, lengths));
    CHECK(hol_chains_set_box(chains, box));
    return chains;
}

/* Whatever the status: it is an error, and its message has these words. */
#define REFUSED(words, call)                                              \
    do {                                                                  \
        if ((call) == HOL_OK) fail_msg("%s: nothing is said", #call);     \
        assert_message_names(words);                                      \
        assert_in_range(strlen(hol_error_message()), strlen(words), 300); \
    } while (0)

static void masses_and_bonds(void **state)
{
    (void)state;
    hol_chains *chains = NULL, *none = NULL;
    double wrong[ATOMS];
    for (int k = 0; k < 3; ++k) {
        memcpy(wrong, masses, sizeof wrong);
        wrong[4] = k == 0 ? -1 : k == 1 ? NAN : 1e-320; /* of which 1/m overflows */
        REFUSED("atom 4", hol_chains_create(ATOMS, wrong, &none));
        assert_null(none);
    }
    REFUSED("n_atoms", hol_chains_create(-1, masses, &none));
    REFUSED("masses", hol_chains_create(ATOMS, NULL, &none));
    CHECK(hol_chains_create(ATOMS, masses, &chains));
    const int64_t beyond[2] = {8, 9}, below[2] = {-1, 0}, itself[2] = {3, 3}, twice[4] = {0, 1, 1, 0};
    const double one[2] = {1, 1}, bad[3] = {-1, NAN, INFINITY};
    REFUSED("9", hol_chains_add_bonds(chains, 1, beyond, one)); /* counted from 1 */
    REFUSED("-1", hol_chains_add_bonds(chains, 1, below, one));
    REFUSED("itself", hol_chains_add_bonds(chains, 1, itself, one));
    REFUSED("bond", hol_chains_add_bonds(chains, 2, twice, one));
    for (int k = 0; k < 3; ++k) REFUSED("length", hol_chains_add_bonds(chains, 1, pairs, bad + k));
    REFUSED("lengths", hol_chains_add_bonds(chains, 1, pairs, NULL));
    REFUSED("n_bonds", hol_chains_add_bonds(chains, -1, pairs, one));
    const double open[3] = {1, 1, 2.1};
    REFUSED("triangle", hol_chains_add_molecules(chains, 3, 3, 0, 3, pairs, open));
    REFUSED("atom", hol_chains_add_molecules(chains, 4, 3, 0, 3, pairs, lengths)); /* more than there are */
    CHECK(hol_chains_add_molecules(chains, 3, 3, 0, 3, pairs, lengths));
    REFUSED("atom 0", hol_chains_add_molecules(chains, 3, 3, 0, 3, pairs, lengths)); /* added again */
    assert_int_equal(hol_chains_n_bonds(chains), BONDS);
    hol_chains_destroy(chains);
}

static void bodies(void **state)
{
    (void)state;
    hol_chains *chains = NULL;
    const double without[3] = {0, 0, 1}, places[9] = {0, 0, 0, 1, 0, 0, 2, 0, 0};
    const double on_each_other[9] = {0};
    const int64_t three = 3, two = 2, one = 1, atoms[3] = {0, 1, 2}, again[3] = {0, 1, 1};
    CHECK(hol_chains_create(3, without, &chains));
    REFUSED("mass", hol_chains_add_rigid(chains, 1, &two, atoms, places, 0, NULL, NULL));
    REFUSED("body 0", hol_chains_add_rigid(chains, 1, &one, atoms, places, 0, NULL, NULL));
    hol_chains_destroy(chains);
    CHECK(hol_chains_create(3, masses, &chains));
    REFUSED("atom 1", hol_chains_add_rigid(chains, 1, &three, again, places, 0, NULL, NULL));
    REFUSED("", hol_chains_add_rigid(chains, 1, &three, atoms, on_each_other, 0, NULL, NULL));
    hol_chains_destroy(chains);
}

static void settings(void **state)
{
    (void)state;
    hol_chains *chains = waters();
    const double none[9] = {10, 0, 0, 20, 0, 0, 0, 0, 10}, narrow[9] = {3, 0, 0, 0, 10, 0, 0, 0, 10};
    double nan[9] = {NAN};
    REFUSED("box", hol_chains_set_box(chains, none));
    REFUSED("bond", hol_chains_set_box(chains, narrow)); /* a bond of 1.6 is more than half of it */
    REFUSED("box", hol_chains_set_box(chains, nan));
    REFUSED("rate", hol_chains_set_box_rate(chains, nan));
    REFUSED("tolerance", hol_chains_set_tolerance(chains, -1e-8));
    REFUSED("tolerance", hol_chains_set_tolerance(chains, NAN));
    REFUSED("threads", hol_chains_set_threads(chains, 0));
    REFUSED("", hol_chains_set_max_iterations(chains, 0));
    REFUSED("base", hol_chains_set_index_base(chains, 2));
    double wrong[BONDS];
    for (int k = 0; k < BONDS; ++k) wrong[k] = k == 4 ? -1 : lengths[k % 3];
    REFUSED("bond", hol_chains_set_lengths(chains, wrong));
    for (int k = 0; k < ATOMS; ++k) wrong[k] = k == 7 ? -1 : 1;
    REFUSED("atom 7", hol_chains_set_masses(chains, wrong));
    hol_chains_destroy(chains);
}

static void steps(void **state)
{
    (void)state;
    hol_chains *chains = waters();
    double r[ATOMS][3], before[ATOMS][3], v[ATOMS][3] = {{0}}, f[ATOMS][3] = {{0}}, g[ATOMS][3], lambda[BONDS];
    positions(before);
    positions(r);
    REFUSED("dt", hol_project_positions(chains, before[0], r[0], v[0], 0, NULL, 0, NULL, NULL));
    REFUSED("dt", hol_project_positions(chains, before[0], r[0], v[0], NAN, NULL, 0, NULL, NULL));
    REFUSED("lambda", hol_project_positions(chains, before[0], r[0], v[0], 1, NULL, 1, NULL, NULL));
    REFUSED("r", hol_project_positions(chains, before[0], NULL, v[0], 1, NULL, 0, NULL, NULL));
    REFUSED("mode", hol_forces(chains, r[0], v[0], f[0], NULL, NULL, g[0], 7, NULL));
    v[4][1] = NAN;
    REFUSED("velocity of atom 4", hol_project_velocities(chains, r[0], v[0], NULL, NULL));
    v[4][1] = 0;
    f[8][0] = INFINITY;
    REFUSED("atom 8", hol_forces(chains, r[0], v[0], f[0], NULL, NULL, g[0], HOL_WRITE, NULL));
    f[8][0] = 0;
    for (int k = 0; k < BONDS; ++k) lambda[k] = k == 5 ? NAN : 0;
    REFUSED("bond", hol_solve(chains, r[0], lambda, NULL, g[0], HOL_WRITE, NULL));
    r[1][2] = NAN;
    REFUSED("position of atom 1", hol_project_positions(chains, before[0], r[0], v[0], 1, NULL, 0, NULL, NULL));
    positions(r);
    /* Two atoms at one place, as of a file that was read wrongly. */
    double meet[ATOMS][3];
    positions(meet);
    memcpy(meet[1], meet[0], sizeof meet[0]);
    REFUSED("bond", hol_forces(chains, meet[0], v[0], f[0], NULL, NULL, g[0], HOL_WRITE, NULL));
    r[1][2] += 0.1; /* what is right already is not projected along anything */
    REFUSED("bond", hol_project_positions(chains, meet[0], r[0], v[0], 1, NULL, 0, NULL, NULL));
    positions(r);
    /* The box forgotten, another unit, another order of atoms. */
    CHECK(hol_chains_set_box(chains, NULL));
    REFUSED("no box is set", hol_project_positions(chains, before[0], r[0], v[0], 1, NULL, 0, NULL, NULL));
    const double box[9] = {10, 0, 0, 0, 10, 0, 0, 0, 10}, tenth[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    REFUSED("bond", hol_chains_set_box(chains, tenth));
    CHECK(hol_chains_set_box(chains, box));
    for (int i = 0; i < ATOMS; ++i)
        for (int c = 0; c < 3; ++c) meet[i][c] = 0.1 * before[i][c];
    REFUSED("bond", hol_project_positions(chains, meet[0], meet[0], v[0], 1, NULL, 0, NULL, NULL));
    CHECK(hol_project_positions(chains, before[0], r[0], v[0], 1, NULL, 0, NULL, NULL));
    /* Questions with wrong numbers. */
    int64_t list[3];
    REFUSED("", hol_chains_atoms(chains, 3, list));
    REFUSED("", hol_metric(chains, r[0], NAN, NULL, NULL, NULL, NULL, HOL_WRITE));
    hol_chains_destroy(chains);
}

/* What has not been made, or is asked of what can't tell. */
static void handles(void **state)
{
    (void)state;
    hol_chains *chains = waters(), *none = NULL;
    double r[ATOMS][3], v[ATOMS][3] = {{0}}, box[9];
    int64_t list[ATOMS];
    int status[3], iterations[3], shape;
    hol_factors *factors;
    hol_inverse *inverse;
    positions(r);
    REFUSED("chains is NULL", hol_forces(NULL, r[0], NULL, NULL, NULL, NULL, NULL, HOL_WRITE, NULL));
    REFUSED("chains is NULL", hol_project_velocities(NULL, r[0], v[0], NULL, NULL));
    REFUSED("chains is NULL", hol_chains_add_bonds(NULL, 3, pairs, lengths));
    REFUSED("chains is NULL", hol_chains_copy(NULL, &none));
    REFUSED("copy is NULL", hol_chains_copy(chains, NULL));
    REFUSED("chains is NULL", hol_chains_create(ATOMS, masses, NULL));
    REFUSED("chains is NULL", hol_factors_create(NULL, &factors));
    REFUSED("molecule 3", hol_inverse_create(chains, 3, r[0], &inverse));
    REFUSED("molecule 3", hol_chains_molecule(chains, 3, &shape, list, list));
    REFUSED("bond 9", hol_chains_set_length(chains, 9, 1));
    REFUSED("outcomes were not kept", hol_outcomes(chains, status, iterations));
    REFUSED("no reference", hol_reference_error(chains, box, NULL, NULL));
    REFUSED("base", hol_chains_set_index_base(chains, 1)); /* too late */
    REFUSED("HOL_BOX", hol_chains_check(chains, r[0], 5));
    REFUSED("HOL_BOX", hol_chains_box(chains, 5, box));
    REFUSED("HOL_NEVER", hol_chains_set_checks(chains, 7));
    REFUSED("HOL_BODIES", hol_chains_set_bodies(chains, 7));
    REFUSED("bytes", hol_chains_set_memory_limit(chains, -5));
    REFUSED("0.01", hol_chains_set_length_tolerance(chains, 1));
    REFUSED("below 1", hol_chains_set_tolerance(chains, 50)); /* a number of iterations */
    REFUSED("below 1", hol_chains_set_tolerance(chains, 1));  /* nothing would be held */
    REFUSED("1000", hol_chains_set_max_iterations(chains, 1000000));
    hol_chains_destroy(chains);
    CHECK(hol_chains_create(ATOMS, masses, &chains));
    CHECK(hol_chains_set_index_base(chains, 1));
    REFUSED("outside 1 .. 3", hol_chains_add_molecules(chains, 3, 3, 1, 3, pairs, lengths));
    REFUSED("outside the atoms 1 .. 9",
            hol_chains_add_molecules(chains, 3, 3, 0, 3, (int64_t[6]){1, 2, 1, 3, 2, 3}, lengths));
    hol_chains_destroy(chains);
}

/* One array in another one's place. */
static void arrays(void **state)
{
    (void)state;
    hol_chains *chains = waters();
    double r[ATOMS][3], before[ATOMS][3], new[ATOMS][3], v[ATOMS][3] = {{0}}, f[ATOMS][3] = {{0}}, g[ATOMS][3];
    double lambda[BONDS], rhs[BONDS] = {0}, rate[BONDS], size[BONDS];
    hol_worst worst;
    positions(before);
    positions(r);
    positions(new);
    new[4][2] += 0.01;
    REFUSED("v is the array that was given for r", hol_project_velocities(chains, r[0], r[0], NULL, NULL));
    REFUSED("v is the array that was given for r",
            hol_forces(chains, r[0], r[0], f[0], NULL, NULL, g[0], HOL_WRITE, NULL));
    REFUSED("v is the array that was given for r", hol_violation(chains, r[0], r[0], &worst));
    REFUSED("v is the array that was given for r", hol_residuals(chains, r[0], r[0], size, rate));
    REFUSED("v is the array that was given for r",
            hol_project_positions(chains, r[0], new[0], new[0], 1, NULL, 0, NULL, NULL));
    REFUSED("v is the array that was given for r_ref",
            hol_project_positions(chains, r[0], new[0], r[0], 1, NULL, 0, NULL, NULL));
    REFUSED("g is the array that was given for r",
            hol_forces(chains, r[0], v[0], f[0], NULL, NULL, r[0], HOL_WRITE, NULL));
    REFUSED("g is the array that was given for v",
            hol_forces(chains, r[0], v[0], f[0], NULL, NULL, v[0], HOL_WRITE, NULL));
    REFUSED("tension is the array that was given for lambda",
            hol_forces(chains, r[0], v[0], f[0], lambda, lambda, g[0], HOL_WRITE, NULL));
    REFUSED("g is the array that was given for r", hol_solve(chains, r[0], rhs, NULL, r[0], HOL_WRITE, NULL));
    REFUSED("force is the array that was given for r", hol_metric(chains, r[0], 1, NULL, NULL, NULL, r[0], HOL_WRITE));
    hol_const_view read = hol_const_view_rows(r[0]);
    hol_view written = hol_view_rows(r[0]);
    REFUSED("v is the array that was given for r", hol_project_velocities_view(chains, &read, &written, NULL, NULL));
    written = hol_view_rows(v[0]);
    read.stride = 3; /* numbers instead of bytes */
    REFUSED("multiple of 8", hol_project_velocities_view(chains, &read, &written, NULL, NULL));
    read = (hol_const_view){0};
    REFUSED("no x", hol_project_velocities_view(chains, &read, &written, NULL, NULL));
    read = hol_const_view_rows(r[0]);
    written.z = NULL; /* two dimensions, and three */
    REFUSED("some views have z", hol_project_velocities_view(chains, &read, &written, NULL, NULL));
    REFUSED("rhs is NULL", hol_solve(chains, r[0], NULL, lambda, g[0], HOL_WRITE, NULL));
    REFUSED("lambda is NULL", hol_reactions(chains, r[0], HOL_BOX, NULL, size, NULL, HOL_WRITE, NULL, NULL));
    REFUSED("guess", hol_project_positions(chains, r[0], new[0], NULL, 1, lambda, 2, NULL, NULL));
    assert_memory_equal(r, before, sizeof r);
    for (int i = 0; i < ATOMS; ++i)
        for (int c = 0; c < 3; ++c) assert_true(v[i][c] == 0);
    CHECK(hol_forces(chains, r[0], v[0], f[0], NULL, NULL, f[0], HOL_ADD, NULL)); /* this one may be */
    hol_chains_destroy(chains);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(handles), cmocka_unit_test(arrays),   cmocka_unit_test(masses_and_bonds),
        cmocka_unit_test(bodies),  cmocka_unit_test(settings), cmocka_unit_test(steps),
    };
    return cmocka_run_group_tests_name("mistakes", tests, NULL, NULL);
}
