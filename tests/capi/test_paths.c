/**
 * Positions of large molecules of long linear parts, which are cut into paths and the knots between them: paths of all
 * lengths about those at which they are cut, with fixed and with free ends, in boxes, layouts, precisions and threads.
 */
#include "check.h"
#include "input.h"
#include "large.h"
#include "molecule_solution.h"

static const double dt = 0.002;

typedef struct step {
    molecule m;
    hol_chains *chains;
    double *start, *r, *v, *lambda, virial[9];
    hol_report report;
} step;

static size_t size_of(const molecule *m)
{
    return 3 * (size_t)m->n_atoms;
}

/** Velocities that obey the constraints, a drift, and the projection. */
static step take_step(molecule m)
{
    step s = {.m = m, .chains = large_chains(&m)};
    CHECK(hol_project_velocities(s.chains, m.r, m.v, NULL, NULL));
    s.start = molecule_drifted(&m, dt);
    s.r = copy_of(s.start, size_of(&m));
    s.v = copy_of(m.v, size_of(&m));
    s.lambda = untouched((size_t)m.n_bonds);
    CHECK(hol_project_positions(s.chains, m.r, s.r, s.v, dt, s.lambda, 0, s.virial, &s.report));
    assert_int_equal(s.report.n_corrected, 1);
    return s;
}

static void forget(step *s)
{
    free(s->start), free(s->r), free(s->v), free(s->lambda);
    hol_chains_destroy(s->chains);
    molecule_free(&s->m);
}

/** How far the multipliers move the atoms, in long double. */
static long double *moves_of(const step *s)
{
    long double *move = calloc(size_of(&s->m), sizeof *move);
    for (int64_t k = 0; k < s->m.n_bonds; ++k)
        for (int c = 0; c < 3; ++c) {
            const int64_t i = s->m.pairs[2 * k], j = s->m.pairs[2 * k + 1];
            const long double pull =
                2 * (long double)dt * dt * s->lambda[k] * ((long double)s->m.r[3 * j + c] - s->m.r[3 * i + c]);
            move[3 * i + c] += s->m.inverse_mass[i] * pull;
            move[3 * j + c] -= s->m.inverse_mass[j] * pull;
        }
    return move;
}

/** |d.d - a^2| / a^2 of bonds whose atoms are at x + y. */
static long double error_of(const molecule *m, const double *x, const long double *y, int64_t k)
{
    const long double square = (long double)m->length[k] * m->length[k];
    long double sum = -square;
    for (int c = 0; c < 3; ++c) {
        const int64_t i = 3 * m->pairs[2 * k] + c, j = 3 * m->pairs[2 * k + 1] + c;
        const long double d = (long double)x[j] - x[i] + (y ? y[j] - y[i] : 0);
        sum += d * d;
    }
    return fabsl(sum) / square;
}

/**
 * The multipliers give all bonds their lengths to a few roundings, which no others do, and atoms and velocities move by
 * them; so does the virial.
 */
static void check_step(const step *s)
{
    const molecule *m = &s->m;
    long double *move = moves_of(s), extent = 1, worst = 0, virial[9] = {0}, sizes[9] = {0};
    for (size_t i = 0; i < size_of(m); ++i) extent = fmaxl(extent, fabs(s->r[i]));
    const long double few = 16 * (DBL_EPSILON + long_double_rounding() * extent);
    for (int64_t k = 0; k < m->n_bonds; ++k) {
        CHECK_AT_MOST(error_of(m, s->start, move, k), few);
        CHECK_AT_MOST(error_of(m, s->r, NULL, k), 8 * DBL_EPSILON * (1 + extent));
        worst = fmaxl(worst, error_of(m, s->start, move, k));
        for (int e = 0; e < 9; ++e) {
            const int64_t i = 3 * m->pairs[2 * k], j = 3 * m->pairs[2 * k + 1];
            const long double p = 2 * (long double)s->lambda[k] * (m->r[j + e / 3] - m->r[i + e / 3]) *
                                  (m->r[j + e % 3] - m->r[i + e % 3]);
            virial[e] -= p, sizes[e] += fabsl(p);
        }
    }
    CHECK_AT_MOST(fabsl(s->report.max_error - worst), few);
    for (int e = 0; e < 9; ++e) CHECK_AT_MOST(fabsl(s->virial[e] - virial[e]), 100 * DBL_EPSILON * sizes[e]);
    for (size_t i = 0; i < size_of(m); ++i) {
        if (m->inverse_mass[i / 3] == 0) {
            assert_same_bits(s->r + i, s->start + i, 1);
            continue;
        }
        CHECK_AT_MOST(fabsl(s->start[i] + move[i] - s->r[i]), 2 * DBL_EPSILON * extent);
        CHECK_AT_MOST(fabsl(m->v[i] + move[i] / dt - s->v[i]), 8 * DBL_EPSILON * (1 + fabs(m->v[i])));
    }
    free(move);
}

/** Lengths about those at which a path is one, and at which it is cut in two and in three. */
static molecule coils(int fixed)
{
    static const int64_t lengths[] = {512,  513,  514,  515, 516, 517,  518, 519,  1026, 1027,
                                      1028, 1029, 1030, 127, 128, 129,  130, 131,  1300, 700,
                                      1540, 1541, 2000, 900, 3,   1600, 1,   1700, 800,  1800};
    return large_coils(lengths, quick_run() ? 13 : (int64_t)(sizeof lengths / sizeof *lengths), fixed);
}

static void paths_of_all_lengths_get_their_lengths(void **state)
{
    (void)state;
    for (int fixed = 0; fixed < 2; ++fixed) {
        step s = take_step(coils(fixed));
        check_step(&s);
        forget(&s);
    }
}

/** Triangles at the ends of paths, in them, and where they meet. */
static void cycles_beside_paths_get_their_lengths(void **state)
{
    (void)state;
    for (int64_t loops = 1; loops < 4; ++loops) {
        const int64_t lengths[] = {900, 1000, 1100, 950};
        molecule m = large_coils(lengths, 4, 0);
        const int64_t ends[] = {0, 900, 901, 2900};
        for (int64_t l = 0; l < loops; ++l) {
            molecule_add_bond(&m, ends[l], ends[l] + 2);
            double square = 0;
            for (int c = 0; c < 3; ++c) square += pow(m.r[3 * ends[l] + 6 + c] - m.r[3 * ends[l] + c], 2);
            m.length[m.n_bonds - 1] = sqrt(square);
        }
        step s = take_step(m);
        check_step(&s);
        forget(&s);
    }
}

static void guesses_and_tolerances_are_accepted(void **state)
{
    (void)state;
    step s = take_step(coils(1));
    double *r = copy_of(s.start, size_of(&s.m));
    CHECK(hol_project_positions(s.chains, s.m.r, r, NULL, dt, s.lambda, 1, NULL, NULL));
    for (size_t i = 0; i < size_of(&s.m); ++i) CHECK_AT_MOST(fabs(r[i] - s.r[i]), 64 * DBL_EPSILON * 100);
    const double tolerance[] = {1e-5, 1e-7, 1e-10, 1e-14, 0.5};
    long double before = 0;
    for (int64_t k = 0; k < s.m.n_bonds; ++k) before = fmaxl(before, error_of(&s.m, s.start, NULL, k));
    for (int t = 0; t < 5; ++t) {
        hol_report report;
        long double worst = 0;
        memcpy(r, s.start, size_of(&s.m) * sizeof *r);
        CHECK(hol_chains_set_tolerance(s.chains, tolerance[t]));
        CHECK(hol_project_positions(s.chains, s.m.r, r, NULL, dt, s.lambda, 0, NULL, &report));
        for (int64_t k = 0; k < s.m.n_bonds; ++k) worst = fmaxl(worst, error_of(&s.m, r, NULL, k));
        CHECK_AT_MOST(worst, tolerance[t] * (1 + 1e-6) + 1e-12);
        CHECK_AT_MOST(fabsl(report.max_error - worst), 1e-12);
        assert_int_equal(report.n_corrected, before > tolerance[t]);
    }
    free(r);
    forget(&s);
}

static void threads_and_layouts_change_no_bit(void **state)
{
    (void)state;
    step s = take_step(coils(1));
    const size_t size = size_of(&s.m), atoms = size / 3, n = (size_t)s.m.n_bonds;
    double *r = copy_of(s.start, size), *v = copy_of(s.m.v, size), *lambda = untouched(n), virial[9];
    for (int threads = 2; threads < 4; ++threads) {
        memcpy(r, s.start, size * sizeof *r), memcpy(v, s.m.v, size * sizeof *v);
        CHECK(hol_chains_set_threads(s.chains, threads));
        CHECK(hol_project_positions(s.chains, s.m.r, r, v, dt, lambda, 0, virial, NULL));
        assert_same_bits(r, s.r, size);
        assert_same_bits(v, s.v, size);
        assert_same_bits(lambda, s.lambda, n);
        assert_same_bits(virial, s.virial, 9);
    }
    double *x[2] = {untouched(size), untouched(size)};
    for (size_t i = 0; i < size; ++i) {
        x[0][i % 3 * atoms + i / 3] = s.start[i];
        x[1][i % 3 * atoms + i / 3] = s.m.v[i];
    }
    const hol_view ref = {s.m.r, s.m.r + 1, s.m.r + 2, 3 * sizeof *r, HOL_DOUBLE, 0};
    hol_view view[2];
    for (int a = 0; a < 2; ++a) {
        const hol_view of = {x[a], x[a] + atoms, x[a] + 2 * atoms, sizeof *r, HOL_DOUBLE, 0};
        view[a] = of;
    }
    CHECK(hol_project_positions_view(s.chains, INPUT(&ref), view, view + 1, dt, lambda, 0, NULL, NULL));
    assert_same_bits(lambda, s.lambda, n);
    for (size_t i = 0; i < size; ++i) {
        assert_same_bits(x[0] + i % 3 * atoms + i / 3, s.r + i, 1);
        assert_same_bits(x[1] + i % 3 * atoms + i / 3, s.v + i, 1);
    }
    free(r), free(v), free(lambda), free(x[0]), free(x[1]);
    forget(&s);
}

/** The same molecule over every other atom. */
static void lists_of_atoms_change_no_bit(void **state)
{
    (void)state;
    step s = take_step(coils(0));
    const size_t size = size_of(&s.m), atoms = size / 3, n = (size_t)s.m.n_bonds;
    double *mass = untouched(2 * atoms), *at[3], *lambda = untouched(n);
    const double *const from[] = {s.m.r, s.start, s.m.v};
    int64_t *pairs = malloc(2 * n * sizeof *pairs);
    hol_chains *apart = NULL;
    for (size_t e = 0; e < 2 * n; ++e) pairs[e] = 2 * s.m.pairs[e];
    for (int a = 0; a < 3; ++a) at[a] = calloc(2 * size, sizeof *at[a]);
    for (size_t i = 0; i < atoms; ++i) {
        mass[2 * i] = s.m.mass[i], mass[2 * i + 1] = 1;
        for (int a = 0; a < 3; ++a) memcpy(at[a] + 6 * i, from[a] + 3 * i, 3 * sizeof *at[a]);
    }
    CHECK(hol_chains_create(2 * s.m.n_atoms, mass, &apart));
    CHECK(hol_chains_add_bonds(apart, s.m.n_bonds, pairs, s.m.length));
    CHECK(hol_project_positions(apart, at[0], at[1], at[2], dt, lambda, 0, NULL, NULL));
    assert_same_bits(lambda, s.lambda, n);
    for (size_t i = 0; i < atoms; ++i) {
        assert_same_bits(at[1] + 6 * i, s.r + 3 * i, 3);
        assert_same_bits(at[2] + 6 * i, s.v + 3 * i, 3);
    }
    free(mass), free(lambda), free(pairs);
    for (int a = 0; a < 3; ++a) free(at[a]);
    hol_chains_destroy(apart);
    forget(&s);
}

/** Moved into a box coordinates are rounded anew, and so are bonds. */
static void boxes_take_the_nearest_images(void **state)
{
    (void)state;
    const double boxes[2][9] = {{7, 0, 0, 0, 8, 0, 0, 0, 9}, {7, 0, 0, 1, 8, 0, -1, 2, 9}};
    step s = take_step(coils(1));
    const size_t size = size_of(&s.m), n = (size_t)s.m.n_bonds;
    double *lambda = untouched(n), most = 0;
    for (size_t k = 0; k < n; ++k) most = fmax(most, fabs(s.lambda[k]));
    for (int b = 0; b < 2; ++b) {
        double *inside[2] = {copy_of(s.m.r, size), copy_of(s.start, size)}, virial[9];
        for (int a = 0; a < 2; ++a)
            for (size_t i = 0; i < size; i += 3)
                for (int row = 2; row >= 0; --row) {
                    const double turns = floor(inside[a][i + (size_t)row] / boxes[b][4 * row]);
                    for (int c = 0; c < 3; ++c) inside[a][i + (size_t)c] -= turns * boxes[b][3 * row + c];
                }
        CHECK(hol_chains_set_box(s.chains, boxes[b]));
        CHECK(hol_project_positions(s.chains, inside[0], inside[1], NULL, dt, lambda, 0, virial, NULL));
        for (size_t k = 0; k < n; ++k) CHECK_AT_MOST(fabs(lambda[k] - s.lambda[k]), 1e-13 / (dt * dt) + 1e-9 * most);
        for (int e = 0; e < 9; ++e) CHECK_AT_MOST(fabs(virial[e] - s.virial[e]), 1e-9 * most * (double)n);
        free(inside[0]), free(inside[1]);
    }
    free(lambda);
    forget(&s);
}

static void floats_get_their_lengths_to_their_rounding(void **state)
{
    (void)state;
    step s = take_step(coils(1));
    const size_t size = size_of(&s.m);
    float *ref = malloc(size * sizeof *ref), *r = malloc(size * sizeof *r);
    double extent = 1;
    for (size_t i = 0; i < size; ++i) {
        ref[i] = (float)s.m.r[i], r[i] = (float)s.start[i];
        extent = fmax(extent, fabs(s.start[i]));
    }
    const hol_view from = {ref, ref + 1, ref + 2, 3 * sizeof *ref, HOL_FLOAT, 0},
                   to = {r, r + 1, r + 2, 3 * sizeof *r, HOL_FLOAT, 0};
    CHECK(hol_project_positions_view(s.chains, INPUT(&from), &to, NULL, dt, NULL, 0, NULL, NULL));
    for (size_t i = 0; i < size; ++i) CHECK_AT_MOST(fabs((double)r[i] - s.r[i]), 16 * (double)FLT_EPSILON * extent);
    free(ref), free(r);
    forget(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(paths_of_all_lengths_get_their_lengths),
        cmocka_unit_test(cycles_beside_paths_get_their_lengths),
        cmocka_unit_test(guesses_and_tolerances_are_accepted),
        cmocka_unit_test(threads_and_layouts_change_no_bit),
        cmocka_unit_test(lists_of_atoms_change_no_bit),
        cmocka_unit_test(boxes_take_the_nearest_images),
        cmocka_unit_test(floats_get_their_lengths_to_their_rounding),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
