/**
 * Cells whose rows are not reduced: any three vectors that span a lattice are the same box. Molecules scattered over
 * images of such a cell, beside the same molecules whole and without a box.
 */
#include "check.h"
#include "random.h"

enum { ATOMS = 5, BONDS = 4 };
static const int64_t pairs[2 * BONDS] = {0, 1, 1, 2, 1, 3, 3, 4};
static const double masses[ATOMS] = {1, 12, 1, 14, 2}, lengths[BONDS] = {1, 1.2, 1.1, 0.9};

static hol_chains *tree(void)
{
    hol_chains *chains;
    CHECK(hol_chains_create(ATOMS, masses, &chains));
    CHECK(hol_chains_add_bonds(chains, BONDS, pairs, lengths));
    return chains;
}

/** A conformation, velocities and forces. */
static void draw(random_stream *s, double *r, double *v, double *f)
{
    memset(r, 0, 3 * sizeof *r);
    for (int k = 0; k < BONDS; ++k) {
        double d[3], size = 0;
        for (int x = 0; x < 3; ++x) {
            d[x] = random_normal(s);
            size += d[x] * d[x];
        }
        for (int x = 0; x < 3; ++x)
            r[3 * pairs[2 * k + 1] + x] = r[3 * pairs[2 * k] + x] + lengths[k] * d[x] / sqrt(size);
    }
    for (int e = 0; e < 3 * ATOMS; ++e) {
        v[e] = random_normal(s);
        f[e] = random_normal(s);
    }
}

/** The positions, each atom in another image; at most `most` rows away. */
static void scatter(random_stream *s, const double *box, int most, const double *r, double *to)
{
    for (int i = 0; i < ATOMS; ++i)
        for (int x = 0; x < 3; ++x) to[3 * i + x] = r[3 * i + x];
    for (int i = 0; i < ATOMS; ++i)
        for (int row = 0; row < 3; ++row) {
            const double n = (double)random_integer(s, -most, most);
            for (int x = 0; x < 3; ++x) to[3 * i + x] += n * box[3 * row + x];
        }
}

static double largest(const double *a, int n)
{
    double most = 0;
    for (int i = 0; i < n; ++i) most = fmax(most, fabs(a[i]));
    return most;
}

/** What the rounding of coordinates of this size does to bonds of about 1, and so to results, some 100 times. */
static double bound(const double *scattered)
{
    return 200 * DBL_EPSILON * (1 + largest(scattered, 3 * ATOMS));
}

static void forces_and_velocities_are_those_without_a_box(const double *box, uint64_t seed)
{
    random_stream s = random_seed(seed);
    double r[3 * ATOMS], v[3 * ATOMS], f[3 * ATOMS], there[3 * ATOMS], g[2][3 * ATOMS], u[2][3 * ATOMS];
    hol_chains *free_one = tree(), *boxed = tree();
    draw(&s, r, v, f);
    scatter(&s, box, 2, r, there);
    CHECK(hol_chains_set_box(boxed, box));
    CHECK(hol_forces(free_one, r, v, f, NULL, NULL, g[0], HOL_WRITE, NULL));
    CHECK(hol_forces(boxed, there, v, f, NULL, NULL, g[1], HOL_WRITE, NULL));
    memcpy(u[0], v, sizeof v);
    memcpy(u[1], v, sizeof v);
    CHECK(hol_project_velocities(free_one, r, u[0], NULL, NULL));
    CHECK(hol_project_velocities(boxed, there, u[1], NULL, NULL));
    for (int e = 0; e < 3 * ATOMS; ++e) {
        CHECK_AT_MOST(fabs(g[0][e] - g[1][e]), bound(there) * (1 + largest(g[0], 3 * ATOMS)));
        CHECK_AT_MOST(fabs(u[0][e] - u[1][e]), bound(there) * (1 + largest(v, 3 * ATOMS)));
    }
    hol_chains_destroy(free_one);
    hol_chains_destroy(boxed);
}

/* deform .. flip no of LAMMPS lets a tilt grow. */
static void a_tilt_may_grow_without_end(void **state)
{
    (void)state;
    for (double tilt = 0; tilt < 1e4; tilt = 1.3 * tilt + 0.7) {
        const double xy[9] = {10, 0, 0, tilt, 9, 0, 0, 0, 12}, yz[9] = {10, 0, 0, 1, 9, 0, 2, -tilt, 12},
                     all[9] = {10, 0, 0, tilt, 9, 0, -2 * tilt, 3 * tilt, 12};
        forces_and_velocities_are_those_without_a_box(xy, 1);
        forces_and_velocities_are_those_without_a_box(yz, 2);
        forces_and_velocities_are_those_without_a_box(all, 3);
    }
}

/* Rows of reduced cells, combined at random with determinant 1; also of two rows beside one of zeros. */
static void any_rows_of_a_lattice_are_the_same_box(void **state)
{
    (void)state;
    static const double cells[][9] = {{6, 0, 0, 0, 7, 0, 0, 0, 5},
                                      {7, 0, 0, 2.5, 6.5, 0, -1.75, 2, 8},
                                      {7, 0.5, -0.25, 1, 8, 0.75, -1.5, 0.5, 6.5},
                                      {7, 0, 0, 2.5, 6.5, 0, 0, 0, 0},
                                      {0, 0, 0, 0, 9, 1, 0, -2, 6}};
    random_stream s = random_seed(7);
    for (size_t c = 0; c < sizeof cells / sizeof *cells; ++c)
        for (int trial = 0; trial < 100; ++trial) {
            double box[9];
            memcpy(box, cells[c], sizeof box);
            for (int turn = 0; turn < 5; ++turn) {
                const int i = (int)random_integer(&s, 0, 2), j = (i + 1 + (int)random_integer(&s, 0, 1)) % 3;
                const double n = (double)random_integer(&s, -6, 6);
                if (largest(box + 3 * i, 3) == 0 || largest(box + 3 * j, 3) == 0) continue;
                for (int x = 0; x < 3; ++x) box[3 * i + x] += n * box[3 * j + x];
            }
            forces_and_velocities_are_those_without_a_box(box, (uint64_t)(100 * c) + (uint64_t)trial);
        }
}

/* Old and new box have rows of their own, which need not correspond. */
static void positions_take_images_in_either_box(void **state)
{
    (void)state;
    static const double before[9] = {8, 0, 0, 75, 9, 0, 3, 21, 7}, after[9] = {8.1, 0, 0, -4.2, 9.2, 0, 0, 34.1, 7.1};
    for (uint64_t seed = 0; seed < 20; ++seed) {
        random_stream s = random_seed(300 + seed);
        double r[3 * ATOMS], v[3 * ATOMS], f[3 * ATOMS], ref[3 * ATOMS], trial[3 * ATOMS], alone[3 * ATOMS],
            moved[3 * ATOMS];
        hol_chains *free_one = tree(), *boxed = tree();
        draw(&s, r, v, f);
        for (int e = 0; e < 3 * ATOMS; ++e) trial[e] = alone[e] = r[e] + 0.03 * v[e];
        scatter(&s, before, 2, r, ref);
        scatter(&s, after, 2, trial, moved);
        double shift[3 * ATOMS];
        for (int e = 0; e < 3 * ATOMS; ++e) shift[e] = moved[e] - trial[e];
        CHECK(hol_project_positions(free_one, r, alone, NULL, 1, NULL, 0, NULL, NULL));
        CHECK(hol_chains_set_box(boxed, after));
        CHECK(hol_chains_set_reference_box(boxed, before));
        CHECK(hol_project_positions(boxed, ref, moved, NULL, 1, NULL, 0, NULL, NULL));
        for (int e = 0; e < 3 * ATOMS; ++e) CHECK_AT_MOST(fabs(moved[e] - shift[e] - alone[e]), bound(moved));
        hol_chains_destroy(free_one);
        hol_chains_destroy(boxed);
    }
}

/* The lattice, not its rows, says which bonds are too long: its widest cell here is a cube of 2.5. */
static void a_bond_may_be_half_as_long_as_the_lattice_is_wide(void **state)
{
    (void)state;
    static const double cube[9] = {2.5, 0, 0, 25, 2.5, 0, -10, 32.5, 2.5},
                        narrow[9] = {2.3, 0, 0, 23, 2.5, 0, 0, 0, 2.5}, flat[9] = {2.5, 0, 0, 1e3, 1e-9, 0, 0, 0, 2.5},
                        line[9] = {1, 2, 3, 2, 4, 6, 0, 0, 5};
    hol_chains *chains = tree();
    CHECK(hol_chains_set_box(chains, cube));
    CHECK_FAILS(HOL_ERR_VALUE, hol_chains_set_box(chains, narrow));
    assert_message_names("the box is 2.3 wide");
    CHECK_FAILS(HOL_ERR_VALUE, hol_chains_set_box(chains, flat));
    CHECK_FAILS(HOL_ERR_VALUE, hol_chains_set_box(chains, line));
    const double longer[BONDS] = {1, 1.26, 1.1, 0.9};
    CHECK_FAILS(HOL_ERR_VALUE, hol_chains_set_lengths(chains, longer));
    hol_chains_destroy(chains);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_tilt_may_grow_without_end),
        cmocka_unit_test(any_rows_of_a_lattice_are_the_same_box),
        cmocka_unit_test(positions_take_images_in_either_box),
        cmocka_unit_test(a_bond_may_be_half_as_long_as_the_lattice_is_wide),
    };
    return cmocka_run_group_tests_name("cells", tests, NULL, NULL);
}
