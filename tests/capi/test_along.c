/* The position level along given bond vectors: as with the positions that they come from. */
#include "check.h"
#include "input.h"
#include "random.h"
#include "water.h"

enum { MOST = 400 };

static void take_vectors(int64_t n_bonds, const int64_t *pairs, const double *r, double *b)
{
    for (int64_t k = 0; k < n_bonds; ++k)
        for (int c = 0; c < 3; ++c) b[3 * k + c] = r[3 * pairs[2 * k + 1] + c] - r[3 * pairs[2 * k] + c];
}

static double largest_difference(const double *a, const double *b, size_t n)
{
    double most = 0;
    for (size_t i = 0; i < n; ++i) most = fmax(most, fabs(a[i] - b[i]));
    return most;
}

/* Two of everything: a chain, a tree, a ring, water, all of whose bonds are given in some order and either direction.
 */
typedef struct scene {
    int64_t n_atoms, n_bonds, pairs[2 * MOST];
    double r[3 * MOST], mass[MOST], length[MOST], b[3 * MOST];
    hol_chains *chains;
} scene;

static void add_copies(scene *s, int64_t n_atoms, int64_t n_bonds, const int64_t *pairs, int64_t copies)
{
    for (int64_t copy = 0; copy < copies; ++copy, s->n_atoms += n_atoms)
        for (int64_t k = 0; k < n_bonds; ++k, ++s->n_bonds)
            for (int e = 0; e < 2; ++e) s->pairs[2 * s->n_bonds + e] = s->n_atoms + pairs[2 * k + e];
}

static void shuffle(scene *s, random_stream *stream)
{
    for (int64_t k = s->n_bonds - 1; k > 0; --k) {
        const int64_t other = random_integer(stream, 0, k), turn = random_integer(stream, 0, 1);
        int64_t pair[2];
        memcpy(pair, s->pairs + 2 * k, sizeof pair);
        memcpy(s->pairs + 2 * k, s->pairs + 2 * other, sizeof pair);
        s->pairs[2 * other] = pair[turn];
        s->pairs[2 * other + 1] = pair[1 - turn];
    }
}

static void make_scene(scene *s, int shared_anchor, uint64_t seed)
{
    static const int64_t chain[14] = {0, 1, 1, 2, 2, 3, 3, 4, 4, 5, 5, 6, 6, 7},
                         ring[10] = {0, 1, 1, 2, 2, 3, 3, 4, 4, 0};
    static const int64_t tree[12] = {5, 0, 0, 2, 2, 1, 2, 4, 4, 3, 4, 6},
                         kite[12] = {0, 1, 1, 2, 2, 3, 0, 3, 0, 2, 3, 4};
    random_stream stream = random_seed(seed);
    memset(s, 0, sizeof *s);
    add_copies(s, 8, 7, chain, 9);
    add_copies(s, 7, 6, tree, 9);
    add_copies(s, 5, 5, ring, 9);
    add_copies(s, 5, 6, kite, 5);
    add_copies(s, 3, 3, water_pairs, 11);
    if (shared_anchor) { /* atom 0, held fixed, holds molecules of every shape */
        for (int64_t k = 0; k < 5; ++k, ++s->n_bonds) {
            s->pairs[2 * s->n_bonds] = 0;
            s->pairs[2 * s->n_bonds + 1] = 8 + 20 * k;
        }
    }
    shuffle(s, &stream);
    for (int64_t i = 0; i < s->n_atoms; ++i) {
        s->mass[i] = 1 + random_uniform(&stream);
        for (int c = 0; c < 3; ++c) s->r[3 * i + c] = 4 * random_uniform(&stream);
    }
    if (shared_anchor) s->mass[0] = 0;
    take_vectors(s->n_bonds, s->pairs, s->r, s->b);
    for (int64_t k = 0; k < s->n_bonds; ++k) {
        const double *const b = s->b + 3 * k;
        s->length[k] = sqrt(b[0] * b[0] + b[1] * b[1] + b[2] * b[2]);
    }
    CHECK(hol_chains_create(s->n_atoms, s->mass, &s->chains));
    CHECK(hol_chains_add_bonds(s->chains, s->n_bonds, s->pairs, s->length));
}

static void results_are_those_of_positions(void **state)
{
    (void)state;
    for (uint64_t seed = 1; seed <= 6; ++seed) {
        scene s;
        make_scene(&s, seed % 2 == 0, seed);
        random_stream stream = random_seed(100 + seed);
        const size_t n = 3 * (size_t)s.n_atoms, n_bonds = (size_t)s.n_bonds;
        double r[2][3 * MOST], v[2][3 * MOST], lambda[2][MOST], virial[2][9];
        hol_report report[2];
        for (size_t i = 0; i < n; ++i) {
            r[0][i] = r[1][i] = s.r[i] + (s.mass[i / 3] == 0 ? 0 : 0.01 * (2 * random_uniform(&stream) - 1));
            v[0][i] = v[1][i] = 1;
        }
        CHECK(hol_project_positions(s.chains, s.r, r[0], v[0], 0.1, lambda[0], 0, virial[0], &report[0]));
        CHECK(hol_project_positions_along(s.chains, s.b, r[1], v[1], 0.1, lambda[1], 0, virial[1], &report[1]));
        double largest = 0;
        for (size_t k = 0; k < n_bonds; ++k) largest = fmax(largest, fabs(lambda[0][k]));
        CHECK_AT_MOST(largest_difference(r[0], r[1], n), 64 * 4 * DBL_EPSILON);
        CHECK_AT_MOST(largest_difference(v[0], v[1], n), 10 * 64 * 4 * DBL_EPSILON);
        CHECK_AT_MOST(largest_difference(lambda[0], lambda[1], n_bonds), 1e-10 * largest);
        CHECK_AT_MOST(largest_difference(virial[0], virial[1], 9), 1e-10 * largest * 50 * (double)n_bonds);
        assert_true(report[1].n_corrected == report[0].n_corrected && report[1].n_failed == 0);
        CHECK_AT_MOST(report[1].max_error, 1e-13);

        /* Separate arrays give the same bits. */
        double x[MOST], y[MOST], z[MOST], again[3 * MOST];
        for (size_t k = 0; k < n_bonds; ++k) {
            x[k] = s.b[3 * k];
            y[k] = s.b[3 * k + 1];
            z[k] = s.b[3 * k + 2];
        }
        for (size_t i = 0; i < n; ++i) again[i] = 0;
        const hol_view b = {x, y, z, sizeof *x, HOL_DOUBLE, 0};
        const hol_view to = {again, again + 1, again + 2, 3 * sizeof *again, HOL_DOUBLE, 0};
        stream = random_seed(100 + seed);
        for (size_t i = 0; i < n; ++i)
            again[i] = s.r[i] + (s.mass[i / 3] == 0 ? 0 : 0.01 * (2 * random_uniform(&stream) - 1));
        CHECK(hol_project_positions_along_view(s.chains, INPUT(&b), &to, NULL, 0.1, NULL, 0, NULL, NULL));
        assert_same_bits(again, r[1], n);
        hol_chains_destroy(s.chains);
    }
}

/* A box for the positions; none is needed for the vectors. */
static void cut_molecules_need_a_box_for_positions_alone(void **state)
{
    (void)state;
    waters w = make_waters(5, 3);
    const size_t n = 3 * (size_t)w.n_atoms;
    double *const b = malloc(sizeof *b * n), *const whole = copy_of(w.r, n);
    for (int64_t k = 0; k < 3 * w.n_molecules; ++k)
        for (int c = 0; c < 3; ++c)
            b[3 * k + c] = w.r[9 * (k / 3) + 3 * water_pairs[2 * (k % 3) + 1] + c] -
                           w.r[9 * (k / 3) + 3 * water_pairs[2 * (k % 3)] + c];
    cut_by_the_faces(&w);
    hol_chains *chains;
    CHECK(hol_chains_create(w.n_atoms, w.mass, &chains));
    CHECK(hol_chains_add_molecules(chains, w.n_molecules, 3, 0, 3, water_pairs, water_lengths));
    CHECK(hol_chains_set_box(chains, w.box));
    for (size_t i = 0; i < n; i += 5) w.r[i] += 0.02;
    double *const along = copy_of(w.r, n), *const plain = copy_of(w.r, n);
    CHECK(hol_project_positions_along(chains, b, along, NULL, 1, NULL, 0, NULL, NULL));
    CHECK(hol_project_positions(chains, whole, plain, NULL, 1, NULL, 0, NULL, NULL));
    CHECK_AT_MOST(largest_difference(along, plain, n), 64 * w.side * DBL_EPSILON);
    free(b);
    free(whole);
    free(along);
    free(plain);
    hol_chains_destroy(chains);
    free_waters(&w);
}

static void wrong_vectors_are_refused(void **state)
{
    (void)state;
    scene s;
    make_scene(&s, 1, 5);
    const size_t n = 3 * (size_t)s.n_atoms;
    double r[3 * MOST];
    memcpy(r, s.r, sizeof *r * n);
    r[3 * 9] += 0.01;
    double *const before = copy_of(r, n), *const b = s.b;
    const double kept = b[0];
    CHECK_FAILS(HOL_ERR_NULL, hol_project_positions_along(s.chains, NULL, r, NULL, 1, NULL, 0, NULL, NULL));
    b[0] = NAN;
    CHECK_FAILS(HOL_ERR_NOT_FINITE, hol_project_positions_along(s.chains, b, r, NULL, 1, NULL, 0, NULL, NULL));
    assert_message_names("bond 0");
    b[0] = kept;
    /* Of a triangle two vectors are exchanged: no cycle closes. */
    for (int64_t k = 0; k < s.n_bonds; ++k)
        if (s.pairs[2 * k] == s.n_atoms - 3 || s.pairs[2 * k + 1] == s.n_atoms - 3) b[3 * k] *= -1;
    CHECK(hol_chains_set_checks(s.chains, HOL_NEVER));
    CHECK_FAILS(HOL_ERR_DEGENERATE, hol_project_positions_along(s.chains, b, r, NULL, 1, NULL, 0, NULL, NULL));
    assert_message_names("does not close its cycle");
    CHECK(hol_chains_set_checks(s.chains, HOL_AT_START));
    for (int64_t k = 0; k < 3 * s.n_bonds; ++k) b[k] *= 10;
    CHECK_FAILS(HOL_ERR_LENGTHS, hol_project_positions_along(s.chains, b, r, NULL, 1, NULL, 0, NULL, NULL));
    assert_message_names("among the reference vectors");
    assert_same_bits(r, before, n);
    free(before);
    hol_chains_destroy(s.chains);
}

/* A long chain: the vectors come back, each to one rounding of where its atom stands. */
static void long_chains_keep_their_digits(void **state)
{
    (void)state;
    enum { BONDS = 3000 };
    const size_t n = 3 * (BONDS + 1);
    double *const mass = malloc(sizeof *mass * (BONDS + 1)), *const length = malloc(sizeof *length * BONDS);
    double *const r0 = malloc(sizeof *r0 * n), *const b = malloc(sizeof *b * n), error = 0;
    random_stream stream = random_seed(9);
    for (int c = 0; c < 3; ++c) r0[c] = 0;
    for (int64_t k = 0; k < BONDS; ++k) {
        random_direction(&stream, b + 3 * k);
        length[k] = 1;
        for (int c = 0; c < 3; ++c) r0[3 * k + 3 + c] = r0[3 * k + c] + b[3 * k + c];
    }
    for (int64_t i = 0; i <= BONDS; ++i) mass[i] = 1;
    hol_chains *chains;
    CHECK(hol_chains_create(BONDS + 1, mass, &chains));
    CHECK(hol_chains_add_block(chains, 1, BONDS, 0, length));
    double *const r = copy_of(r0, n);
    for (size_t i = 0; i < n; ++i) r[i] += 0.01 * (2 * random_uniform(&stream) - 1);
    double *const plain = copy_of(r, n);
    hol_report report;
    CHECK(hol_project_positions_along(chains, b, r, NULL, 1, NULL, 0, NULL, &report));
    CHECK(hol_project_positions(chains, r0, plain, NULL, 1, NULL, 0, NULL, NULL));
    CHECK(hol_reference_error(chains, &error, NULL, NULL));
    CHECK_AT_MOST(error, 1e-15); /* of the vectors as they were given, not as coordinates */
    CHECK_AT_MOST(largest_difference(r, plain, n), 64 * 60 * DBL_EPSILON);
    free(mass);
    free(length);
    free(r0);
    free(b);
    free(r);
    free(plain);
    hol_chains_destroy(chains);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(results_are_those_of_positions),
        cmocka_unit_test(cut_molecules_need_a_box_for_positions_alone),
        cmocka_unit_test(wrong_vectors_are_refused),
        cmocka_unit_test(long_chains_keep_their_digits),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
