/** Massless sites off the plane of a body's masses (lone pairs of water, TIP5P): forces, velocities and positions. */
#include "check.h"
#include "random.h"

/* Two waters with lone pairs, each a body alone, and a frame of five with sites on both sides that a bond ties to an
 * atom, which goes through the general solver. */
enum { N = 18, ALONE = 10, FRAME = 17 };
static const double mass[N] = {16, 1, 1, 0, 0, 0, 16, 0, 1, 1, 12, 0, 13, 14, 0, 15, 0, 9};
#define WATER_Z 0.5715
static const double water[2][15] = {
    {0, 0, 0, 0.585882, 0.756950, 0, 0.585882, -0.756950, 0, -0.404151, 0, WATER_Z, -0.404151, 0, -WATER_Z},
    {-0.404151, 0, WATER_Z, 0, 0, 0, -0.404151, 0, -WATER_Z, 0.585882, 0.756950, 0, 0.585882, -0.756950, 0}};
static const double frame[21] = {1.4, 0.1, 0.2, 0.3,  0.2, 2.1,  -1.2, 0.3, 0.2, 0,  1.5,
                                 0.2, 0.1, 0,   -0.9, 0,   -1.1, 0.2,  0.2, 0.1, 0.2};
static const int64_t sizes[3] = {5, 5, 7}, first[3] = {0, 5, 10}, tie[2] = {10, FRAME};
static const double tie_length = 1.5;

static const double *place_of(int i)
{
    return i < 10 ? water[i / 5] + 3 * (i % 5) : frame + 3 * (i - 10);
}

static hol_chains *make(void)
{
    hol_chains *chains;
    int64_t atoms[17];
    double places[3 * 17];
    for (int i = 0; i < 17; ++i) atoms[i] = i, memcpy(places + 3 * i, place_of(i), 3 * sizeof *places);
    CHECK(hol_chains_create(N, mass, &chains));
    CHECK(hol_chains_add_rigid(chains, 3, sizes, atoms, places, 1, tie, &tie_length));
    return chains;
}

/* x turned about `axis` by its length. */
static void turn(const double *axis, const double *x, double *to)
{
    const double angle = sqrt(axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]);
    const double c = cos(angle), s = angle > 0 ? sin(angle) / angle : 1,
                 k = angle > 1e-3 ? (1 - c) / (angle * angle) : 0.5 - angle * angle / 24;
    const double along = axis[0] * x[0] + axis[1] * x[1] + axis[2] * x[2];
    for (int a = 0; a < 3; ++a) {
        const int b = (a + 1) % 3, d = (a + 2) % 3;
        to[a] = c * x[a] + s * (axis[b] * x[d] - axis[d] * x[b]) + k * along * axis[a];
    }
}

/* All bodies at random, and the atom that is tied to the frame. */
static void make_positions(double *r, uint64_t seed)
{
    random_stream dice = random_seed(seed);
    for (int body = 0; body < 3; ++body) {
        double axis[3], shift[3];
        for (int x = 0; x < 3; ++x) axis[x] = 1.5 * random_normal(&dice), shift[x] = 4 * body + random_normal(&dice);
        for (int64_t i = first[body]; i < first[body] + sizes[body]; ++i) {
            turn(axis, place_of((int)i), r + 3 * i);
            for (int x = 0; x < 3; ++x) r[3 * i + x] += shift[x];
        }
    }
    const double step[3] = {0.9, -1.2, 0};
    for (int x = 0; x < 3; ++x) r[3 * FRAME + x] = r[3 * 10 + x] + step[x];
}

static void make_noise(double *x, double size, uint64_t seed)
{
    random_stream dice = random_seed(seed);
    for (int i = 0; i < 3 * N; ++i) x[i] = size * random_normal(&dice);
}

/* Of two atoms of one body. */
static double distance(const double *r, int64_t i, int64_t j)
{
    double square = 0;
    for (int x = 0; x < 3; ++x) square += (r[3 * i + x] - r[3 * j + x]) * (r[3 * i + x] - r[3 * j + x]);
    return sqrt(square);
}

/* The same in the reference. */
static double distance_in_place(int i, int j)
{
    double two[6];
    memcpy(two, place_of(i), 3 * sizeof *two), memcpy(two + 3, place_of(j), 3 * sizeof *two);
    return distance(two, 0, 1);
}

/* Three distances from masses that are on no line, and on which side, are all that a site has. */
static void assert_in_place(const double *r, int64_t site, int64_t body)
{
    const int64_t end = first[body] + sizes[body];
    for (int64_t i = first[body]; i < end; ++i)
        if (mass[i] > 0) CHECK_AT_MOST(fabs(distance(r, i, site) - distance_in_place((int)i, (int)site)), 1e-13);
    int64_t base[3];
    int n = 0;
    for (int64_t i = first[body]; i < end && n < 3; ++i)
        if (mass[i] > 0) base[n++] = i;
    double volume[2];
    for (int which = 0; which < 2; ++which) {
        double d[3][3];
        for (int k = 0; k < 3; ++k)
            for (int x = 0; x < 3; ++x)
                d[k][x] = which ? place_of((int)(k < 2 ? base[k + 1] : site))[x] - place_of((int)base[0])[x]
                                : r[3 * (k < 2 ? base[k + 1] : site) + x] - r[3 * base[0] + x];
        volume[which] = 0;
        for (int x = 0; x < 3; ++x)
            volume[which] += d[2][x] * (d[0][(x + 1) % 3] * d[1][(x + 2) % 3] - d[0][(x + 2) % 3] * d[1][(x + 1) % 3]);
    }
    CHECK_AT_MOST(fabs(volume[0] - volume[1]), 1e-12);
}

static void for_sites(const double *r)
{
    for (int body = 0; body < 3; ++body)
        for (int64_t i = first[body]; i < first[body] + sizes[body]; ++i)
            if (mass[i] == 0) assert_in_place(r, i, body);
}

/* Springs of unlike strength to the origin, and a quartic one, at each atom of a body. */
static double energy(const double *r, int64_t i)
{
    double square = 0;
    for (int x = 0; x < 3; ++x) square += (1 + 0.3 * x) * r[3 * i + x] * r[3 * i + x];
    return (0.1 + 0.05 * (double)(i % 7)) * square + 1e-3 * square * square;
}
static void add_force(const double *r, int64_t i, double *f)
{
    double square = 0;
    for (int x = 0; x < 3; ++x) square += (1 + 0.3 * x) * r[3 * i + x] * r[3 * i + x];
    for (int x = 0; x < 3; ++x)
        f[3 * i + x] -= (0.2 + 0.1 * (double)(i % 7) + 4e-3 * square) * (1 + 0.3 * x) * r[3 * i + x];
}
static double find_forces(const double *r, double *f)
{
    double sum = 0;
    memset(f, 0, 3 * N * sizeof *f);
    for (int64_t i = 0; i < N; ++i) sum += energy(r, i), add_force(r, i, f);
    return sum;
}

/* The body's energy as it is turned about its first atom and shifted: six derivatives, beside what f + G does there. */
static void forces_are_derivatives_of_the_energy_of_sites(void **state)
{
    (void)state;
    hol_chains *chains = make();
    double r[3 * N], f[3 * N], g[3 * N];
    make_positions(r, 1), find_forces(r, f);
    CHECK(hol_forces(chains, r, NULL, f, NULL, NULL, g, HOL_WRITE, NULL));
    const double h = 1e-4;
    for (int body = 0; body < 2; ++body) /* the frame is pulled by its bond, too */
        for (int way = 0; way < 6; ++way) {
            double u[2] = {0, 0}, work = 0;
            for (int side = 0; side < 2; ++side)
                for (int64_t i = first[body]; i < first[body] + sizes[body]; ++i) {
                    double axis[3] = {0, 0, 0}, arm[3], moved[3 * N];
                    if (way < 3) axis[way] = side ? h : -h;
                    for (int x = 0; x < 3; ++x) arm[x] = r[3 * i + x] - r[3 * first[body] + x];
                    turn(axis, arm, moved + 3 * i);
                    for (int x = 0; x < 3; ++x)
                        moved[3 * i + x] += r[3 * first[body] + x] + (way == 3 + x ? (side ? h : -h) : 0);
                    u[side] += energy(moved, i);
                    for (int x = 0; x < 3 && mass[i] > 0; ++x)
                        work += (side ? 1 : -1) * (f[3 * i + x] + g[3 * i + x]) * moved[3 * i + x] / (2 * h);
                }
            CHECK_AT_MOST(fabs(work + (u[1] - u[0]) / (2 * h)), 3e-8);
        }
    for (int i = 0; i < N; ++i)
        for (int x = 0; x < 3 && mass[i] == 0; ++x) assert_true(g[3 * i + x] == -f[3 * i + x]);
    hol_chains_destroy(chains);
}

static void constraint_forces_are_internal_and_have_their_virial(void **state)
{
    (void)state;
    hol_chains *chains = make();
    double r[3 * N], v[3 * N], f[3 * N], g[3 * N], virial[9] = {0}, sum[9] = {0};
    make_positions(r, 2), make_noise(v, 1, 3), make_noise(f, 1, 4);
    CHECK(hol_forces(chains, r, v, f, NULL, NULL, g, HOL_WRITE, virial));
    const int64_t begin[4] = {0, 5, 10, N};
    for (int m = 0; m < 3; ++m)
        for (int x = 0; x < 3; ++x) {
            double whole = 0, torque = 0;
            for (int64_t i = begin[m]; i < begin[m + 1]; ++i) {
                const int y = (x + 1) % 3, z = (x + 2) % 3;
                whole += g[3 * i + x];
                torque += r[3 * i + y] * g[3 * i + z] - r[3 * i + z] * g[3 * i + y];
            }
            CHECK_AT_MOST(fabs(whole), 1e-12);
            CHECK_AT_MOST(fabs(torque), 1e-11);
        }
    for (int i = 0; i < N; ++i)
        for (int x = 0; x < 9; ++x) sum[x] += r[3 * i + x / 3] * g[3 * i + x % 3];
    for (int x = 0; x < 9; ++x) CHECK_AT_MOST(fabs(virial[x] - sum[x]), 1e-10);
    hol_chains_destroy(chains);
}

/* In a box that changes it is v + L r that is rigid. */
static void velocities_of_sites_are_those_of_their_bodies(void **state)
{
    (void)state;
    const double L[2][9] = {{0}, {0.1, -0.3, 0.2, 0.4, -0.2, 0.1, 0.3, 0.1, 0.25}};
    for (int flows = 0; flows < 2; ++flows) {
        hol_chains *chains = make();
        double r[3 * N], v[3 * N];
        make_positions(r, 5), make_noise(v, 1, 6);
        if (flows) CHECK(hol_chains_set_box_rate(chains, L[1]));
        CHECK(hol_project_velocities(chains, r, v, NULL, NULL));
        for (int step = 0; step < 2;
             ++step) { /* as positions leave them, too, from velocities of sites that say nothing */
            for (int body = 0; body < 3; ++body)
                for (int64_t i = first[body]; i < first[body] + sizes[body]; ++i)
                    for (int64_t j = first[body]; j < i; ++j) {
                        double rate = 0;
                        for (int x = 0; x < 3; ++x) {
                            double u = v[3 * i + x] - v[3 * j + x];
                            for (int y = 0; y < 3; ++y) u += L[flows][3 * x + y] * (r[3 * i + y] - r[3 * j + y]);
                            rate += u * (r[3 * i + x] - r[3 * j + x]);
                        }
                        CHECK_AT_MOST(fabs(rate), 1e-13 * (step ? 10 : 1));
                    }
            if (step == 1) break;
            double from[3 * N];
            memcpy(from, r, sizeof r);
            for (int i = 0; i < 3 * N; ++i) r[i] += 1e-3 * v[i];
            for (int i = 0; i < N; ++i)
                for (int x = 0; x < 3 && mass[i] == 0; ++x) v[3 * i + x] = NAN;
            CHECK(hol_project_positions(chains, from, r, v, 1e-3, NULL, 0, NULL, NULL));
            for_sites(r);
            for (int i = 0; i < N; ++i)
                for (int x = 0; x < 3; ++x) assert_true(isfinite(v[3 * i + x]));
            CHECK(hol_project_velocities(chains, r, v, NULL, NULL));
        }
        hol_chains_destroy(chains);
    }
}

/* Side by side, and by the general solver, to which a box that changes, by nothing, and a tolerance lead. */
static void both_solvers_say_the_same(void **state)
{
    (void)state;
    const double still[9] = {0};
    double r[3 * N], from[3 * N], out[2][4][3 * N], virial[2][9] = {{0}};
    make_positions(from, 7);
    for (int which = 0; which < 2; ++which) {
        hol_chains *chains = make();
        if (which) CHECK(hol_chains_set_box_rate(chains, still));
        if (which) CHECK(hol_chains_set_tolerance(chains, 1e-15));
        double v[3 * N], f[3 * N];
        make_noise(v, 1, 8), make_noise(f, 1, 9), make_noise(r, 0.02, 10);
        for (int i = 0; i < 3 * N; ++i) r[i] += from[i];
        CHECK(hol_forces(chains, from, v, f, NULL, NULL, out[which][0], HOL_WRITE, virial[which]));
        CHECK(hol_project_positions(chains, from, r, v, 0.1, NULL, 0, NULL, NULL));
        memcpy(out[which][1], r, sizeof r), memcpy(out[which][2], v, sizeof v);
        make_noise(v, 1, 11);
        CHECK(hol_project_velocities(chains, from, v, NULL, NULL));
        memcpy(out[which][3], v, sizeof v);
        hol_chains_destroy(chains);
    }
    for (int k = 0; k < 4; ++k)
        for (int i = 0; i < 3 * N; ++i) CHECK_AT_MOST(fabs(out[0][k][i] - out[1][k][i]), 1e-12);
    for (int x = 0; x < 9; ++x) CHECK_AT_MOST(fabs(virial[0][x] - virial[1][x]), 1e-11);
    for_sites(out[0][1]);
}

/* Springs on all atoms, sites among them: the energy moves with the square of the step, and goes nowhere. */
static double spread_of_energy(double dt, int n_steps, double *drift)
{
    hol_chains *chains = make();
    double r[3 * N], v[3 * N], f[3 * N], before[3 * N], start = 0, worst = 0, mean[2] = {0, 0};
    make_positions(r, 12), make_noise(v, 0.3, 13);
    CHECK(hol_project_velocities(chains, r, v, NULL, NULL));
    for (int step = 0; step <= n_steps; ++step) {
        const double potential = find_forces(r, f);
        CHECK(hol_forces(chains, r, NULL, f, NULL, NULL, f, HOL_ADD, NULL));
        for (int i = 0; i < 3 * N && step > 0; ++i) v[i] += mass[i / 3] > 0 ? 0.5 * dt * f[i] / mass[i / 3] : 0;
        if (step > 0) CHECK(hol_project_velocities(chains, r, v, NULL, NULL));
        double kinetic = 0;
        for (int i = 0; i < 3 * N; ++i) kinetic += 0.5 * mass[i / 3] * v[i] * v[i];
        if (step == 0) start = potential + kinetic;
        worst = fmax(worst, fabs(potential + kinetic - start));
        mean[2 * step > n_steps] += (potential + kinetic - start) / (n_steps / 2);
        for (int i = 0; i < 3 * N; ++i) v[i] += mass[i / 3] > 0 ? 0.5 * dt * f[i] / mass[i / 3] : 0;
        memcpy(before, r, sizeof r);
        for (int i = 0; i < 3 * N; ++i) r[i] += dt * v[i];
        CHECK(hol_project_positions(chains, before, r, v, dt, NULL, 0, NULL, NULL));
    }
    for_sites(r);
    hol_chains_destroy(chains);
    *drift = fabs(mean[1] - mean[0]);
    return worst;
}

static void energy_is_conserved(void **state)
{
    (void)state;
    if (quick_run()) return; /* it wants long trajectories */
    double drift[2];
    const double coarse = spread_of_energy(0.02, 4000, drift), fine = spread_of_energy(0.01, 8000, drift + 1);
    CHECK_AT_MOST(fine, coarse / 3.5);
    CHECK_AT_MOST(coarse / 4.5, fine);
    CHECK_AT_MOST(drift[0], 0.1 * coarse);
    CHECK_AT_MOST(drift[1], 0.1 * fine);
}

static void what_no_body_can_carry_is_refused(void **state)
{
    (void)state;
    const double m[6] = {1, 2, 3, 0, 1, 0}, flat[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0.3, 0.3, 0.5},
                 line[9] = {0, 0, 0, 1, 0, 0, 0.3, 0.3, 0.5}, one = 1;
    const int64_t four = 4, three = 3, list[4] = {0, 1, 2, 3}, of_line[3] = {0, 1, 3}, bond[2] = {3, 4},
                  within[2] = {1, 3};
    const double length = sqrt(0.49 + 0.09 + 0.25);
    hol_chains *chains;
    CHECK(hol_chains_create(6, m, &chains));
    CHECK_FAILS(HOL_ERR_VALUE, hol_chains_add_rigid(chains, 1, &three, of_line, line, 0, NULL, NULL));
    assert_message_names("off the line of its masses");
    CHECK_FAILS(HOL_ERR_VALUE, hol_chains_add_rigid(chains, 1, &four, list, flat, 1, bond, &one));
    assert_message_names("atoms 3 and 4 is at a massless site out of the plane");
    assert_int_equal(hol_chains_n_molecules(chains), 0);
    CHECK(hol_chains_add_rigid(chains, 1, &four, list, flat, 1, within, &length));
    assert_int_equal(hol_chains_degrees_of_freedom(chains, 3), 6 + 3);
    /* on the other side */
    double r[18], from[18];
    for (int i = 0; i < 12; ++i) r[i] = flat[i] * (i % 3 == 2 ? -1 : 1);
    for (int i = 12; i < 18; ++i) r[i] = i;
    memcpy(from, r, sizeof r);
    CHECK_FAILS(HOL_ERR_LENGTHS, hol_project_positions(chains, from, r, NULL, 1, NULL, 0, NULL, NULL));
    assert_message_names("atom 3: far from its place in its body");
    CHECK(hol_impose(chains, r, NULL));
    CHECK_AT_MOST(fabs(r[11] - 0.5), 1e-14);
    hol_chains_destroy(chains);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(forces_are_derivatives_of_the_energy_of_sites),
        cmocka_unit_test(constraint_forces_are_internal_and_have_their_virial),
        cmocka_unit_test(velocities_of_sites_are_those_of_their_bodies),
        cmocka_unit_test(both_solvers_say_the_same),
        cmocka_unit_test(energy_is_conserved),
        cmocka_unit_test(what_no_body_can_carry_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
