/** Bonds whose images are told: as the same molecules whose coordinates are whole. */
#include "check.h"
#include "random.h"

enum { N = 14, B = 14, STEPS = 3 };

/* A chain with a side atom and a fixed end, a ring of four, and a pair whose bond is longer than half the box. */
static const int64_t pairs[2 * B] = {1, 0, 1, 2, 2,  3,  4,  3,  2,  5,  6,  7,  7,  8,
                                     9, 8, 6, 9, 10, 11, 12, 11, 12, 13, 13, 10, 10, 12};
static const double masses[N] = {12, 13, 1, 14, INFINITY, 2, 3, 4, 5, 6, 7, 8, 9, 10};
static const double cell[9] = {4.2, 0, 0, 1.1, 4.4, 0, -0.7, 0.9, 4.6};

typedef struct scene {
    double r[3 * N], wrapped[3 * N], v[3 * N], f[3 * N], length[B], lambda[B];
    int64_t images[3 * B], moved[3 * N]; /* of atoms: wrapped = r - moved */
} scene;

static scene make(uint64_t seed)
{
    scene s;
    random_stream dice = random_seed(seed);
    for (int e = 0; e < 3 * N; ++e) {
        s.r[e] = 1.5 * random_normal(&dice), s.v[e] = random_normal(&dice), s.f[e] = random_normal(&dice);
        s.moved[e] = (int64_t)floor(5 * random_uniform(&dice)) - 2;
    }
    for (int k = 0; k < 3; ++k) s.v[12 + k] = 0;
    for (int a = 0; a < N; ++a)
        for (int c = 0; c < 3; ++c) {
            s.wrapped[3 * a + c] = s.r[3 * a + c];
            for (int i = 0; i < 3; ++i) s.wrapped[3 * a + c] -= (double)s.moved[3 * a + i] * cell[3 * i + c];
        }
    for (int k = 0; k < B; ++k) {
        double square = 0;
        for (int c = 0; c < 3; ++c) {
            square += pow(s.r[3 * pairs[2 * k] + c] - s.r[3 * pairs[2 * k + 1] + c], 2);
            s.images[3 * k + c] = s.moved[3 * pairs[2 * k + 1] + c] - s.moved[3 * pairs[2 * k] + c];
        }
        s.length[k] = sqrt(square);
        s.lambda[k] = random_normal(&dice);
    }
    return s;
}

typedef struct answers {
    double lambda[B], tension[B], g[3 * N], virial[9], solved[B], reaction[3 * N], rate[3 * N], v[3 * N], r[3 * N];
    double left[B], position_lambda[B], position_virial[9];
} answers;

static answers ask(const hol_chains *chains, const double *r, const scene *s, const double *step)
{
    answers a;
    CHECK(hol_chains_check(chains, r, HOL_BOX));
    CHECK(hol_forces(chains, r, s->v, s->f, a.lambda, a.tension, a.g, HOL_WRITE, a.virial));
    CHECK(hol_solve(chains, r, s->lambda, a.solved, a.reaction, HOL_WRITE, NULL));
    memcpy(a.v, s->v, sizeof a.v);
    CHECK(hol_project_velocities(chains, r, a.v, NULL, NULL));
    for (int e = 0; e < 3 * N; ++e) a.r[e] = r[e] + step[e];
    CHECK(hol_project_positions(chains, r, a.r, NULL, 1, a.position_lambda, 0, a.position_virial, NULL));
    CHECK(hol_residuals(chains, a.r, NULL, a.left, NULL));
    for (int k = 0; k < B; ++k) CHECK_AT_MOST(fabs(a.left[k]), 1e-13);
    for (int e = 0; e < 3 * N; ++e) a.r[e] -= r[e];
    return a;
}

static void alike(const double *a, const double *b, int n, double bound)
{
    double size = 0;
    for (int i = 0; i < n; ++i) size = fmax(size, fabs(a[i]));
    for (int i = 0; i < n; ++i) CHECK_AT_MOST(fabs(a[i] - b[i]), bound * size);
}

static void all_alike(const answers *a, const answers *b)
{
    alike(a->lambda, b->lambda, B, 1e-11);
    alike(a->tension, b->tension, B, 1e-11);
    alike(a->g, b->g, 3 * N, 1e-11);
    alike(a->virial, b->virial, 9, 1e-11);
    alike(a->solved, b->solved, B, 1e-11);
    alike(a->reaction, b->reaction, 3 * N, 1e-11);
    alike(a->v, b->v, 3 * N, 1e-12);
    alike(a->r, b->r, 3 * N, 1e-11);
    alike(a->position_lambda, b->position_lambda, B, 1e-10);
    alike(a->position_virial, b->position_virial, 9, 1e-10);
}

static void molecules_are_those_of_whole_coordinates(void **state)
{
    (void)state;
    for (uint64_t seed = 1; seed < 6; ++seed) {
        const scene s = make(seed);
        hol_chains *whole, *told, *copy;
        int64_t images[3 * B], ends[2 * B];
        double step[3 * N];
        CHECK(hol_chains_create(N, masses, &whole));
        CHECK(hol_chains_add_bonds(whole, B, pairs, s.length));
        CHECK(hol_chains_create(N, masses, &told));
        CHECK(hol_chains_set_box(told, cell)); /* narrower than twice the longest bond */
        CHECK(hol_chains_add_bonds_with_images(told, B, pairs, s.length, s.images));
        assert_int_equal(hol_chains_degrees_of_freedom(told, 3), hol_chains_degrees_of_freedom(whole, 3));
        assert_int_equal(hol_chains_n_molecules(told), hol_chains_n_molecules(whole));
        CHECK(hol_chains_images(told, images));
        CHECK(hol_chains_pairs(told, ends));
        assert_memory_equal(images, s.images, sizeof images);
        assert_memory_equal(ends, pairs, sizeof ends);
        for (int e = 0; e < 3 * N; ++e) step[e] = e / 3 == 4 ? 0 : 0.01 * s.v[e];
        const answers one = ask(whole, s.r, &s, step), other = ask(told, s.wrapped, &s, step);
        all_alike(&one, &other);

        CHECK(hol_chains_copy(told, &copy));
        const answers again = ask(copy, s.wrapped, &s, step);
        assert_memory_equal(again.g, other.g, sizeof again.g);

        /* atoms put into other cells */
        double r[3 * N];
        int64_t none[3 * B] = {0};
        CHECK(hol_chains_set_images(told, none));
        const answers unwrapped = ask(told, s.r, &s, step);
        all_alike(&one, &unwrapped);
        CHECK_FAILS(HOL_ERR_LENGTHS, hol_chains_check(told, s.wrapped, HOL_BOX));

        /* other lengths, from crude positions: images stay */
        CHECK(hol_chains_set_images(told, s.images));
        double length[B];
        for (int k = 0; k < B; ++k) length[k] = 1.001 * s.length[k];
        CHECK(hol_chains_set_lengths(told, length));
        CHECK(hol_chains_set_masses(told, masses));
        memcpy(r, s.wrapped, sizeof r);
        CHECK(hol_impose(told, r, NULL));
        CHECK(hol_chains_check(told, r, HOL_BOX));
        hol_worst worst;
        CHECK(hol_violation(told, r, NULL, &worst));
        CHECK_AT_MOST(worst.length, 1e-12);
        hol_chains_destroy(whole);
        hol_chains_destroy(told);
        hol_chains_destroy(copy);
    }
}

/** A ring round the box, whose images the box would find by itself; and a deformed box of the reference. */
static void a_ring_round_the_box(void **state)
{
    (void)state;
    const double mass[4] = {1, 2, 3, 4}, box[9] = {4, 0, 0, 0, 9, 0, 0, 0, 9},
                 other[9] = {4.02, 0, 0, 0.03, 9, 0, 0, 0, 9};
    const double r[12] = {0, 0, 0, 1, 0.3, 0, 2, -0.2, 0.1, 3, 0, 0.4},
                 f[12] = {1, 2, 3, -1, 4, 0, 0.5, 0, 0, 2, -2, 7};
    const int64_t list[8] = {0, 1, 1, 2, 2, 3, 3, 0}, images[12] = {[9] = 1};
    double length[4], moved[12], lambda[2][4], g[2][12], virial[2][9], x[2][12];
    for (int k = 0; k < 4; ++k) {
        double square = 0;
        for (int c = 0; c < 3; ++c)
            square += pow(r[3 * list[2 * k + 1] + c] - r[3 * list[2 * k] + c] + (k == 3 && c == 0 ? 4 : 0), 2);
        length[k] = sqrt(square);
    }
    for (int way = 0; way < 2; ++way) {
        hol_chains *chains;
        CHECK(hol_chains_create(4, mass, &chains));
        CHECK(hol_chains_set_box(chains, box));
        if (way == 0)
            CHECK(hol_chains_add_bonds(chains, 4, list, length));
        else
            CHECK(hol_chains_add_bonds_with_images(chains, 4, list, length, images));
        CHECK(hol_forces(chains, r, NULL, f, lambda[way], NULL, g[way], HOL_WRITE, virial[way]));
        CHECK(hol_chains_set_reference_box(chains, box));
        CHECK(hol_chains_set_box(chains, other));
        for (int e = 0; e < 12; ++e) moved[e] = r[e] + 0.01 * f[e];
        memcpy(x[way], moved, sizeof moved);
        CHECK(hol_project_positions(chains, r, x[way], NULL, 1, NULL, 0, NULL, NULL));
        hol_chains_destroy(chains);
    }
    alike(lambda[0], lambda[1], 4, 1e-13);
    alike(g[0], g[1], 12, 1e-13);
    alike(virial[0], virial[1], 9, 1e-13);
    alike(x[0], x[1], 12, 1e-13);
}

static void what_makes_no_sense_is_refused(void **state)
{
    (void)state;
    const double mass[4] = {1, 1, INFINITY, INFINITY}, one[2] = {1, 1};
    const int64_t bond[2] = {0, 1}, twice[4] = {0, 1, 1, 0}, itself[2] = {1, 1};
    const int64_t far[3] = {0, INT64_C(1) << 40, 0}, near[6] = {0, 1, 0, 0, 0, 0};
    int64_t images[6];
    hol_chains *chains;
    CHECK(hol_chains_create(4, mass, &chains));
    CHECK_FAILS(HOL_ERR_VALUE, hol_chains_add_bonds_with_images(chains, 1, bond, one, far));
    assert_message_names("bond 0");
    CHECK_FAILS(HOL_ERR_DEGENERATE, hol_chains_add_bonds_with_images(chains, 2, twice, one, near));
    CHECK_FAILS(HOL_ERR_VALUE, hol_chains_add_bonds_with_images(chains, 1, itself, one, near));
    CHECK_FAILS(HOL_ERR_VALUE, hol_chains_add_bonds_with_images(chains, -1, bond, one, near));
    CHECK_FAILS(HOL_ERR_VALUE, hol_chains_add_bonds_with_images(chains, 1, bond, (double[1]){0}, near));
    CHECK_FAILS(HOL_ERR_NULL, hol_chains_add_bonds_with_images(chains, 1, bond, one, NULL));
    CHECK(hol_chains_add_bonds_with_images(chains, 0, NULL, NULL, NULL));
    assert_int_equal(hol_chains_n_bonds(chains), 0);
    CHECK(hol_chains_add(chains, 1, (int64_t[2]){2, 0}, one));
    CHECK_FAILS(HOL_ERR_SHARED_ATOM, hol_chains_add_bonds_with_images(chains, 1, bond, one, near));
    assert_message_names("atom 0");
    CHECK(hol_chains_add_bonds_with_images(chains, 1, (int64_t[2]){1, 3}, one, near));
    CHECK_FAILS(HOL_ERR_VALUE, hol_chains_set_images(chains, near)); /* bond 0 is of hol_chains_add */
    assert_message_names("bond 0");
    CHECK(hol_chains_images(chains, images));
    assert_true(images[1] == 0 && images[4] == 1);
    hol_chains_destroy(chains);
}

/** A bond between two fixed atoms is taken as hol_chains_add_bonds takes it: in no equation. */
static void a_bond_between_fixed_atoms_is_in_no_equation(void **state)
{
    (void)state;
    const double mass[5] = {1, 2, INFINITY, INFINITY, 3}, r[15] = {0, 0, 0, 1, 0, 0, 0, 5, 0, 7, 0, 0, 1, 1, 0};
    const double box[9] = {8, 0, 0, 0, 9, 0, 0, 0, 9}, lengths[3] = {3, 1, 1};
    const int64_t list[6] = {2, 3, 0, 1, 3, 0}, images[9] = {1, 2, 3, [6] = 1}, none[9] = {[6] = 1};
    double f[15], lambda[2][3], g[2][15];
    for (int e = 0; e < 15; ++e) f[e] = cos(1.0 + e);
    for (int told = 0; told < 2; ++told) {
        hol_chains *chains;
        int64_t ends[6], kept[9];
        CHECK(hol_chains_create(5, mass, &chains));
        CHECK(hol_chains_set_box(chains, box));
        if (told)
            CHECK(hol_chains_add_bonds_with_images(chains, 3, list, lengths, images));
        else
            CHECK(hol_chains_add_bonds(chains, 3, list, lengths));
        assert_int_equal(hol_chains_n_bonds(chains), 3);
        assert_int_equal(hol_chains_n_molecules(chains), 1);
        assert_int_equal(hol_chains_degrees_of_freedom(chains, 3), 9 - 2);
        CHECK(hol_chains_pairs(chains, ends));
        assert_true((ends[0] == 2 && ends[1] == 3) || (ends[0] == 3 && ends[1] == 2));
        CHECK(hol_forces(chains, r, NULL, f, lambda[told], NULL, g[told], HOL_WRITE, NULL));
        assert_true(lambda[told][0] == 0);
        if (told) {
            CHECK(hol_chains_set_images(chains, images));
            CHECK(hol_chains_images(chains, kept));
            assert_memory_equal(kept, none, sizeof none);
        }
        hol_chains_destroy(chains);
    }
    alike(lambda[0], lambda[1], 3, 1e-14);
    alike(g[0], g[1], 6, 1e-14);
    /* alone, too, and with nothing left in the set by a call that is refused */
    hol_chains *chains;
    CHECK(hol_chains_create(5, mass, &chains));
    CHECK(hol_chains_add_bonds_with_images(chains, 1, list, lengths, images));
    CHECK_FAILS(HOL_ERR_DEGENERATE,
                hol_chains_add_bonds_with_images(chains, 2, (int64_t[4]){0, 1, 1, 0}, lengths, none));
    CHECK_FAILS(HOL_ERR_VALUE,
                hol_chains_add_bonds_with_images(chains, 3, (int64_t[6]){2, 3, 0, 1, 1, 1}, lengths, none));
    assert_int_equal(hol_chains_n_bonds(chains), 1);
    assert_int_equal(hol_chains_n_molecules(chains), 0);
    hol_chains_destroy(chains);
}

/** The metric is that of whole coordinates; the force is its gradient, with a fixed atom that others share. */
static void the_metric_is_that_of_whole_coordinates(void **state)
{
    (void)state;
    for (uint64_t seed = 1; seed < 6; ++seed) {
        const scene s = make(seed);
        hol_chains *whole, *told;
        double det[2][3], det_z[2][3], energy[2], force[3][3 * N];
        CHECK(hol_chains_create(N, masses, &whole));
        CHECK(hol_chains_add_bonds(whole, B, pairs, s.length));
        CHECK(hol_chains_create(N, masses, &told));
        CHECK(hol_chains_set_box(told, cell));
        CHECK(hol_chains_add_bonds_with_images(told, B, pairs, s.length, s.images));
        CHECK(hol_metric(whole, s.r, 1.3, det[0], det_z[0], &energy[0], force[0], HOL_WRITE));
        CHECK(hol_metric(told, s.wrapped, 1.3, det[1], det_z[1], &energy[1], force[1], HOL_WRITE));
        alike(det[0], det[1], (int)hol_chains_n_molecules(whole), 1e-13);
        alike(det_z[0], det_z[1], (int)hol_chains_n_molecules(whole), 1e-13);
        alike(&energy[0], &energy[1], 1, 1e-13);
        alike(force[0], force[1], 3 * N, 1e-12);
        memcpy(force[2], s.f, sizeof force[2]);
        CHECK(hol_metric(told, s.wrapped, 1.3, NULL, NULL, NULL, force[2], HOL_ADD));
        for (int e = 0; e < 3 * N; ++e)
            CHECK_AT_MOST(fabs(force[2][e] - s.f[e] - force[1][e]), 1e-12 * (1 + fabs(force[2][e])));
        for (int e = 0; e < 3 * N; ++e) {
            const double h = 1e-5;
            double moved[3 * N], up, down;
            memcpy(moved, s.wrapped, sizeof moved);
            moved[e] += h;
            CHECK(hol_metric(told, moved, 1.3, NULL, NULL, &up, NULL, HOL_WRITE));
            moved[e] -= 2 * h;
            CHECK(hol_metric(told, moved, 1.3, NULL, NULL, &down, NULL, HOL_WRITE));
            CHECK_AT_MOST(fabs((down - up) / (2 * h) - force[1][e]), 1e-5 * (1 + fabs(force[1][e])));
        }
        hol_chains_destroy(whole);
        hol_chains_destroy(told);
    }
    /* a fixed atom at a chain of either kind gets what both give it, whatever it had; bodies are refused */
    const double mass[5] = {1, 2, INFINITY, 3, 4}, ones[2] = {1, 1},
                 r[15] = {-1.5, 0.7, 0, -1, 0, 0, 0, 0, 0, 1, 0, 0, 1.2, 0.9, 0.3};
    double force[4][15];
    for (int which = 1; which < 4; ++which) {
        hol_chains *chains;
        for (int e = 0; e < 15; ++e) force[which][e] = e / 3 == 2 ? 77 : 0;
        CHECK(hol_chains_create(5, mass, &chains));
        if (which & 1) CHECK(hol_chains_add_bonds(chains, 2, (int64_t[4]){0, 1, 1, 2}, ones));
        if (which & 2)
            CHECK(hol_chains_add_bonds_with_images(chains, 2, (int64_t[4]){2, 3, 3, 4}, ones, (int64_t[6]){0}));
        CHECK(hol_metric(chains, r, 1, NULL, NULL, NULL, force[which], HOL_WRITE));
        if (which == 3) {
            const double places[6] = {0, 0, 0, 1, 0, 0};
            hol_chains *body;
            CHECK(hol_chains_create(5, mass, &body));
            CHECK(hol_chains_add_rigid(body, 1, (int64_t[1]){2}, (int64_t[2]){0, 1}, places, 0, NULL, NULL));
            CHECK_FAILS(HOL_ERR_UNSUPPORTED, hol_metric(body, r, 1, NULL, NULL, NULL, force[0], HOL_WRITE));
            hol_chains_destroy(body);
        }
        hol_chains_destroy(chains);
    }
    for (int e = 0; e < 15; ++e)
        if (e / 3 == 2)
            CHECK_AT_MOST(fabs(force[3][e] - force[1][e] - force[2][e]), 1e-14);
        else
            CHECK_AT_MOST(fabs(force[3][e] - force[e < 6 ? 1 : 2][e]), 1e-14);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(molecules_are_those_of_whole_coordinates),
        cmocka_unit_test(a_ring_round_the_box),
        cmocka_unit_test(what_makes_no_sense_is_refused),
        cmocka_unit_test(a_bond_between_fixed_atoms_is_in_no_equation),
        cmocka_unit_test(the_metric_is_that_of_whole_coordinates),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
