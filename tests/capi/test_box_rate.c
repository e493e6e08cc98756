/** Velocities in a box that changes: d.(v_j - v_i + L d) = 0. */
#include "assembly.h"
#include "box_rate.h"
#include "check.h"
#include "input.h"
#include "layout.h"
#include "mixture.h"
#include "molecule_solution.h"

static void velocities_agree_with_a_dense_solution(void **state)
{
    (void)state;
    mixture m = mixture_of_all(quick_run() ? 1 : 4, MIXED, 10);
    double *v = copy_of(m.v, mixture_size(&m)), *lambda = untouched((size_t)m.n_bonds), virial[9];
    long double expected[9] = {0}, allowed = 0;
    CHECK(hol_chains_set_box_rate(m.chains, L));
    CHECK(hol_project_velocities(m.chains, m.r, v, lambda, virial));
    for (int64_t p = 0; p < m.n_parts; ++p) {
        const molecule *part = m.parts + p;
        const molecule_problem problem = molecule_problem_of(part);
        /* twice: the reference gets right-hand sides that are rounded */
        const long double unit = 2 * oracle_bound(part->n_bonds) * DBL_EPSILON;
        double *got = untouched(3 * (size_t)part->n_atoms), *mu = untouched((size_t)part->n_bonds),
               *rhs = untouched((size_t)part->n_bonds);
        molecule_solution exact;
        for (int64_t k = 0; k < part->n_bonds; ++k) {
            long double size;
            rhs[k] =
                (double)(2 * rate_of_bond(part->r, part->v, part->pairs[2 * k], part->pairs[2 * k + 1], NULL, &size));
        }
        assert_int_equal(molecule_solve(&problem, rhs, &exact), 0);
        mixture_take(&m, p, v, got);
        mixture_take_bonds(&m, p, lambda, mu);
        for (int64_t k = 0; k < part->n_bonds; ++k) {
            const int64_t i = part->pairs[2 * k], j = part->pairs[2 * k + 1];
            if (part->mass[i] == 0 && part->mass[j] == 0) continue;
            long double size;
            const long double left = rate_of_bond(part->r, got, i, j, NULL, &size);
            CHECK_AT_MOST(fabsl(mu[k] - exact.lambda[k]), unit * exact.lambda_scale[k]);
            CHECK_AT_MOST(fabsl(left), oracle_bound(part->n_bonds) * DBL_EPSILON *
                                           (size + exact.g_scale[i] * part->inverse_mass[i] +
                                            exact.g_scale[j] * part->inverse_mass[j]));
        }
        for (int64_t i = 0; i < 3 * part->n_atoms; ++i) {
            const long double w = part->inverse_mass[i / 3];
            CHECK_AT_MOST(fabsl(got[i] - (part->v[i] + w * exact.g[i])),
                          unit * (fabs(part->v[i]) + w * exact.g_scale[i / 3]));
        }
        for (int i = 0; i < 9; ++i) expected[i] += exact.virial[i];
        allowed += unit * exact.virial_scale;
        free(got), free(mu), free(rhs);
        molecule_solution_free(&exact);
    }
    for (int i = 0; i < 9; ++i) CHECK_AT_MOST(fabsl(virial[i] - expected[i]), 2 * allowed);
    free(v), free(lambda);
    mixture_free(&m);
}

/** Rates left, momenta that change, of chains of one length in any place. */
static void check_chains(assembly *a, const double *box)
{
    const size_t size = assembly_size(a);
    double *v = copy_of(a->v, size), *lambda = untouched((size_t)a->n_bonds);
    CHECK(hol_chains_set_box(a->chains, box));
    CHECK(hol_chains_set_box_rate(a->chains, L));
    CHECK(hol_project_velocities(a->chains, a->r, v, lambda, NULL));
    hol_worst worst;
    CHECK(hol_violation(a->chains, a->r, v, &worst));
    CHECK_AT_MOST(worst.rate, 1e-13); /* speeds and bonds of about 1, up to 4 and 1.5 */
    for (int64_t c = 0; c < a->n_chains; ++c) {
        const int64_t *atoms = a->atoms + a->first[c], n = assembly_bonds(a, c);
        long double momentum[3] = {0}, sum = 0;
        for (int64_t k = 0; k < n; ++k) {
            long double terms;
            CHECK_AT_MOST(fabsl(rate_of_bond(a->r, v, atoms[k], atoms[k + 1], box, &terms)), 16 * DBL_EPSILON * terms);
        }
        for (int64_t i = 0; i <= n; ++i)
            for (int x = 0; x < 3; ++x) {
                const int64_t at = 3 * atoms[i] + x;
                momentum[x] += a->mass[atoms[i]] * ((long double)v[at] - a->v[at]);
                sum += a->mass[atoms[i]] * (fabs(v[at]) + fabs(a->v[at]));
            }
        for (int x = 0; x < 3; ++x) CHECK_AT_MOST(fabsl(momentum[x]), 16 * DBL_EPSILON * sum);
    }
    free(v), free(lambda);
}

static void chains_of_any_length_place_and_box_obey_it(void **state)
{
    (void)state;
    static const int64_t lengths[][2] = {{1, 1},     {2, 2},     {3, 3},       {4, 5},      {1, 40},
                                         {100, 100}, {255, 260}, {1000, 1003}, {5000, 5000}};
    const double box[9] = {23, 0, 0, 0, 19, 0, 0, 0, 29};
    for (size_t i = 0; i < sizeof lengths / sizeof *lengths; ++i)
        for (int way = 0; way < 8; ++way) {
            if (quick_run() && lengths[i][1] > 300 && way > 0) continue;
            assembly a = assembly_of_kind(way & 4 ? CHAIN_HETEROGENEOUS : CHAIN_COIL, lengths[i][0] < 500 ? 19 : 2,
                                          lengths[i][0], lengths[i][1], way & 1 ? SCATTERED : IN_ORDER, i);
            if (way & 2)
                for (int64_t k = 0; k < a.n_atoms; ++k)
                    for (int x = 0; x < 3; ++x) a.r[3 * k + x] -= box[4 * x] * floor(a.r[3 * k + x] / box[4 * x]);
            check_chains(&a, way & 2 ? box : NULL);
            assembly_free(&a);
        }
}

/** u = v + L (r - r_0), projected without a rate, is the same motion. */
static void it_is_the_projection_of_the_whole_motion(void **state)
{
    (void)state;
    assembly a = assembly_of_kind(CHAIN_MASSES_1E3, 6, 9, 9, IN_ORDER, 3);
    const size_t size = assembly_size(&a);
    double *v = copy_of(a.v, size), *u = copy_of(a.v, size), *before;
    for (int64_t i = 0; i < a.n_atoms; ++i) {
        const int64_t first = i / 10 * 10;
        long double x[3], Lx[3];
        for (int c = 0; c < 3; ++c) x[c] = (long double)a.r[3 * i + c] - a.r[3 * first + c];
        rate_times(L, x, Lx);
        for (int c = 0; c < 3; ++c) u[3 * i + c] += (double)Lx[c];
    }
    before = copy_of(u, size);
    CHECK(hol_project_velocities(a.chains, a.r, u, NULL, NULL));
    CHECK(hol_chains_set_box_rate(a.chains, L));
    CHECK(hol_project_velocities(a.chains, a.r, v, NULL, NULL));
    /* speeds of up to 20 */
    for (size_t i = 0; i < size; ++i) CHECK_AT_MOST(fabs(v[i] - a.v[i] - (u[i] - before[i])), 64 * 20 * DBL_EPSILON);
    free(v), free(u), free(before);
    assembly_free(&a);
}

static void layouts_threads_and_neighbours_change_no_bit(void **state)
{
    (void)state;
    assembly a = assembly_of_kind(CHAIN_HETEROGENEOUS, 300, 1, 60, SCATTERED, 5);
    const size_t size = assembly_size(&a), n = (size_t)a.n_bonds;
    double *v = copy_of(a.v, size), *again = copy_of(a.v, size), *lambda = untouched(n), *mu = untouched(n);
    double virial[9], other[9];
    CHECK(hol_chains_set_box_rate(a.chains, L));
    CHECK(hol_project_velocities(a.chains, a.r, v, lambda, virial));
    CHECK(hol_chains_set_threads(a.chains, 3));
    CHECK(hol_project_velocities(a.chains, a.r, again, mu, other));
    assert_same_bits(v, again, size);
    assert_same_bits(lambda, mu, n);
    assert_same_bits(virial, other, 9);
    for (int l = 0; l < n_double_layouts; ++l) {
        laid_out r = lay_out(layouts + l, a.n_atoms, a.r, 3), w = lay_out(layouts + l, a.n_atoms, a.v, 3);
        CHECK(hol_project_velocities_view(a.chains, INPUT(&r.view), &w.view, mu, NULL));
        collect(&w, again);
        assert_same_bits(v, again, size);
        assert_same_bits(lambda, mu, n);
        assert_true(gaps_untouched(&w));
        laid_out_free(&r), laid_out_free(&w);
    }
    for (int64_t c = 0; c < a.n_chains; c += 13) {
        chain part = assembly_chain(&a, c);
        assembly alone = assembly_make(&part, 1, IN_ORDER, 1);
        double *w = copy_of(alone.v, assembly_size(&alone)), *of_part = untouched(assembly_size(&alone));
        CHECK(hol_chains_set_box_rate(alone.chains, L));
        CHECK(hol_project_velocities(alone.chains, alone.r, w, NULL, NULL));
        assembly_take(&a, c, v, of_part);
        assert_same_bits(w, of_part, assembly_size(&alone));
        free(w), free(of_part);
        assembly_free(&alone);
        chain_free(&part);
    }
    free(v), free(again), free(lambda), free(mu);
    assembly_free(&a);
}

static void floats_obey_it_to_their_rounding(void **state)
{
    (void)state;
    mixture m = mixture_of_kind(MOLECULE_ALKANE, 9, 2, 7, ONE_AFTER_THE_OTHER, 6);
    const size_t size = mixture_size(&m);
    CHECK(hol_chains_set_box_rate(m.chains, L));
    for (int l = n_double_layouts; l < n_layouts; ++l) {
        laid_out r = lay_out(layouts + l, m.n_atoms, m.r, 3), v = lay_out(layouts + l, m.n_atoms, m.v, 3);
        double *x = copy_of(m.r, size), *u = copy_of(m.v, size);
        CHECK(hol_project_velocities_view(m.chains, INPUT(&r.view), &v.view, NULL, NULL));
        collect(&r, x);
        collect(&v, u);
        for (int64_t k = 0; k < m.n_bonds; ++k) {
            long double terms;
            const long double left = rate_of_bond(x, u, m.pairs[2 * k], m.pairs[2 * k + 1], NULL, &terms);
            CHECK_AT_MOST(fabsl(left), 4 * FLT_EPSILON * terms);
        }
        free(x), free(u);
        laid_out_free(&r), laid_out_free(&v);
    }
    mixture_free(&m);
}

/** An antisymmetric L turns the box: a bond's length does not see it. */
static void a_box_that_turns_changes_no_velocity(void **state)
{
    (void)state;
    const double turn[9] = {0, 0.5, -2, -0.5, 0, 1, 2, -1, 0};
    mixture m = mixture_of_all(1, MIXED, 8);
    const size_t size = mixture_size(&m);
    double *v = copy_of(m.v, size), *u;
    CHECK(hol_project_velocities(m.chains, m.r, v, NULL, NULL));
    u = copy_of(m.v, size);
    CHECK(hol_chains_set_box_rate(m.chains, turn));
    CHECK(hol_project_velocities(m.chains, m.r, u, NULL, NULL));
    for (size_t i = 0; i < size; ++i)
        if (!isnan(v[i])) CHECK_AT_MOST(fabs(u[i] - v[i]), 1e-6 * (1 + fabs(v[i]))); /* the worst condition is 1e9 */
    free(v), free(u);
    mixture_free(&m);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(velocities_agree_with_a_dense_solution),
        cmocka_unit_test(chains_of_any_length_place_and_box_obey_it),
        cmocka_unit_test(it_is_the_projection_of_the_whole_motion),
        cmocka_unit_test(layouts_threads_and_neighbours_change_no_bit),
        cmocka_unit_test(floats_obey_it_to_their_rounding),
        cmocka_unit_test(a_box_that_turns_changes_no_velocity),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
