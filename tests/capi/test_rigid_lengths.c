/** Distances that depend on each other: three atoms on a line, four in a plane, five and more, rings held in a plane.
 */
#include "check.h"
#include "random.h"

enum { MOST = 16 };

typedef struct part {
    int n, n_bonds;
    double place[3 * MOST], mass[MOST], length[MOST * MOST];
    int64_t pairs[MOST * MOST];
} part;

static void add_bond(part *p, int i, int j)
{
    double square = 0;
    for (int x = 0; x < 3; ++x) square += pow(p->place[3 * i + x] - p->place[3 * j + x], 2);
    p->pairs[2 * p->n_bonds] = i;
    p->pairs[2 * p->n_bonds + 1] = j;
    p->length[p->n_bonds++] = sqrt(square);
}

/** n atoms anywhere on a line, in a plane or in space, with all their distances. */
static part make_clique(int n, int dimension, uint64_t seed)
{
    part p = {.n = n};
    random_stream s = random_seed(seed);
    for (int i = 0; i < n; ++i) {
        p.mass[i] = 1 + i % 3;
        for (int x = 0; x < dimension; ++x) p.place[3 * i + x] = random_normal(&s);
    }
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < i; ++j) add_bond(&p, i, j);
    return p;
}

/** A ring of unequal sides on a circle or an ellipse, bonded to the next and to the one behind that. */
static part make_ring(int n)
{
    part p = {.n = n};
    for (int i = 0; i < n; ++i) {
        const double angle = 2 * acos(-1.0) / n * (i + 0.2 * sin(3.0 * i));
        p.mass[i] = 12 + i;
        p.place[3 * i] = 1.4 * cos(angle);
        p.place[3 * i + 1] = 1.2 * sin(angle);
    }
    for (int step = 1; step < 3; ++step)
        for (int i = 0; i < n; ++i) add_bond(&p, i, (i + step) % n);
    return p;
}

static void make_state(const part *p, double *r, double *v, double *f)
{
    const double c = cos(0.4), s = sin(0.4);
    random_stream dice = random_seed(17);
    for (int i = 0; i < p->n; ++i) {
        const double *x = p->place + 3 * i, y[3] = {c * x[0] - s * x[1], s * x[0] + c * x[1], x[2]};
        r[3 * i] = y[0] + 0.3, r[3 * i + 1] = c * y[1] - s * y[2], r[3 * i + 2] = s * y[1] + c * y[2];
        if (p->n % 2) r[3 * i] = -r[3 * i]; /* lengths do not know the mirror image */
        for (int k = 0; k < 3; ++k) v[3 * i + k] = random_normal(&dice), f[3 * i + k] = random_normal(&dice);
    }
}

typedef struct results {
    double g[3 * MOST], v[3 * MOST], r[3 * MOST], virial[9], lambda[MOST * MOST];
} results;

static results compute(const part *p, hol_chains *chains, double *lambda)
{
    results o;
    double r[3 * MOST], v[3 * MOST], f[3 * MOST];
    make_state(p, r, v, f);
    CHECK(hol_forces(chains, r, v, f, lambda, NULL, o.g, HOL_WRITE, o.virial));
    memcpy(o.v, v, sizeof v);
    CHECK(hol_project_velocities(chains, r, o.v, NULL, NULL));
    for (int i = 0; i < 3 * p->n; ++i) o.r[i] = r[i] + 0.02 * v[i];
    CHECK(hol_project_positions(chains, r, o.r, NULL, 0.02, NULL, 0, NULL, NULL));
    hol_chains_destroy(chains);
    return o;
}

static hol_chains *chains_of(const part *p)
{
    hol_chains *chains;
    CHECK(hol_chains_create(p->n, p->mass, &chains));
    CHECK(hol_chains_add_bonds(chains, p->n_bonds, p->pairs, p->length));
    return chains;
}

/** The same as the body by its coordinates; multipliers that pull as it does where they can, the least of these. */
static void check_part(const part *p, int dimension)
{
    hol_chains *chains = chains_of(p), *body;
    const int64_t n = p->n;
    int64_t list[MOST];
    double lambda[MOST * MOST], r[3 * MOST], v[3 * MOST], f[3 * MOST];
    assert_int_equal(hol_chains_n_of_shape(chains, HOL_SHAPE_RIGID), 1);
    assert_int_equal(hol_chains_n_bonds(chains), p->n_bonds);
    assert_int_equal(hol_chains_degrees_of_freedom(chains, 3), dimension == 1 ? 5 : 6);
    for (int64_t i = 0; i < n; ++i) list[i] = i;
    CHECK(hol_chains_create(n, p->mass, &body));
    CHECK(hol_chains_add_rigid(body, 1, &n, list, p->place, 0, NULL, NULL));
    results by_lengths = compute(p, chains, lambda), by_places = compute(p, body, NULL);
    make_state(p, r, v, f);
    for (int i = 0; i < 3 * p->n; ++i) {
        CHECK_AT_MOST(fabs(by_lengths.g[i] - by_places.g[i]), 1e-12);
        CHECK_AT_MOST(fabs(by_lengths.v[i] - by_places.v[i]), 1e-13);
        CHECK_AT_MOST(fabs(by_lengths.r[i] - by_places.r[i]), 1e-13);
    }
    /* What is left of the forces lies across all bonds: in a body of three dimensions nothing is. */
    for (int k = 0; k < p->n_bonds; ++k)
        for (int x = 0; x < 3; ++x) {
            const int64_t i = p->pairs[2 * k], j = p->pairs[2 * k + 1];
            const double pull = 2 * lambda[k] * (r[3 * j + x] - r[3 * i + x]);
            by_lengths.g[3 * i + x] -= pull;
            by_lengths.g[3 * j + x] += pull;
        }
    for (int k = 0; k < p->n_bonds; ++k) {
        double along = 0;
        for (int x = 0; x < 3; ++x) {
            const int64_t i = p->pairs[2 * k], j = p->pairs[2 * k + 1];
            along += (r[3 * j + x] - r[3 * i + x]) * (by_lengths.g[3 * j + x] - by_lengths.g[3 * i + x]);
        }
        CHECK_AT_MOST(fabs(along), 1e-11);
    }
    for (int i = 0; dimension == 3 && i < 3 * p->n; ++i) CHECK_AT_MOST(fabs(by_lengths.g[i]), 1e-12);
}

static void dependent_distances_are_bodies(void **state)
{
    (void)state;
    for (int dimension = 1; dimension < 4; ++dimension)
        for (int n = dimension + 2; n < 9; ++n) {
            const part p = make_clique(n, dimension, (uint64_t)(10 * n + dimension));
            check_part(&p, dimension);
        }
    for (int n = 6; n < 11; ++n) {
        const part p = make_ring(n);
        check_part(&p, 2);
    }
}

/** Ten multipliers for nine equations: none along the stress that five points in space can have. */
static void multipliers_of_ten_distances_have_the_least_norm(void **state)
{
    (void)state;
    const double coefficient[5] = {-4, 1, 1, 1, 1}; /* of methane's atoms: sum c = 0, sum c x = 0 */
    part p = {.n = 5};
    for (int i = 1; i < 5; ++i)
        for (int x = 0; x < 3; ++x) p.place[3 * i + x] = i == 1 || i == x + 2 ? 0.63 : -0.63;
    for (int i = 0; i < 5; ++i) p.mass[i] = i == 0 ? 12 : 1;
    for (int i = 0; i < 5; ++i)
        for (int j = 0; j < i; ++j) add_bond(&p, i, j);
    double lambda[10], along = 0;
    compute(&p, chains_of(&p), lambda);
    for (int k = 0; k < 10; ++k) along += lambda[k] * coefficient[p.pairs[2 * k]] * coefficient[p.pairs[2 * k + 1]];
    CHECK_AT_MOST(fabs(along), 1e-13);
}

static void bent_and_puckered_ones_stay_as_they_are(void **state)
{
    (void)state;
    for (int which = 0; which < 3; ++which) {
        part p = which == 0 ? make_clique(3, 1, 5) : which == 1 ? make_clique(4, 2, 5) : make_ring(6);
        p.place[3 * 2 + 2] += 1e-5;
        p.n_bonds = 0;
        for (int i = 0; which < 2 && i < p.n; ++i)
            for (int j = 0; j < i; ++j) add_bond(&p, i, j);
        for (int k = 0; which == 2 && k < 12; ++k) add_bond(&p, k % 6, (k % 6 + 1 + k / 6) % 6);
        hol_chains *chains = chains_of(&p);
        assert_int_equal(hol_chains_n_of_shape(chains, HOL_SHAPE_RIGID), 0);
        hol_chains_destroy(chains);
    }
}

static void lengths_that_disagree_are_named_and_nothing_is_added(void **state)
{
    (void)state;
    part p = make_clique(6, 3, 9);
    hol_chains *chains;
    int64_t bond = -1;
    p.length[4] *= 1.1;
    CHECK(hol_chains_create(6, p.mass, &chains));
    CHECK_FAILS(HOL_ERR_DEGENERATE, hol_chains_add_bonds(chains, p.n_bonds, p.pairs, p.length));
    assert_message_names("hol_chains_add_rigid");
    hol_error_location(NULL, &bond, NULL, NULL);
    assert_in_range(bond, 0, p.n_bonds - 1);
    assert_int_equal(hol_chains_n_bonds(chains), 0);
    assert_int_equal(hol_chains_n_molecules(chains), 0);
    p.length[4] /= 1.1;
    CHECK(hol_chains_add_bonds(chains, p.n_bonds, p.pairs, p.length));
    CHECK_FAILS(HOL_ERR_SHARED_ATOM, hol_chains_add_bonds(chains, p.n_bonds, p.pairs, p.length));
    hol_chains_destroy(chains);
}

/** Of which lengths of a part decimals are left: all; all but the one with full digits; every other one, the rest with
 * full digits or with two decimals more; all, handed over as floats. */
typedef enum mix { ALL, ALL_BUT_FIRST, ALL_BUT_LAST, EVERY_OTHER, MORE_OR_LESS, FLOATS, N_MIXES } mix;

static double left_of(double length, double scale, mix how, int k, int n)
{
    const int full =
        (how == ALL_BUT_FIRST && k == 0) || (how == ALL_BUT_LAST && k == n - 1) || (how == EVERY_OTHER && k % 2 == 1);
    if (how == MORE_OR_LESS && k % 2 == 1) scale *= 100;
    const double rounded = full ? length : round(length * scale) / scale;
    return how == FLOATS ? (double)(float)rounded : rounded;
}

/** What a file's decimals leave of all distances among places: the body as it was, but for these decimals. */
static void check_decimals(part p, int dimension, int decimals, mix how)
{
    const double scale = pow(10, decimals);
    double largest = -1, r[3 * MOST], v[3 * MOST], f[3 * MOST], x[3 * MOST];
    int64_t bond = -1;
    for (int k = 0; k < p.n_bonds; ++k) p.length[k] = left_of(p.length[k], scale, how, k, p.n_bonds);
    hol_chains *chains = chains_of(&p);
    assert_int_equal(hol_chains_n_of_shape(chains, HOL_SHAPE_RIGID), 1);
    assert_int_equal(hol_chains_degrees_of_freedom(chains, 3), dimension == 1 ? 5 : 6);
    CHECK(hol_chains_adjustment(chains, &largest, &bond));
    make_state(&p, r, v, f);
    CHECK(hol_impose(chains, r, NULL));
    for (int step = 0; step < 20; ++step) {
        for (int e = 0; e < 3 * p.n; ++e) x[e] = r[e] + 0.001 * v[e];
        CHECK(hol_project_positions(chains, r, x, NULL, 0.001, NULL, 0, NULL, NULL));
        memcpy(r, x, sizeof r);
        CHECK(hol_project_velocities(chains, r, v, NULL, NULL));
    }
    double worst = 0;
    for (int k = 0; k < p.n_bonds; ++k) {
        double square = 0;
        for (int c = 0; c < 3; ++c) square += pow(r[3 * p.pairs[2 * k] + c] - r[3 * p.pairs[2 * k + 1] + c], 2);
        const double error = fabs(sqrt(square) / p.length[k] - 1);
        if (error > worst) worst = error;
        if (k == bond) CHECK_AT_MOST(fabs(error - largest), 1e-12);
        CHECK_AT_MOST(fabs(sqrt(square) - p.length[k]) * scale, 1.0);
    }
    CHECK_AT_MOST(worst - largest, 1e-12);
    hol_chains_destroy(chains);
}

static part add_all(part p)
{
    p.n_bonds = 0;
    for (int i = 0; i < p.n; ++i)
        for (int j = 0; j < i; ++j) add_bond(&p, i, j);
    return p;
}

static void lengths_with_the_decimals_of_a_file_are_flat_straight_and_rigid(void **state)
{
    (void)state;
    const double circle = 2 * acos(-1.0);
    part line = {.n = 3, .mass = {16, 12, 16}, .place = {-1.162, 0, 0, 0, 0, 0, 1.1634, 0, 0}};
    part nitrate = {.n = 4, .mass = {14, 16, 16, 16}}, octahedron = {.n = 7, .mass = {31, 19, 19, 19, 19, 19, 19}};
    part benzene = {.n = 12}, sulfate = {.n = 5, .mass = {32, 16, 16, 16, 16}};
    for (int i = 0; i < 3; ++i) {
        nitrate.place[3 + 3 * i] = 0.126 * cos(circle / 3 * i), nitrate.place[4 + 3 * i] = 0.126 * sin(circle / 3 * i);
        octahedron.place[3 + 4 * i] = 0.16, octahedron.place[12 + 4 * i] = -0.16;
    }
    for (int i = 1; i < 5; ++i)
        for (int x = 0; x < 3; ++x) sulfate.place[3 * i + x] = 0.149 / sqrt(3.0) * (i == 1 || i == x + 2 ? 1 : -1);
    for (int i = 0; i < 12; ++i) {
        benzene.mass[i] = i < 6 ? 12 : 1;
        benzene.place[3 * i] = (i < 6 ? 0.1395 : 0.2475) * cos(circle / 6 * i);
        benzene.place[3 * i + 1] = (i < 6 ? 0.1395 : 0.2475) * sin(circle / 6 * i);
    }
    for (int i = 0; i < 6; ++i) {
        const int next = (i + 1) % 6;
        add_bond(&benzene, i, next), add_bond(&benzene, i, (i + 2) % 6), add_bond(&benzene, i, i + 6);
        add_bond(&benzene, i, next + 6), add_bond(&benzene, next, i + 6);
    }
    for (int decimals = 3; decimals < 13; ++decimals) {
        for (mix how = ALL; how < N_MIXES; ++how) {
            if (how != ALL && decimals > 5) break;
            check_decimals(add_all(line), 1, decimals, how);
            check_decimals(add_all(nitrate), 2, decimals, how);
            check_decimals(add_all(octahedron), 3, decimals, how);
            check_decimals(add_all(sulfate), 3, decimals, how);
            check_decimals(benzene, 2, decimals, how);
        }
    }
}

/** A pyramid whose height is well above its decimals stays one; with a tolerance of 0 nothing is adjusted. */
static void what_decimals_do_not_leave_open_stays(void **state)
{
    (void)state;
    part pyramid = {.n = 4, .mass = {14, 1, 1, 1}, .place = {0, 0, 0.02}};
    for (int i = 0; i < 3; ++i)
        pyramid.place[3 + 3 * i] = 0.1 * cos(2.1 * i), pyramid.place[4 + 3 * i] = 0.1 * sin(2.1 * i);
    pyramid = add_all(pyramid);
    for (int k = 0; k < 6; ++k) pyramid.length[k] = round(pyramid.length[k] * 1e5) / 1e5;
    hol_chains *chains = chains_of(&pyramid);
    double largest;
    int64_t bond;
    assert_int_equal(hol_chains_n_of_shape(chains, HOL_SHAPE_RIGID), 0);
    CHECK(hol_chains_adjustment(chains, &largest, &bond));
    assert_true(largest == 0 && bond == -1);
    hol_chains_destroy(chains);

    part p = make_clique(6, 3, 9);
    for (int k = 0; k < p.n_bonds; ++k) p.length[k] = round(p.length[k] * 1e6) / 1e6;
    CHECK(hol_chains_create(6, p.mass, &chains));
    CHECK_FAILS(HOL_ERR_VALUE, hol_chains_set_length_tolerance(chains, 0.02));
    CHECK_FAILS(HOL_ERR_VALUE, hol_chains_set_length_tolerance(chains, NAN));
    CHECK(hol_chains_set_length_tolerance(chains, 0));
    CHECK_FAILS(HOL_ERR_DEGENERATE, hol_chains_add_bonds(chains, p.n_bonds, p.pairs, p.length));
    assert_message_names("hol_chains_set_length_tolerance");
    CHECK(hol_chains_set_length_tolerance(chains, 1e-3));
    CHECK(hol_chains_add_bonds(chains, p.n_bonds, p.pairs, p.length));
    CHECK(hol_chains_set_lengths(chains, p.length)); /* the same: nothing is measured again */
    hol_chains_destroy(chains);
}

/** Two groups of five atoms that share two: which distances others imply is told, and all are held. */
static void all_bonds_and_angles_of_ethane(void **state)
{
    (void)state;
    part p = {.n = 8, .mass = {12, 12, 1, 1, 1, 1, 1, 1}};
    p.place[0] = -0.765, p.place[3] = 0.765;
    for (int h = 0; h < 6; ++h) {
        const double angle = 2 * acos(-1.0) / 3 * h + (h < 3 ? 0 : 0.4), side = h < 3 ? -1 : 1;
        p.place[6 + 3 * h] = side * 1.13, p.place[7 + 3 * h] = 1.03 * cos(angle),
                        p.place[8 + 3 * h] = 1.03 * sin(angle);
    }
    add_bond(&p, 0, 1);
    for (int h = 0; h < 6; ++h) {
        add_bond(&p, 0, 2 + h), add_bond(&p, 1, 2 + h);
        add_bond(&p, 2 + h, 2 + h / 3 * 3 + (h + 1) % 3);
    }
    hol_chains *chains = chains_of(&p);
    unsigned char implied[19];
    double lambda[19], r[3 * MOST], v[3 * MOST], f[3 * MOST], g[3 * MOST];
    int n_implied = 0;
    assert_int_equal(hol_chains_degrees_of_freedom(chains, 3), 7);
    assert_int_equal(hol_chains_n_of_shape(chains, HOL_SHAPE_RIGID), 0);
    CHECK(hol_chains_implied(chains, implied));
    make_state(&p, r, v, f);
    CHECK(hol_forces(chains, r, NULL, f, lambda, NULL, g, HOL_WRITE, NULL));
    for (int k = 0; k < 19; ++k) {
        const int64_t i = p.pairs[2 * k], j = p.pairs[2 * k + 1];
        double rate = 0;
        n_implied += implied[k];
        if (implied[k]) assert_true(lambda[k] == 0);
        for (int x = 0; x < 3; ++x)
            rate += (r[3 * j + x] - r[3 * i + x]) *
                    ((f[3 * j + x] + g[3 * j + x]) / p.mass[j] - (f[3 * i + x] + g[3 * i + x]) / p.mass[i]);
        CHECK_AT_MOST(fabs(rate), 1e-12);
    }
    assert_int_equal(n_implied, 2);
    hol_chains_destroy(chains);

    p.length[1] *= 1.1; /* of five atoms, none of which has another place */
    CHECK(hol_chains_create(8, p.mass, &chains));
    CHECK_FAILS(HOL_ERR_DEGENERATE, hol_chains_add_bonds(chains, 19, p.pairs, p.length));
    assert_message_names("tolerance");
    hol_chains_destroy(chains);
}

/** Two flat groups with a common side, as all angles of ethylene make them: the torsion is left, and nothing else. */
static void flat_groups_that_share_atoms_turn_about_them(void **state)
{
    (void)state;
    part p = {.n = 6,
              .mass = {12, 12, 1, 1, 1, 1},
              .place = {-0.66, 0, 0, 0.66, 0, 0, -1.2, 0.9, 0, -1.2, -0.9, 0, 1.2, 0.9, 0, 1.2, -0.9, 0}};
    double r[3 * MOST], v[3 * MOST], f[3 * MOST], g[3 * MOST], lambda[11], length, rate;
    unsigned char implied[11];
    int n_implied = 0;
    add_bond(&p, 0, 1), add_bond(&p, 2, 3), add_bond(&p, 4, 5);
    for (int h = 2; h < 6; ++h) add_bond(&p, 0, h), add_bond(&p, 1, h);
    hol_chains *chains = chains_of(&p);
    assert_int_equal(hol_chains_degrees_of_freedom(chains, 3), 7);
    CHECK(hol_chains_implied(chains, implied));
    for (int k = 0; k < p.n_bonds; ++k) n_implied += implied[k];
    assert_int_equal(n_implied, 6); /* 18 - 7 = 3 for each of two relations, and 5 distances */
    make_state(&p, r, v, f);
    CHECK(hol_forces(chains, r, NULL, f, lambda, NULL, g, HOL_WRITE, NULL));
    for (int k = 0; k < p.n_bonds; ++k) {
        const int64_t i = p.pairs[2 * k], j = p.pairs[2 * k + 1];
        rate = 0;
        if (implied[k]) assert_true(lambda[k] == 0);
        for (int x = 0; x < 3; ++x)
            rate += (r[3 * j + x] - r[3 * i + x]) *
                    ((f[3 * j + x] + g[3 * j + x]) / p.mass[j] - (f[3 * i + x] + g[3 * i + x]) / p.mass[i]);
        CHECK_AT_MOST(fabs(rate), 1e-12);
    }
    CHECK(hol_project_velocities(chains, r, v, NULL, NULL));
    hol_worst worst;
    CHECK(hol_violation(chains, r, v, &worst));
    length = worst.length, rate = worst.rate;
    CHECK_AT_MOST(length, 1e-14);
    CHECK_AT_MOST(rate, 1e-13);
    hol_chains_destroy(chains);
}

/** In one list with waters and tails: each bond keeps its place in the arrays. */
static void bodies_and_others_come_in_one_list(void **state)
{
    (void)state;
    const double mass[9] = {16, 12, 16, 15, 16, 1, 1, 0, 14}, line = 2.32;
    const int64_t pairs[16] = {4, 5, 0, 2, 5, 6, 0, 1, 2, 3, 1, 2, 6, 4, 7, 8};
    const double length[8] = {1, line, 1.6, line / 2, 1.5, line / 2, 1, 2};
    const double r[27] = {-line / 2, 0, 0, 0, 0, 0,     line / 2, 0, 0, line / 2, 1.5, 0, 5, 0,
                          0,         6, 0, 0, 5, -0.28, 0.96,     9, 9, 9,        9,   9, 11};
    double f[27], g[27], lambda[8], v[27] = {0};
    hol_chains *chains;
    int64_t numbers[8];
    random_stream s = random_seed(2);
    for (int i = 0; i < 27; ++i) f[i] = random_normal(&s);
    CHECK(hol_chains_create(9, mass, &chains));
    CHECK(hol_chains_add_bonds(chains, 8, pairs, length));
    assert_int_equal(hol_chains_n_molecules(chains), 3);
    assert_int_equal(hol_chains_n_of_shape(chains, HOL_SHAPE_RIGID), 1);
    CHECK(hol_chains_molecules_of_bonds(chains, numbers));
    const int64_t expected[8] = {0, 2, 0, 2, 2, 2, 0, 1};
    for (int k = 0; k < 8; ++k) assert_int_equal(numbers[k], expected[k]);
    CHECK(hol_chains_set_checks(chains, HOL_NEVER));
    CHECK(hol_forces(chains, r, v, f, lambda, NULL, g, HOL_WRITE, NULL));
    for (int k = 0; k < 8; ++k) { /* accelerations keep each distance */
        double rate = 0;
        for (int x = 0; x < 3; ++x) {
            const int64_t i = pairs[2 * k], j = pairs[2 * k + 1];
            const double a = mass[j] > 0 ? (f[3 * j + x] + g[3 * j + x]) / mass[j] : 0,
                         b = mass[i] > 0 ? (f[3 * i + x] + g[3 * i + x]) / mass[i] : 0;
            rate += (r[3 * j + x] - r[3 * i + x]) * (a - b);
        }
        CHECK_AT_MOST(fabs(rate), 1e-13);
    }
    hol_chains_destroy(chains);
}

/** A triple that is straight to 3e-7, whose three lengths look like those among coordinates of six decimals by chance,
 * is not straight where the molecule's other lengths have full digits; where they are such, too, it is. */
static void few_lengths_are_rounded_only_if_others_are(void **state)
{
    (void)state;
    const double grid = 1e12;
    unsigned long long random = 12345;
    part chance = {.n = 6, .mass = {1, 2, 3, 4, 5, 6}};
    for (int found = 0; !found;) {
        double a[2];
        for (int k = 0; k < 2; ++k) {
            random = random * 6364136223846793005ULL + 1442695040888963407ULL;
            a[k] = 1.1 + 0.1 * (double)(random >> 33) / 2147483648.0;
        }
        const double lengths[3] = {hypot(a[0], 3.1415927e-7), hypot(a[1], 3.1415927e-7), a[0] + a[1]};
        found = 1;
        for (int k = 0; k < 3; ++k) {
            const double square = lengths[k] * lengths[k] * grid;
            found = found && fabs(square - round(square)) < 0.02;
        }
        memcpy(chance.length, lengths, sizeof lengths);
    }
    const int64_t pairs[6][2] = {{0, 1}, {1, 2}, {0, 2}, {2, 3}, {3, 4}, {4, 5}};
    memcpy(chance.pairs, pairs, sizeof pairs);
    chance.n_bonds = 6;
    for (int others_rounded = 0; others_rounded < 2; ++others_rounded) {
        for (int k = 3; k < 6; ++k) {
            const double length = 1.1234567891 + 0.0912345678 * k;
            chance.length[k] = others_rounded ? sqrt(round(length * length * grid) / grid) : length;
        }
        hol_chains *chains = chains_of(&chance);
        assert_int_equal(hol_chains_degrees_of_freedom(chains, 3), others_rounded ? 18 - 3 - 4 : 18 - 6);
        double largest;
        CHECK(hol_chains_adjustment(chains, &largest, NULL));
        assert_true(others_rounded || largest == 0);
        hol_chains_destroy(chains);
    }
}

/** A rounded length that has lost its zero, 0.12 for 0.120, among finer ones. */
static void zeros_at_the_end_are_lost(void **state)
{
    (void)state;
    part nitrate = {.n = 4, .mass = {14, 16, 16, 16}};
    for (int i = 0; i < 3; ++i) {
        const double turn = 2 * acos(-1.0) / 3 * i;
        nitrate.place[3 + 3 * i] = 0.1204 * cos(turn), nitrate.place[4 + 3 * i] = 0.1204 * sin(turn);
    }
    nitrate = add_all(nitrate);
    for (int k = 0; k < 6; ++k) {
        const double decimals = nitrate.length[k] < 0.15 ? 1e3 : 1e5;
        nitrate.length[k] = round(nitrate.length[k] * decimals) / decimals;
    }
    hol_chains *chains = chains_of(&nitrate);
    assert_int_equal(hol_chains_degrees_of_freedom(chains, 3), 6);
    double largest;
    CHECK(hol_chains_adjustment(chains, &largest, NULL));
    CHECK_AT_MOST(largest * 0.12, 5.1e-4);
    assert_true(largest > 1e-4);
    hol_chains_destroy(chains);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(dependent_distances_are_bodies),
        cmocka_unit_test(multipliers_of_ten_distances_have_the_least_norm),
        cmocka_unit_test(bent_and_puckered_ones_stay_as_they_are),
        cmocka_unit_test(lengths_that_disagree_are_named_and_nothing_is_added),
        cmocka_unit_test(lengths_with_the_decimals_of_a_file_are_flat_straight_and_rigid),
        cmocka_unit_test(what_decimals_do_not_leave_open_stays),
        cmocka_unit_test(few_lengths_are_rounded_only_if_others_are),
        cmocka_unit_test(zeros_at_the_end_are_lost),
        cmocka_unit_test(all_bonds_and_angles_of_ethane),
        cmocka_unit_test(flat_groups_that_share_atoms_turn_about_them),
        cmocka_unit_test(bodies_and_others_come_in_one_list),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
