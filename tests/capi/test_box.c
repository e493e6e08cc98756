/** Minimum image: the same chains, unwrapped and wrapped into boxes, against solutions with images found by search. */
#include "assembly.h"
#include "check.h"
#include "random.h"
#include "solution.h"

static const double cube[9] = {7, 0, 0, 0, 7, 0, 0, 0, 7};
static const double brick[9] = {6.5, 0, 0, 0, 9.25, 0, 0, 0, 5.1};
static const double slab[9] = {6.5, 0, 0, 0, 0, 0, 0, 0, 5.1};
static const double negative[9] = {-6.5, 0, 0, 0, 9.25, 0, 0, 0, 5.1};
static const double tilted[9] = {7, 0, 0, 2.5, 6.5, 0, -1.75, 2, 8};
static const double general[9] = {7, 0.5, -0.25, 1, 8, 0.75, -1.5, 0.5, 6.5};
static const double tilted_slab[9] = {7, 0, 0, 2.5, 6.5, 0, 0, 0, 0};
static const double strongly_tilted[9] = {7, 0, 0, 3.5, 7, 0, -3.5, 3.5, 8};

static const struct {
    const char *name;
    const double *box;
} boxes[] = {
    {"cube", cube},
    {"brick", brick},
    {"slab", slab},
    {"negative", negative},
    {"tilted", tilted},
    {"general", general},
    {"tilted slab", tilted_slab},
    {"strongly tilted", strongly_tilted},
};
enum { BOXES = sizeof boxes / sizeof *boxes };

/** Moves every atom by a random whole number of box vectors. */
static void wrap(assembly *a, const double *box, uint64_t seed)
{
    random_stream s = random_seed(seed);
    for (int64_t i = 0; i < a->n_atoms; ++i)
        for (int row = 0; row < 3; ++row) {
            const double n = (double)random_integer(&s, -2, 2);
            for (int x = 0; x < 3; ++x) a->r[3 * i + x] += n * box[3 * row + x];
        }
}

static void forces_take_the_nearest_image(void **state)
{
    (void)state;
    for (int b = 0; b < BOXES; ++b) {
        print_message("%s\n", boxes[b].name);
        assembly a = assembly_of_kind(CHAIN_HETEROGENEOUS, 23, 1, 40, SCATTERED, 60 + (uint64_t)b);
        wrap(&a, boxes[b].box, 3);
        const size_t n = (size_t)a.n_bonds;
        double *lambda = untouched(n), *tension = untouched(n), *g = untouched(assembly_size(&a)), virial[9];
        long double sum[9] = {0}, scale = 0;
        CHECK(hol_chains_set_box(a.chains, boxes[b].box));
        CHECK(hol_forces(a.chains, a.r, a.v, a.f, lambda, tension, g, HOL_WRITE, virial));
        for (int64_t c = 0; c < a.n_chains; ++c) {
            chain one = assembly_chain(&a, c);
            const solution_problem p = {one.n_bonds, one.mass, NULL, one.r, one.v, one.f, boxes[b].box};
            solution exact;
            assert_int_equal(solution_forces(&p, &exact), 0);
            /* a wrapped bond is the difference of coordinates up to 40 + 2 * 3 * 9 less a box vector: a relative error
               of about 100 eps in the bond, which the bound for exact bonds doesn't cover; it moves lambda by as much
               times the scale, twice (matrix and right side) */
            const long double unit = (oracle_bound(one.n_bonds) + 400) * DBL_EPSILON;
            for (int64_t k = 0; k < one.n_bonds; ++k)
                CHECK_AT_MOST(fabsl(lambda[a.first_bond[c] + k] - exact.lambda[k]), unit * exact.lambda_scale[k]);
            for (int64_t i = 0; i <= one.n_bonds; ++i)
                for (int x = 0; x < 3; ++x)
                    CHECK_AT_MOST(fabsl(g[3 * a.atoms[a.first[c] + i] + x] - exact.g[3 * i + x]),
                                  unit * exact.g_scale[i]);
            for (int i = 0; i < 9; ++i) sum[i] += exact.virial[i];
            scale += exact.virial_scale;
            solution_free(&exact);
            chain_free(&one);
        }
        for (int i = 0; i < 9; ++i) CHECK_AT_MOST(fabsl(virial[i] - sum[i]), 420 * DBL_EPSILON * scale);
        free(lambda), free(tension), free(g);
        assembly_free(&a);
    }
}

static void a_box_changes_chains_that_do_not_cross_it_by_rounding_only(void **state)
{
    (void)state;
    assembly a = assembly_of_kind(CHAIN_HETEROGENEOUS, 23, 1, 40, SCATTERED, 61);
    const size_t n = (size_t)a.n_bonds;
    double *lambda = untouched(n), *boxed = untouched(n);
    CHECK(hol_forces(a.chains, a.r, a.v, a.f, lambda, NULL, NULL, HOL_WRITE, NULL));
    for (int b = 0; b < BOXES; ++b) {
        CHECK(hol_chains_set_box(a.chains, boxes[b].box));
        CHECK(hol_forces(a.chains, a.r, a.v, a.f, boxed, NULL, NULL, HOL_WRITE, NULL));
        for (int64_t c = 0; c < a.n_chains; ++c) {
            chain one = assembly_chain(&a, c);
            const solution_problem p = {one.n_bonds, one.mass, NULL, one.r, one.v, one.f, NULL};
            solution exact;
            assert_int_equal(solution_forces(&p, &exact), 0);
            for (int64_t k = 0; k < one.n_bonds; ++k) {
                const int64_t at = a.first_bond[c] + k;
                CHECK_AT_MOST(fabs(boxed[at] - lambda[at]),
                              oracle_bound(one.n_bonds) * DBL_EPSILON * exact.lambda_scale[k]);
            }
            solution_free(&exact);
            chain_free(&one);
        }
    }
    free(lambda), free(boxed);
    assembly_free(&a);
}

static void a_box_may_be_taken_away_again(void **state)
{
    (void)state;
    const double r[6] = {0, 0, 0, 6, 0, 0}, v[6] = {0, 0, 0, 0, 1, 0}, mass[2] = {1, 1}, length = 1;
    double tension;
    hol_chains *c;
    CHECK(hol_chains_create(2, mass, &c));
    CHECK(hol_chains_add_block(c, 1, 1, 0, &length));
    CHECK(hol_chains_set_box(c, cube));
    CHECK(hol_forces(c, r, v, NULL, NULL, &tension, NULL, HOL_WRITE, NULL));
    assert_true(tension == 0.5); /* reduced mass 1/2, speed 1, distance 1 */
    CHECK(hol_chains_set_box(c, NULL));
    CHECK(hol_forces(c, r, v, NULL, NULL, &tension, NULL, HOL_WRITE, NULL));
    CHECK_AT_MOST(fabs(tension - 0.5 / 6), DBL_EPSILON / 8);
    hol_chains_destroy(c);
}

static void a_refused_box_leaves_the_old_one(void **state)
{
    (void)state;
    const double r[6] = {0, 0, 0, 6, 0, 0}, v[6] = {0, 0, 0, 0, 1, 0}, mass[2] = {1, 1}, length = 1;
    const double singular[9] = {1, 2, 3, 2, 4, 6, 0, 0, 1};
    double tension;
    hol_chains *c;
    CHECK(hol_chains_create(2, mass, &c));
    CHECK(hol_chains_add_block(c, 1, 1, 0, &length));
    CHECK(hol_chains_set_box(c, cube));
    CHECK_FAILS(HOL_ERR_VALUE, hol_chains_set_box(c, singular));
    CHECK(hol_forces(c, r, v, NULL, NULL, &tension, NULL, HOL_WRITE, NULL));
    assert_true(tension == 0.5);
    hol_chains_destroy(c);
}

/** Positions, velocities and violation of wrapped chains against those of the unwrapped ones. */
static void projections_take_the_nearest_image(void **state)
{
    (void)state;
    const double dt = 0.002;
    for (int b = 0; b < BOXES; ++b) {
        assembly a = assembly_of_kind(CHAIN_COIL, 23, 1, 40, SCATTERED, 62 + (uint64_t)b),
                 w = assembly_of_kind(CHAIN_COIL, 23, 1, 40, SCATTERED, 62 + (uint64_t)b);
        const size_t size = assembly_size(&a);
        double *shift = copy_of(a.r, size);
        wrap(&w, boxes[b].box, 4);
        for (size_t i = 0; i < size; ++i) shift[i] = w.r[i] - a.r[i];
        CHECK(hol_chains_set_box(w.chains, boxes[b].box));
        double *q = copy_of(a.r, size), *wq = copy_of(w.r, size), *v = copy_of(a.v, size), *wv = copy_of(a.v, size);
        /* the wrapped run may cross the faces during the drift as well */
        for (size_t i = 0; i < size; ++i) {
            q[i] += dt * a.v[i];
            wq[i] += dt * a.v[i];
        }
        hol_report report;
        CHECK(hol_project_positions(a.chains, a.r, q, v, dt, NULL, 0, NULL, NULL));
        CHECK(hol_project_positions(w.chains, w.r, wq, wv, dt, NULL, 0, NULL, &report));
        assert_int_equal(report.n_failed, 0);
        for (size_t i = 0; i < size; ++i) {
            if (isnan(a.r[i])) continue;
            /* coordinates of 100 carry 1.4e-14; the projection is well conditioned and may move it by some times that
             */
            CHECK_AT_MOST(fabs(wq[i] - shift[i] - q[i]), 40 * 100 * DBL_EPSILON);
            CHECK_AT_MOST(fabs(wv[i] - v[i]), 40 * 100 * DBL_EPSILON / dt);
        }
        memcpy(v, a.v, size * sizeof *v), memcpy(wv, a.v, size * sizeof *v);
        CHECK(hol_project_velocities(a.chains, a.r, v, NULL, NULL));
        CHECK(hol_project_velocities(w.chains, w.r, wv, NULL, NULL));
        for (size_t i = 0; i < size; ++i)
            if (!isnan(a.r[i])) CHECK_AT_MOST(fabs(wv[i] - v[i]), 100 * 100 * DBL_EPSILON);
        hol_worst worst;
        CHECK(hol_violation(w.chains, w.r, wv, &worst));
        CHECK_AT_MOST(worst.length, 4 * 100 * DBL_EPSILON);
        CHECK_AT_MOST(worst.rate, 64 * DBL_EPSILON * 10);
        free(shift), free(q), free(wq), free(v), free(wv);
        assembly_free(&a);
        assembly_free(&w);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(forces_take_the_nearest_image),
        cmocka_unit_test(a_box_changes_chains_that_do_not_cross_it_by_rounding_only),
        cmocka_unit_test(a_box_may_be_taken_away_again),
        cmocka_unit_test(a_refused_box_leaves_the_old_one),
        cmocka_unit_test(projections_take_the_nearest_image),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
