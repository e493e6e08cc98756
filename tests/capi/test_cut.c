/* A box that is a hundredth off moves the molecules that its faces cut, by less than references may be off: it is seen
 * by how these fit beside those inside, bonds and bodies alike. Rounded coordinates are no such box. */
#include "check.h"

enum { MOLECULES = 27, ATOMS = 3 * MOLECULES };
static const double edge = 9.3, oh = 0.9572;

static void shape(double at[3][3])
{
    const double angle = 104.52 * 3.14159265358979324 / 180;
    memset(at, 0, 9 * sizeof at[0][0]);
    at[1][0] = oh;
    at[2][0] = oh * cos(angle);
    at[2][1] = oh * sin(angle);
}

static double random_number(unsigned *state)
{
    *state = *state * 1664525u + 1013904223u;
    return *state / 4294967296.0;
}

/* n waters anywhere in a cube, each turned at random; wrapped atom by atom, to `decimals`, or to all digits if 0. */
static void positions(int n, double side, int decimals, unsigned seed, double (*r)[3])
{
    const double unit = pow(10, decimals);
    double at[3][3];
    shape(at);
    for (int m = 0; m < n; ++m) {
        double q[4], size = 0, centre[3];
        for (int c = 0; c < 4; ++c) q[c] = random_number(&seed) - 0.5, size += q[c] * q[c];
        for (int c = 0; c < 4; ++c) q[c] /= sqrt(size);
        for (int c = 0; c < 3; ++c) centre[c] = side * random_number(&seed);
        for (int i = 0; i < 3; ++i) {
            const double *const u = at[i];
            const double t[3] = {2 * (q[2] * u[2] - q[3] * u[1]), 2 * (q[3] * u[0] - q[1] * u[2]),
                                 2 * (q[1] * u[1] - q[2] * u[0])};
            const double turned[3] = {u[0] + q[0] * t[0] + q[2] * t[2] - q[3] * t[1],
                                      u[1] + q[0] * t[1] + q[3] * t[0] - q[1] * t[2],
                                      u[2] + q[0] * t[2] + q[1] * t[1] - q[2] * t[0]};
            for (int c = 0; c < 3; ++c) {
                double x = centre[c] + turned[c];
                if (decimals) x = round(x * unit) / unit;
                r[3 * m + i][c] = x - side * floor(x / side);
            }
        }
    }
}

static hol_chains *waters(int n, int bodies, double side)
{
    const int64_t three = 3, atoms[3] = {0, 1, 2}, pairs[6] = {0, 1, 0, 2, 1, 2};
    double masses[ATOMS], at[3][3];
    hol_chains *chains;
    shape(at);
    for (int i = 0; i < ATOMS; ++i) masses[i] = i % 3 ? 1 : 16;
    const double lengths[3] = {oh, oh, hypot(at[2][0] - oh, at[2][1])};
    CHECK(hol_chains_create(3 * n, masses, &chains));
    if (bodies)
        CHECK(hol_chains_add_rigid_molecules(chains, n, 3, 0, 1, &three, atoms, at[0], 0, NULL, NULL));
    else
        CHECK(hol_chains_add_molecules(chains, n, 3, 0, 3, pairs, lengths));
    const double box[9] = {side, 0, 0, 0, side, 0, 0, 0, side};
    CHECK(hol_chains_set_box(chains, box));
    return chains;
}

static void one_that_is_slightly_wrong_is_seen(void **state)
{
    (void)state;
    const double wrong[4] = {9.4, 9.2, 9.33, 9.285};
    double r[ATOMS][3], kept[ATOMS][3];
    for (int bodies = 0; bodies < 2; ++bodies)
        for (unsigned seed = 1; seed < 5; ++seed) {
            positions(MOLECULES, edge, 0, seed, r);
            memcpy(kept, r, sizeof r);
            for (int k = 0; k < 4; ++k) {
                hol_chains *const chains = waters(MOLECULES, bodies, wrong[k]);
                assert_int_equal(hol_project_positions(chains, r[0], r[0], NULL, 1, NULL, 0, NULL, NULL),
                                 HOL_ERR_LENGTHS);
                assert_message_names("a face of the box cuts it");
                assert_message_names("molecule");
                assert_int_equal(hol_chains_check(chains, r[0], HOL_BOX), HOL_ERR_LENGTHS);
                assert_memory_equal(r, kept, sizeof r);
                CHECK(hol_chains_set_checks(chains, HOL_NEVER));
                CHECK(hol_project_positions(chains, kept[0], r[0], NULL, 1, NULL, 0, NULL, NULL));
                memcpy(r, kept, sizeof r);
                hol_chains_destroy(chains);
            }
            hol_chains *const chains = waters(MOLECULES, bodies, edge);
            CHECK(hol_project_positions(chains, r[0], r[0], NULL, 1, NULL, 0, NULL, NULL));
            hol_chains_destroy(chains);
        }
}

/* Of a file: with three decimals, and with two, as of nanometres with three. Few molecules, of which most are cut. */
static void rounded_positions_are_right(void **state)
{
    (void)state;
    const int counts[6] = {2, 3, 4, 6, 12, 27};
    double r[ATOMS][3];
    for (int bodies = 0; bodies < 2; ++bodies)
        for (int decimals = 2; decimals < 4; ++decimals)
            for (int k = 0; k < 6; ++k)
                for (unsigned seed = 1; seed <= (quick_run() ? 8 : 100); ++seed) {
                    const double side = counts[k] < 20 ? 5 : edge;
                    hol_chains *const chains = waters(counts[k], bodies, side);
                    positions(counts[k], side, decimals, seed, r);
                    CHECK(hol_project_positions(chains, r[0], r[0], NULL, 1, NULL, 0, NULL, NULL));
                    hol_chains_destroy(chains);
                }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_that_is_slightly_wrong_is_seen),
        cmocka_unit_test(rounded_positions_are_right),
    };
    return cmocka_run_group_tests_name("cut", tests, NULL, NULL);
}
