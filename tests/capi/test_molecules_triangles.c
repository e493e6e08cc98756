/** Three atoms with all three distances, from right angles to nearly straight, of equal and of very unequal masses. */
#include "check.h"
#include "mixture.h"
#include "molecule_solution.h"

/** Legs of 1 and 1.3 that miss a straight line by `bend` radians, turned out of the axes. */
static molecule triangle(double bend, const double *mass, uint64_t seed)
{
    random_stream s = random_seed(seed);
    molecule m = molecule_empty();
    const double r[9] = {0.1,
                         0.2,
                         0.3,
                         0.1 + 0.6,
                         0.2 + 0.8,
                         0.3,
                         0.1 - 1.3 * (0.6 * cos(bend) - 0.8 * sin(bend)),
                         0.2 - 1.3 * (0.8 * cos(bend) + 0.6 * sin(bend)),
                         0.3};
    for (int i = 0; i < 3; ++i) molecule_add_atom(&m, mass[i], r + 3 * i);
    molecule_add_bond(&m, 0, 1);
    molecule_add_bond(&m, 0, 2);
    molecule_add_bond(&m, 1, 2);
    molecule_finish(&m, &s);
    return m;
}

static const double masses[5][3] = {{16, 1, 1}, {1, 1, 1}, {1e-9, 1, 1}, {1e9, 1e-9, 1}, {1, 1e9, 1e-6}};

static void nearly_straight_triangles_are_right_to_a_few_roundings(void **state)
{
    (void)state;
    for (double bend = 1; bend > 1e-9; bend /= 10)
        for (int k = 0; k < 5; ++k) {
            molecule part = triangle(bend, masses[k], 1);
            if (bend < 5e-8) part.length[2] *= 0.999; /* else its lengths would be those of a line, a rigid body */
            mixture m = mixture_make(&part, 1, ONE_AFTER_THE_OTHER, 0);
            const molecule_problem problem = molecule_problem_of(&part);
            const long double unit = oracle_bound(3) * DBL_EPSILON;
            double lambda[3], g[9], v[9], mu[3], log_det, fixman[9];
            molecule_solution forces, velocities;
            molecule_metric metric;
            assert_int_equal(molecule_forces(&problem, &forces), 0);
            assert_int_equal(molecule_velocities(&problem, &velocities), 0);
            assert_int_equal(molecule_metric_make(&problem, &metric), 0);
            memcpy(v, m.v, sizeof v);
            CHECK(hol_forces(m.chains, m.r, m.v, m.f, lambda, NULL, g, HOL_WRITE, NULL));
            CHECK(hol_project_velocities(m.chains, m.r, v, mu, NULL));
            CHECK(hol_metric(m.chains, m.r, 1, &log_det, NULL, NULL, fixman, HOL_WRITE));
            for (int b = 0; b < 3; ++b) {
                CHECK_AT_MOST(fabsl(lambda[b] - forces.lambda[b]), unit * forces.lambda_scale[b]);
                CHECK_AT_MOST(fabsl(mu[b] - velocities.lambda[b]), unit * velocities.lambda_scale[b]);
            }
            for (int i = 0; i < 9; ++i) {
                CHECK_AT_MOST(fabsl(g[i] - forces.g[i]), unit * forces.g_scale[i / 3]);
                CHECK_AT_MOST(fabsl(v[i] - velocities.moved[i]), unit * velocities.moved_scale[i / 3]);
                CHECK_AT_MOST(fabsl(fixman[i] - metric.fixman_force[i]), 2 * unit * metric.fixman_scale[i / 3]);
            }
            CHECK_AT_MOST(fabsl(log_det - metric.log_det), unit * fabsl(metric.log_det));
            molecule_solution_free(&forces);
            molecule_solution_free(&velocities);
            molecule_metric_free(&metric);
            mixture_free(&m);
            molecule_free(&part);
        }
}

/** A step with velocities that obey the constraints. */
static void positions_of_nearly_straight_triangles_are_right(void **state)
{
    (void)state;
    for (double bend = 1; bend > 1e-4; bend /= 10) {
        molecule part = triangle(bend, masses[0], 2);
        mixture m = mixture_make(&part, 1, ONE_AFTER_THE_OTHER, 0);
        /* about the axis it spins fast: a small part of a radian */
        CHECK(hol_project_velocities(m.chains, m.r, m.v, NULL, NULL));
        const double dt = 0.02 * bend;
        const molecule_problem problem = molecule_problem_of(&part);
        const long double unit = oracle_bound(3) * DBL_EPSILON;
        double *drifted = mixture_drifted(&m, dt), r[9], lambda[3];
        molecule_solution exact;
        memcpy(r, drifted, sizeof r);
        assert_int_equal(molecule_positions(&problem, drifted, NULL, part.length, dt, &exact), 0);
        CHECK(hol_project_positions(m.chains, m.r, r, NULL, dt, lambda, 0, NULL, NULL));
        for (int i = 0; i < 9; ++i) CHECK_AT_MOST(fabsl(r[i] - exact.moved[i]), unit * exact.moved_scale[i / 3]);
        for (int k = 0; k < 3; ++k) {
            long double square = 0;
            CHECK_AT_MOST(fabsl(lambda[k] - exact.lambda[k]), unit * exact.lambda_scale[k]);
            for (int x = 0; x < 3; ++x) {
                const long double d = (long double)r[3 * part.pairs[2 * k + 1] + x] - r[3 * part.pairs[2 * k] + x];
                square += d * d;
            }
            CHECK_AT_MOST(fabsl(square / ((long double)part.length[k] * part.length[k]) - 1), 8 * DBL_EPSILON * 3);
        }
        free(drifted);
        molecule_solution_free(&exact);
        mixture_free(&m);
        molecule_free(&part);
    }
}

static void straight_ones_are_refused_with_the_bond_named(void **state)
{
    (void)state;
    for (int along = 0; along < 2; ++along) { /* exactly along an axis, and along a general direction up to rounding */
        molecule part = molecule_make(MOLECULE_LINEAR, 3, 1);
        for (int i = 0; along && i < 3; ++i) {
            const double x = part.r[3 * i];
            part.r[3 * i] = 0.31 * x;
            part.r[3 * i + 1] = 0.52 * x;
            part.r[3 * i + 2] = 0.79 * x;
        }
        random_stream s = random_seed(3);
        molecule_finish(&part, &s);
        part.length[2] *= 0.999; /* exactly straight lengths would make it a rigid body */
        mixture m = mixture_make(&part, 1, ONE_AFTER_THE_OTHER, 0);
        double *lambda = untouched(3), *g = untouched(9), *v = copy_of(m.v, 9), *r = mixture_drifted(&m, 1e-3);
        double *drifted = copy_of(r, 9), *log_det = untouched(1);
        int64_t bond = -1;
        CHECK_FAILS(HOL_ERR_DEGENERATE, hol_forces(m.chains, m.r, m.v, m.f, lambda, NULL, g, HOL_WRITE, NULL));
        hol_error_location(NULL, &bond, NULL, NULL);
        assert_in_range(bond, 0, 2);
        CHECK_FAILS(HOL_ERR_DEGENERATE, hol_solve(m.chains, m.r, m.length, lambda, g, HOL_WRITE, NULL));
        CHECK_FAILS(HOL_ERR_DEGENERATE, hol_project_velocities(m.chains, m.r, v, lambda, NULL));
        CHECK_FAILS(HOL_ERR_DEGENERATE, hol_metric(m.chains, m.r, 1, log_det, NULL, NULL, g, HOL_WRITE));
        const int status = hol_project_positions(m.chains, m.r, r, NULL, 1e-3, lambda, 0, NULL, NULL);
        assert_true(status == HOL_ERR_DEGENERATE || status == HOL_ERR_NO_CONVERGENCE);
        assert_untouched(lambda, 3);
        assert_untouched(g, 9);
        assert_untouched(log_det, 1);
        assert_same_bits(v, m.v, 9);
        assert_same_bits(r, drifted, 9);
        free(lambda), free(g), free(v), free(r), free(drifted), free(log_det);
        mixture_free(&m);
        molecule_free(&part);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nearly_straight_triangles_are_right_to_a_few_roundings),
        cmocka_unit_test(positions_of_nearly_straight_triangles_are_right),
        cmocka_unit_test(straight_ones_are_refused_with_the_bond_named),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
