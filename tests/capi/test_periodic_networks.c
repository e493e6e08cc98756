/**
 * Networks across a periodic box, whose cycles go round it: a ring, small graphs, large ones. The matrix knows bond
 * vectors alone, each the nearest image.
 */
#include <stdlib.h>
#include <string.h>

#include "check.h"
#include "molecule.h"
#include "molecule_solution.h"
#include "random.h"

typedef struct {
    molecule m;
    hol_chains *chains;
    double box[9];
    int64_t n_bonds;
} scene;

/** The nearest image of a bond, by trying all. */
static double image_of(const scene *s, const double *r, int64_t k, double *d)
{
    const int64_t i = s->m.pairs[2 * k], j = s->m.pairs[2 * k + 1];
    double best = HUGE_VAL;
    for (int n = 0; n < 343; ++n) {
        const int step[3] = {n % 7 - 3, n / 7 % 7 - 3, n / 49 - 3};
        double x[3], square = 0;
        for (int c = 0; c < 3; ++c) {
            x[c] = r[3 * j + c] - r[3 * i + c];
            for (int h = 0; h < 3; ++h) x[c] += step[h] * s->box[3 * h + c];
            square += x[c] * x[c];
        }
        if (square < best) best = square, memcpy(d, x, sizeof x);
    }
    return best;
}

/** n^3 nodes of a lattice at a distance of 2, joined to their neighbours, but for a part of them, by two bonds each
 * where `twice` is 1; some nodes have an atom beside them. All but three bonds, and no such atoms, where it is 2. A
 * ring of n where `ring`. */
static scene make(int n, int twice, int ring, int skewed, uint64_t seed)
{
    scene s = {molecule_empty(), NULL, {2. * n, 0, 0, 0, ring ? 9 : 2. * n, 0, 0, 0, ring ? 9 : 2. * n}, 0};
    random_stream random = random_seed(seed);
    if (skewed) s.box[3] = 0.7, s.box[6] = -0.4, s.box[7] = 0.9;
    const int rows = ring ? 1 : n;
    const double step = 2;
    for (int64_t i = 0; i < (int64_t)n * rows * rows; ++i) {
        const int64_t at[3] = {i % n, i / n % rows, i / ((int64_t)n * rows)};
        double r[3];
        for (int c = 0; c < 3; ++c) {
            r[c] = 0.5 * (random_uniform(&random) - 0.5);
            for (int h = 0; h < 3; ++h) r[c] += (double)at[h] * step * s.box[3 * h + c] / (2. * (ring ? n : n));
        }
        molecule_add_atom(&s.m, 0.5 + random_uniform(&random), r);
    }
    const int64_t n_nodes = s.m.n_atoms;
    for (int64_t i = 0; i < n_nodes; ++i)
        for (int h = 0; h < (ring ? 1 : 3); ++h) {
            int64_t at[3] = {i % n, i / n % rows, i / ((int64_t)n * rows)};
            if (!ring && (twice == 2 ? i == 0 : random_uniform(&random) < 0.25)) continue;
            at[h] = (at[h] + 1) % n;
            const int64_t j = at[0] + n * (at[1] + rows * at[2]);
            if (twice != 1) {
                molecule_add_bond(&s.m, i, j);
                continue;
            }
            double r[3];
            for (int c = 0; c < 3; ++c)
                r[c] = s.m.r[3 * i + c] + 0.5 * s.box[3 * h + c] / n + 0.5 * (random_uniform(&random) - 0.5);
            const int64_t middle = molecule_add_atom(&s.m, 0.5 + random_uniform(&random), r);
            molecule_add_bond(&s.m, i, middle);
            molecule_add_bond(&s.m, middle, j);
        }
    for (int64_t i = 0; i < n_nodes && !ring && twice < 2; i += 5) {
        const double u[3] = {0.6, 0.8, 0};
        molecule_grow(&s.m, i, 0.3, 1, u);
    }
    molecule_finish(&s.m, &random);
    double d[3];
    for (int64_t k = 0; k < s.m.n_bonds; ++k) s.m.length[k] = sqrt(image_of(&s, s.m.r, k, d));
    for (int64_t i = 0; i < s.m.n_atoms; ++i) /* anywhere among the images */
        for (int h = 0; h < 3; ++h)
            for (int c = 0; c < 3; ++c) s.m.r[3 * i + c] += (double)((i * (h + 2)) % 3 - 1) * s.box[3 * h + c];
    CHECK(hol_chains_create(s.m.n_atoms, s.m.mass, &s.chains));
    CHECK(hol_chains_set_box(s.chains, s.box));
    CHECK(hol_chains_add_bonds(s.chains, s.m.n_bonds, s.m.pairs, s.m.length));
    return s;
}
static void destroy(scene s)
{
    hol_chains_destroy(s.chains);
    molecule_free(&s.m);
}

static molecule_problem problem_of(const scene *s)
{
    molecule_problem p = molecule_problem_of(&s->m);
    p.box = s->box;
    return p;
}

static scene example(int which)
{
    return which == 0   ? make(6, 0, 1, 0, 1)
           : which == 1 ? make(9, 1, 1, 1, 2)
           : which == 2 ? make(3, 0, 0, 0, 3)
           : which == 3 ? make(3, 1, 0, 1, 4)
           : which == 4 ? make(4, 1, 0, 1, 5)
                        : make(3, 2, 0, 1, 6);
}
enum { examples = 6 };

/* Images round: each component of a bond by eps of some cells, in units of a bond of 1. */
static long double unit_of(const scene *s)
{
    return (oracle_bound(s->m.n_bonds) + 256) * DBL_EPSILON;
}

static void forces_and_virial_are_those_of_the_bond_vectors(void **state)
{
    (void)state;
    for (int which = 0; which < (quick_run() ? 3 : examples); ++which) {
        scene s = example(which);
        const molecule_problem p = problem_of(&s);
        molecule_solution exact;
        double *lambda = untouched((size_t)s.m.n_bonds), *g = untouched(3 * (size_t)s.m.n_atoms), virial[9];
        assert_int_equal(molecule_forces(&p, &exact), 0);
        CHECK(hol_forces(s.chains, s.m.r, s.m.v, s.m.f, lambda, NULL, g, HOL_WRITE, virial));
        long double sum[9] = {0}, size = 0;
        for (int64_t k = 0; k < s.m.n_bonds; ++k) {
            double d[3];
            CHECK_AT_MOST(fabsl(lambda[k] - exact.lambda[k]), unit_of(&s) * exact.lambda_scale[k]);
            size += 2 * exact.lambda_scale[k] * image_of(&s, s.m.r, k, d);
            for (int a = 0; a < 9; ++a) sum[a] -= 2 * exact.lambda[k] * d[a / 3] * d[a % 3];
        }
        for (int a = 0; a < 9; ++a) CHECK_AT_MOST(fabsl(virial[a] - sum[a]), unit_of(&s) * size);
        for (int64_t i = 0; i < 3 * s.m.n_atoms; ++i)
            CHECK_AT_MOST(fabsl(g[i] - exact.g[i]), unit_of(&s) * exact.g_scale[i / 3]);
        molecule_solution_free(&exact);
        free(lambda), free(g);
        destroy(s);
    }
}

static void velocities_are_projected(void **state)
{
    (void)state;
    for (int which = 0; which < (quick_run() ? 3 : examples); ++which) {
        scene s = example(which);
        const molecule_problem p = problem_of(&s);
        molecule_solution exact;
        const size_t size = 3 * (size_t)s.m.n_atoms;
        double *lambda = untouched((size_t)s.m.n_bonds), *v = copy_of(s.m.v, size);
        assert_int_equal(molecule_velocities(&p, &exact), 0);
        CHECK(hol_project_velocities(s.chains, s.m.r, v, lambda, NULL));
        for (int64_t k = 0; k < s.m.n_bonds; ++k)
            CHECK_AT_MOST(fabsl(lambda[k] - exact.lambda[k]), unit_of(&s) * exact.lambda_scale[k]);
        for (size_t i = 0; i < size; ++i)
            CHECK_AT_MOST(fabsl(v[i] - exact.moved[i]), unit_of(&s) * exact.moved_scale[i / 3]);
        molecule_solution_free(&exact);
        free(lambda), free(v);
        destroy(s);
    }
}

/** From reference positions, and from bond vectors. */
static void positions_get_their_lengths(void **state)
{
    (void)state;
    const double dt = 0.01;
    for (int which = 0; which < (quick_run() ? 3 : examples); ++which) {
        scene s = example(which);
        const molecule_problem p = problem_of(&s);
        molecule_solution exact;
        const size_t size = 3 * (size_t)s.m.n_atoms;
        double *start = molecule_drifted(&s.m, dt), *vectors = untouched(3 * (size_t)s.m.n_bonds);
        assert_int_equal(molecule_positions(&p, start, s.box, s.m.length, dt, &exact), 0);
        for (int64_t k = 0; k < s.m.n_bonds; ++k) image_of(&s, s.m.r, k, vectors + 3 * k);
        for (int along = 0; along < 2; ++along) {
            double *r = copy_of(start, size);
            hol_worst worst;
            if (along)
                CHECK(hol_project_positions_along(s.chains, vectors, r, NULL, dt, NULL, 0, NULL, NULL));
            else
                CHECK(hol_project_positions(s.chains, s.m.r, r, NULL, dt, NULL, 0, NULL, NULL));
            for (size_t i = 0; i < size; ++i) CHECK_AT_MOST(fabsl(r[i] - exact.moved[i]), 256 * DBL_EPSILON * 20);
            CHECK(hol_violation(s.chains, r, NULL, &worst));
            CHECK_AT_MOST(worst.length, 8 * DBL_EPSILON * (1 + 40));
            CHECK(hol_chains_check(s.chains, r, HOL_BOX));
            free(r);
        }
        molecule_solution_free(&exact);
        free(start), free(vectors);
        destroy(s);
    }
}

static void the_metric_is_that_of_the_bond_vectors(void **state)
{
    (void)state;
    for (int which = 0; which < 3; ++which) {
        scene s = example(which);
        const molecule_problem p = problem_of(&s);
        molecule_metric exact;
        double energy;
        assert_int_equal(molecule_metric_make(&p, &exact), 0);
        CHECK(hol_metric(s.chains, s.m.r, 1, NULL, NULL, &energy, NULL, HOL_WRITE));
        CHECK_AT_MOST(fabsl(energy - 0.5L * exact.log_det),
                      unit_of(&s) * (fabsl(exact.log_det) + (long double)s.m.n_bonds));
        molecule_metric_free(&exact);
        destroy(s);
    }
}

/** Three bonds for each atom but for one: no more can be independent where nothing can turn, three fewer where it can.
 */
static void what_goes_round_the_box_can_not_turn(void **state)
{
    (void)state;
    scene s = make(3, 2, 0, 0, 7);
    assert_true(s.m.n_bonds == 3 * s.m.n_atoms - 3);
    assert_true(hol_chains_degrees_of_freedom(s.chains, 3) == 3);
    double *lengths = copy_of(s.m.length, (size_t)s.m.n_bonds);
    hol_chains *whole = NULL;
    CHECK(hol_chains_create(s.m.n_atoms, s.m.mass, &whole));
    CHECK_FAILS(HOL_ERR_DEGENERATE, hol_chains_add_bonds(whole, s.m.n_bonds, s.m.pairs, lengths));
    CHECK(hol_chains_set_box(whole, s.box));
    for (int64_t k = 0; k < s.m.n_bonds; ++k) lengths[k] *= 1e-3; /* then no cycle is long enough */
    CHECK_FAILS(HOL_ERR_DEGENERATE, hol_chains_add_bonds(whole, s.m.n_bonds, s.m.pairs, lengths));
    hol_chains_destroy(whole);
    free(lengths);
    destroy(s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(forces_and_virial_are_those_of_the_bond_vectors),
        cmocka_unit_test(velocities_are_projected),
        cmocka_unit_test(positions_get_their_lengths),
        cmocka_unit_test(the_metric_is_that_of_the_bond_vectors),
        cmocka_unit_test(what_goes_round_the_box_can_not_turn),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
