/** Rigid bodies: added, refused, mixed with other molecules, in boxes; what they conserve. */
#include "check.h"
#include "random.h"

enum { N = 40 };

/* water with a site, a linear molecule, a frame of six with a bond to an atom that is bonded to a fixed one */
static const double mass[N] = {16, 1, 1, 0, 16, 12, 16, 12, 12, 12, 12, 12, 12, 14, 0, 15, 15, 15, 15, 15};
static const double places[13][3] = {{0, 0, 0},      {0.96, 0, 0},    {-0.24, 0.93, 0}, {0.08, 0.1, 0}, {-1.16, 0, 0},
                                     {0, 0, 0},      {1.16, 0, 0},    {1.4, 0, 0},      {0.7, 1.2, 0},  {-0.7, 1.2, 0},
                                     {-1.4, 0, 0.1}, {-0.7, -1.2, 0}, {0.7, -1.2, 0}};
static const int64_t sizes[3] = {4, 3, 6}, atoms[13] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
static const int64_t pairs[2][2] = {{7, 13}, {13, 14}};
static const double lengths[2] = {1.5, 1.5};

/* Positions of all: bodies as their places are, turned and shifted; then a chain of two bonds. */
static void make_positions(double *r, const double *shift)
{
    const double c = cos(0.7), s = sin(0.7);
    for (int i = 0; i < 13; ++i) {
        const double *x = places[i], y[3] = {c * x[0] - s * x[1], s * x[0] + c * x[1], x[2]};
        const int body = i < 4 ? 0 : i < 7 ? 1 : 2;
        r[3 * i] = y[0] + 5 * body + shift[0];
        r[3 * i + 1] = c * y[1] - s * y[2] + shift[1];
        r[3 * i + 2] = s * y[1] + c * y[2] + shift[2];
    }
    for (int i = 13; i < N; ++i)
        for (int x = 0; x < 3; ++x) r[3 * i + x] = shift[x] + 3.7 * (i - 13) * (x == 2);
    const double step[2][3] = {{1.5, 0, 0}, {0.9, 1.2, 0}};
    for (int x = 0; x < 3; ++x) {
        r[3 * 13 + x] = r[3 * 7 + x] + step[0][x];
        r[3 * 14 + x] = r[3 * 13 + x] + step[1][x];
        r[3 * 16 + x] = r[3 * 15 + x] + (x == 0);
        r[3 * 17 + x] = r[3 * 16 + x] + (x == 1);
    }
}

static void make_noise(double *x, uint64_t seed)
{
    random_stream s = random_seed(seed);
    for (int i = 0; i < 3 * N; ++i) x[i] = random_normal(&s);
}

static hol_chains *make(int with_chain)
{
    hol_chains *chains;
    const int64_t line[3] = {15, 16, 17};
    const double ones[2] = {1, 1};
    CHECK(hol_chains_create(N, mass, &chains));
    CHECK(hol_chains_add_rigid(chains, 3, sizes, atoms, places[0], 2, pairs[0], lengths));
    if (with_chain) CHECK(hol_chains_add(chains, 2, line, ones));
    return chains;
}

static const double nowhere[3] = {0.3, -0.2, 0.1};

static void molecules_and_freedoms_are_counted(void **state)
{
    (void)state;
    hol_chains *chains = make(1);
    int shape;
    int64_t n_atoms, n_bonds, bonds[2], of_bonds[4], list[8];
    assert_int_equal(hol_chains_n_molecules(chains), 4); /* the chain first */
    assert_int_equal(hol_chains_n_bonds(chains), 4);
    assert_int_equal(hol_chains_n_of_shape(chains, HOL_SHAPE_RIGID), 3);
    CHECK(hol_chains_molecule(chains, 3, &shape, &n_atoms, &n_bonds));
    assert_int_equal(shape, HOL_SHAPE_RIGID);
    assert_int_equal(n_atoms, 8);
    assert_int_equal(n_bonds, 2);
    CHECK(hol_chains_bonds(chains, 3, bonds));
    CHECK(hol_chains_atoms(chains, 3, list));
    CHECK(hol_chains_molecules_of_bonds(chains, of_bonds));
    assert_int_equal(bonds[1], 1);
    assert_int_equal(list[7], 14);
    assert_true(of_bonds[0] == 3 && of_bonds[1] == 3 && of_bonds[2] == 0 && of_bonds[3] == 0);
    /* 18 atoms that move: bodies have 6, 5 and 6, atom 13 three less two bonds, the chain nine less two */
    assert_int_equal(hol_chains_degrees_of_freedom(chains, 3), 6 + 5 + 6 + 3 - 2 + 9 - 2 + 3 * 2);
    hol_chains_destroy(chains);
}

static void constraint_forces_are_internal(void **state)
{
    (void)state;
    hol_chains *chains = make(0);
    double r[3 * N], v[3 * N], f[3 * N], g[3 * N] = {0}, lambda[2];
    make_positions(r, nowhere), make_noise(v, 1), make_noise(f, 2);
    CHECK(hol_forces(chains, r, v, f, lambda, NULL, g, HOL_WRITE, NULL));
    const int first[4] = {0, 4, 7, 15};
    for (int m = 0; m < 3; ++m)
        for (int x = 0; x < 3; ++x) {
            double sum = 0, torque = 0;
            for (int i = first[m]; i < first[m + 1]; ++i) {
                const int y = (x + 1) % 3, z = (x + 2) % 3;
                sum += g[3 * i + x];
                torque += r[3 * i + y] * g[3 * i + z] - r[3 * i + z] * g[3 * i + y];
            }
            CHECK_AT_MOST(fabs(sum), 1e-12);
            CHECK_AT_MOST(fabs(torque), 1e-11);
        }
    for (int x = 0; x < 3; ++x) assert_true(g[9 + x] == -f[9 + x]); /* the site */
    /* the same into f, added */
    double total[3 * N];
    memcpy(total, f, sizeof f);
    CHECK(hol_forces(chains, r, v, total, NULL, NULL, total, HOL_ADD, NULL));
    for (int i = 0; i < 3 * 14; ++i) CHECK_AT_MOST(fabs(total[i] - f[i] - g[i]), 1e-12 * (1 + fabs(g[i])));
    hol_chains_destroy(chains);
}

/* What the molecules do alone they do beside others, across a face of the box and on any number of threads. */
static void boxes_threads_and_other_molecules_change_nothing(void **state)
{
    (void)state;
    hol_chains *alone = make(0), *both = make(1);
    const double box[9] = {9.1, 0, 0, 0.4, 9.3, 0, -0.7, 0.2, 9.5};
    double r[3 * N], cut[3 * N], v[3 * N], f[3 * N], g[2][3 * N], lambda[2][4], virial[2][9], chain_virial[9];
    make_positions(r, nowhere), make_noise(v, 3), make_noise(f, 4);
    memset(g, 0, sizeof g);
    for (int i = 0; i < N; ++i)
        for (int x = 0; x < 3; ++x) {
            cut[3 * i + x] = r[3 * i + x];
            for (int b = 0; b < 3; ++b) cut[3 * i + x] += ((i * 7 + b) % 3 - 1) * box[3 * b + x];
        }
    CHECK(hol_forces(alone, r, v, f, lambda[0], NULL, g[0], HOL_WRITE, virial[0]));
    CHECK(hol_chains_set_box(both, box));
    CHECK(hol_chains_set_threads(both, 2));
    CHECK(hol_forces(both, cut, v, f, lambda[1], NULL, g[1], HOL_WRITE, virial[1]));
    for (int i = 0; i < 3 * 15; ++i) CHECK_AT_MOST(fabs(g[0][i] - g[1][i]), 1e-11 * (1 + fabs(g[0][i])));
    for (int k = 0; k < 2; ++k) CHECK_AT_MOST(fabs(lambda[0][k] - lambda[1][k]), 1e-11 * (1 + fabs(lambda[0][k])));
    const unsigned char chain_alone[4] = {1, 0, 0, 0};
    CHECK(hol_chains_set_active(both, chain_alone));
    CHECK(hol_forces(both, cut, v, f, NULL, NULL, NULL, HOL_WRITE, chain_virial));
    for (int i = 0; i < 9; ++i) CHECK_AT_MOST(fabs(virial[0][i] + chain_virial[i] - virial[1][i]), 1e-10);
    hol_chains_destroy(alone), hol_chains_destroy(both);
}

/* Crude positions come back to the bodies' shapes; multipliers tell what bonds pull. */
static void positions_and_velocities_obey_the_bodies(void **state)
{
    (void)state;
    hol_chains *chains = make(1);
    double r[3 * N], ref[3 * N], v[3 * N], noise[3 * N], lambda[4];
    hol_worst worst;
    hol_report report;
    make_positions(ref, nowhere), make_noise(noise, 5), make_noise(v, 6);
    for (int i = 0; i < 3 * N; ++i) r[i] = ref[i] + 0.02 * noise[i];
    for (int x = 0; x < 3; ++x) r[3 * 14 + x] = ref[3 * 14 + x];
    CHECK(hol_project_positions(chains, ref, r, v, 0.01, lambda, 0, NULL, &report));
    assert_int_equal(report.n_failed, 0);
    CHECK(hol_project_velocities(chains, r, v, NULL, NULL));
    CHECK(hol_violation(chains, r, v, &worst));
    CHECK_AT_MOST(worst.length, 1e-14);
    CHECK_AT_MOST(worst.rate, 1e-13);
    for (int i = 0; i < 13; ++i)
        for (int j = 0; j < i; ++j) {
            const int a = i < 4 ? 0 : i < 7 ? 1 : 2, b = j < 4 ? 0 : j < 7 ? 1 : 2;
            double d = 0, p = 0;
            if (a != b) continue;
            for (int x = 0; x < 3; ++x) {
                d += pow(r[3 * i + x] - r[3 * j + x], 2);
                p += pow(places[i][x] - places[j][x], 2);
            }
            CHECK_AT_MOST(fabs(sqrt(d) - sqrt(p)), 1e-14);
        }
    /* and stay as they are, bit for bit */
    double again[3 * N];
    memcpy(again, r, sizeof r);
    CHECK(hol_project_positions(chains, r, again, NULL, 0.01, NULL, 0, NULL, &report));
    assert_int_equal(report.n_corrected, 0);
    assert_same_bits(again, r, 3 * N);
    hol_chains_destroy(chains);
}

static void right_hand_sides_of_the_forces_give_their_multipliers(void **state)
{
    (void)state;
    hol_chains *chains = make(0);
    double r[3 * N], v[3 * N], rhs[2], lambda[2], tension[2], g[3 * N] = {0}, pull[3 * N] = {0}, virial[9], parts[2][6];
    make_positions(r, nowhere);
    make_noise(v, 7);
    for (int k = 0; k < 2; ++k) rhs[k] = 1 + k;
    CHECK(hol_solve(chains, r, rhs, lambda, g, HOL_WRITE, NULL));
    CHECK(hol_reactions(chains, r, HOL_BOX, lambda, tension, pull, HOL_WRITE, parts[0], virial));
    CHECK(hol_residuals(chains, r, v, parts[0], parts[1]));
    CHECK_AT_MOST(fabs(parts[0][0]) + fabs(parts[0][1]), 1e-14);
    assert_true(parts[1][0] != 0 && parts[1][1] != 0);
    /* accelerations G/m change the square of each bond's length by -rhs */
    for (int k = 0; k < 2; ++k) {
        const int64_t i = pairs[k][0], j = pairs[k][1];
        double sum = 0, square = 0;
        for (int x = 0; x < 3; ++x) {
            const double d = r[3 * j + x] - r[3 * i + x];
            sum += 2 * d * ((mass[j] > 0 ? g[3 * j + x] / mass[j] : 0) - g[3 * i + x] / mass[i]);
            square += d * d;
        }
        CHECK_AT_MOST(fabs(sum + rhs[k]), 1e-13);
        CHECK_AT_MOST(fabs(tension[k] - 2 * lambda[k] * sqrt(square)), 1e-14);
    }
    for (int x = 0; x < 3; ++x) CHECK_AT_MOST(fabs(pull[3 * 13 + x] - g[3 * 13 + x]), 1e-14);
    for (int c = 0; c < 6; ++c) assert_true(isfinite(parts[0][c] + parts[1][c] + virial[c]));
    hol_chains_destroy(chains);
}

/* Free rotation of an asymmetric body: energy, angular momentum and shape, and back again. */
static void a_free_body_turns_as_it_must_and_back(void **state)
{
    (void)state;
    const int n_steps = quick_run() ? 200 : 5000;
    const double m[5] = {3, 1, 2, 5, 0}, x0[15] = {0, 0, 0, 1, 0, 0, 0.2, 1.1, 0, -0.3, 0.4, 0.9, 0.1, 0.2, 0.3};
    const double dt = 2e-3;
    const int64_t five = 5, list[5] = {0, 1, 2, 3, 4};
    double r[15], v[15], ref[15], spin[3] = {1.1, 0.3, -0.7}, energy[2], L[2][3];
    hol_chains *chains;
    CHECK(hol_chains_create(5, m, &chains));
    CHECK(hol_chains_add_rigid(chains, 1, &five, list, x0, 0, NULL, NULL));
    memcpy(r, x0, sizeof r);
    for (int i = 0; i < 5; ++i)
        for (int x = 0; x < 3; ++x)
            v[3 * i + x] = spin[(x + 1) % 3] * r[3 * i + (x + 2) % 3] - spin[(x + 2) % 3] * r[3 * i + (x + 1) % 3];
    for (int way = 0; way < 2; ++way) {
        for (int s = 0; s <= n_steps; ++s) {
            if (s == 0 || s == n_steps) {
                const int end = s != 0;
                energy[end] = 0;
                memset(L[end], 0, sizeof L[end]);
                for (int i = 0; i < 5; ++i)
                    for (int x = 0; x < 3; ++x) {
                        const int y = (x + 1) % 3, z = (x + 2) % 3;
                        energy[end] += 0.5 * m[i] * v[3 * i + x] * v[3 * i + x];
                        L[end][x] += m[i] * (r[3 * i + y] * v[3 * i + z] - r[3 * i + z] * v[3 * i + y]);
                    }
            }
            if (s == n_steps) break;
            memcpy(ref, r, sizeof r);
            for (int i = 0; i < 15; ++i) r[i] += dt * v[i];
            CHECK(hol_project_positions(chains, ref, r, v, dt, NULL, 0, NULL, NULL));
            CHECK(hol_project_velocities(chains, r, v, NULL, NULL));
        }
        for (int x = 0; x < 3; ++x) CHECK_AT_MOST(fabs(L[1][x] - L[0][x]), 1e-15 * n_steps);
        CHECK_AT_MOST(fabs(energy[1] - energy[0]), 1e-4 * energy[0]);
        for (int i = 0; i < 15; ++i) v[i] = -v[i];
    }
    for (int i = 0; i < 15; ++i) CHECK_AT_MOST(fabs(r[i] - x0[i]), 1e-13 * n_steps);
    hol_chains_destroy(chains);
}

static void assert_empty(const hol_chains *chains)
{
    assert_int_equal(hol_chains_n_molecules(chains), 0);
    assert_int_equal(hol_chains_n_bonds(chains), 0);
    assert_int_equal(hol_chains_n_kinds(chains), 0);
}

static void bad_bodies_are_refused_and_change_nothing(void **state)
{
    (void)state;
    const double m[8] = {1, 2, 3, 0, 0, (double)INFINITY, 1, 1};
    const double x[12] = {0, 0, 0, 1, 0, 0, 2, 0, 0, 1, 1, 0}, same[9] = {1, 1, 1, 1, 1, 1, 1, 1, 1};
    const int64_t two = 2, three = 3, four = 4, one = 1;
    const int64_t list[4] = {0, 1, 2, 3}, massless[2] = {3, 4}, fixed[2] = {0, 5}, twice[3] = {0, 1, 0};
    const int64_t out[2] = {0, 8}, both[4] = {0, 1, 1, 0}, two_bodies[2] = {2, 2}, lone[2] = {0, 3};
    double bad[9] = {0, 0, 0, 1, 0, 0, 2, 0, NAN};
    hol_chains *chains;
    CHECK(hol_chains_create(8, m, &chains));
    CHECK_FAILS(HOL_ERR_NULL, hol_chains_add_rigid(chains, 1, &three, list, NULL, 0, NULL, NULL));
    CHECK_FAILS(HOL_ERR_NULL, hol_chains_add_rigid(chains, 1, &three, list, x, 1, NULL, NULL));
    CHECK_FAILS(HOL_ERR_VALUE, hol_chains_add_rigid(chains, 1, &one, list, x, 0, NULL, NULL));
    CHECK_FAILS(HOL_ERR_VALUE, hol_chains_add_rigid(chains, 1, &two, massless, x, 0, NULL, NULL));
    assert_message_names("no mass");
    CHECK_FAILS(HOL_ERR_VALUE, hol_chains_add_rigid(chains, 1, &two, lone, x, 0, NULL, NULL));
    assert_message_names("mass at one point");
    CHECK_FAILS(HOL_ERR_VALUE, hol_chains_add_rigid(chains, 1, &two, fixed, x, 0, NULL, NULL));
    assert_message_names("atom 5");
    CHECK_FAILS(HOL_ERR_SHARED_ATOM, hol_chains_add_rigid(chains, 1, &three, twice, x, 0, NULL, NULL));
    CHECK_FAILS(HOL_ERR_VALUE, hol_chains_add_rigid(chains, 2, two_bodies, both, x, 0, NULL, NULL));
    assert_message_names("in two bodies, at the distances");
    CHECK_FAILS(HOL_ERR_INDEX, hol_chains_add_rigid(chains, 1, &two, out, x, 0, NULL, NULL));
    CHECK_FAILS(HOL_ERR_VALUE, hol_chains_add_rigid(chains, 1, &three, list, same, 0, NULL, NULL));
    assert_message_names("at one point");
    CHECK_FAILS(HOL_ERR_NOT_FINITE, hol_chains_add_rigid(chains, 1, &three, list, bad, 0, NULL, NULL));
    assert_message_names("atom 2");
    CHECK_FAILS(HOL_ERR_VALUE, hol_chains_add_rigid(chains, 1, &four, list, x, 0, NULL, NULL));
    assert_message_names("off the line");
    const int64_t apart[2] = {6, 7}, inside[2] = {0, 1}, tie[4] = {0, 6, 6, 0};
    const double length[2] = {1, 1}, other = 1.3;
    CHECK_FAILS(HOL_ERR_VALUE, hol_chains_add_rigid(chains, 1, &three, list, x, 1, apart, length));
    CHECK_FAILS(HOL_ERR_VALUE, hol_chains_add_rigid(chains, 1, &three, list, x, 1, inside, &other));
    assert_message_names("another distance");
    CHECK_FAILS(HOL_ERR_DEGENERATE, hol_chains_add_rigid(chains, 1, &three, list, x, 2, tie, length));
    assert_empty(chains);
    /* what was good is still good; its atoms are in use then, its sites, too */
    CHECK(hol_chains_add_rigid(chains, 1, &three, list, x, 1, inside, length));
    CHECK_FAILS(HOL_ERR_SHARED_ATOM, hol_chains_add_bonds(chains, 1, tie, length));
    CHECK_FAILS(HOL_ERR_SHARED_ATOM, hol_chains_add_rigid(chains, 1, &three, list, x, 0, NULL, NULL));
    assert_int_equal(hol_chains_n_molecules(chains), 1);
    hol_chains_destroy(chains);
}

static void bad_data_of_a_molecule_leave_it_alone(void **state)
{
    (void)state;
    hol_chains *chains = make(1);
    double r[3 * N], v[3 * N], g[3 * N], sums[9];
    int64_t molecule, atom, n_bad;
    make_positions(r, nowhere), make_noise(v, 8);
    for (int i = 0; i < 3 * N; ++i) g[i] = 77;
    sums[0] = 77;
    v[3 * 5] = NAN;
    CHECK_FAILS(HOL_ERR_NOT_FINITE, hol_forces(chains, r, v, NULL, NULL, NULL, g, HOL_WRITE, sums));
    hol_error_location(&molecule, NULL, &atom, &n_bad);
    assert_true(molecule == 2 && atom == 5 && n_bad == 1);
    for (int i = 3 * 4; i < 3 * 7; ++i) assert_true(g[i] == 77);
    assert_true(g[0] != 77 && g[3 * 8] != 77 && g[3 * 16] != 77 && sums[0] == 77);
    v[3 * 5] = 0;
    r[3 * 6] += 0.9; /* a body far from its shape */
    CHECK_FAILS(HOL_ERR_LENGTHS, hol_project_positions(chains, r, r, NULL, 1, NULL, 0, NULL, NULL));
    assert_message_names("far from its place");
    hol_report report;
    hol_worst worst;
    CHECK(hol_impose(chains, r, &report));
    assert_true(report.n_corrected >= 1 && report.n_failed == 0 && report.max_error < 1e-13);
    CHECK(hol_violation(chains, r, NULL, &worst));
    CHECK_AT_MOST(worst.length, 1e-13);
    double kT = 1;
    CHECK_FAILS(HOL_ERR_UNSUPPORTED, hol_metric(chains, r, kT, NULL, NULL, sums, NULL, HOL_WRITE));
    CHECK_FAILS(HOL_ERR_UNSUPPORTED, hol_project_positions_along(chains, v, r, NULL, 1, NULL, 0, NULL, NULL));
    hol_inverse *inverse = NULL;
    CHECK_FAILS(HOL_ERR_UNSUPPORTED, hol_inverse_create(chains, 2, r, &inverse));
    hol_chains_destroy(chains);
}

/* The same body many times over, by one call or by many, with other masses afterwards. */
static void many_of_a_kind_are_as_each_alone(void **state)
{
    (void)state;
    const int64_t three = 3, list[3] = {0, 1, 2};
    const double place[9] = {-1.16, 0, 0, 0, 0, 0, 1.16, 0, 0};
    double m[30], other[30], r[90], v[90], g[2][90];
    hol_chains *many, *single;
    random_stream s = random_seed(9);
    for (int i = 0; i < 30; ++i) {
        m[i] = i % 3 == 1 ? 12 : 16;
        other[i] = i % 3 == 1 ? 13 : 15;
        for (int x = 0; x < 3; ++x) {
            r[3 * i + x] = (x == 1 ? 1.16 * (i % 3) : 0) + 4 * (i / 3);
            v[3 * i + x] = random_normal(&s);
        }
    }
    CHECK(hol_chains_create(30, m, &many));
    CHECK(hol_chains_create(30, other, &single));
    CHECK(hol_chains_add_rigid_molecules(many, 10, 3, 0, 1, &three, list, place, 0, NULL, NULL));
    assert_int_equal(hol_chains_n_kinds(many), 1);
    for (int64_t b = 0; b < 10; ++b) {
        const int64_t own[3] = {3 * b, 3 * b + 1, 3 * b + 2};
        CHECK(hol_chains_add_rigid(single, 1, &three, own, place, 0, NULL, NULL));
    }
    // Of no molecule nothing is read.
    CHECK(hol_chains_add_rigid_molecules(many, 0, 3, 0, 2, NULL, NULL, NULL, 1, NULL, NULL));
    assert_int_equal(hol_chains_n_molecules(many), 10);
    CHECK(hol_chains_set_masses(many, other));
    assert_int_equal(hol_chains_n_kinds(many), 1);
    CHECK(hol_forces(many, r, v, NULL, NULL, NULL, g[0], HOL_WRITE, NULL));
    CHECK(hol_forces(single, r, v, NULL, NULL, NULL, g[1], HOL_WRITE, NULL));
    assert_same_bits(g[0], g[1], 90);
    CHECK_FAILS(HOL_ERR_SHARED_ATOM,
                hol_chains_add_rigid_molecules(many, 1, 3, 0, 1, &three, list, place, 0, NULL, NULL));
    CHECK_FAILS(HOL_ERR_INDEX, hol_chains_add_rigid_molecules(many, 11, 3, 0, 1, &three, list, place, 0, NULL, NULL));
    hol_chains_destroy(many), hol_chains_destroy(single);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(molecules_and_freedoms_are_counted),
        cmocka_unit_test(constraint_forces_are_internal),
        cmocka_unit_test(boxes_threads_and_other_molecules_change_nothing),
        cmocka_unit_test(positions_and_velocities_obey_the_bodies),
        cmocka_unit_test(right_hand_sides_of_the_forces_give_their_multipliers),
        cmocka_unit_test(a_free_body_turns_as_it_must_and_back),
        cmocka_unit_test(bad_bodies_are_refused_and_change_nothing),
        cmocka_unit_test(bad_data_of_a_molecule_leave_it_alone),
        cmocka_unit_test(many_of_a_kind_are_as_each_alone),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
