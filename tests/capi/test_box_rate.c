/** A box that changes: d.(v_j - v_i + L d) = 0 of velocities, and what else follows from it. */
#include "assembly.h"
#include "check.h"
#include "layout.h"
#include "mixture.h"
#include "molecule_solution.h"

static const double L[9] = {0.11, -0.7, 0.2, 0.35, -0.4, 0.05, -0.15, 0.6, 0.23};

/** L x */
static void turned(const double *rate, const long double *x, long double *y)
{
    for (int a = 0; a < 3; ++a) y[a] = rate[3 * a] * x[0] + rate[3 * a + 1] * x[1] + rate[3 * a + 2] * x[2];
}

/** d.(v_j - v_i + L d), and the sum of its terms' absolute values; images in an orthorhombic box, or without one. */
static long double rate_of(const double *r, const double *v, int64_t i, int64_t j, const double *box, long double *size)
{
    long double d[3], Ld[3], rate = 0;
    *size = 0;
    for (int x = 0; x < 3; ++x) {
        d[x] = (long double)r[3 * j + x] - r[3 * i + x];
        if (box) d[x] -= box[4 * x] * roundl(d[x] / box[4 * x]);
    }
    turned(L, d, Ld);
    for (int x = 0; x < 3; ++x) {
        rate += d[x] * (((long double)v[3 * j + x] - v[3 * i + x]) + Ld[x]);
        *size +=
            fabsl(d[x]) * (fabs(v[3 * j + x]) + fabs(v[3 * i + x]) + 2 * (fabsl(d[0]) + fabsl(d[1]) + fabsl(d[2])));
    }
    return rate;
}

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
            rhs[k] = (double)(2 * rate_of(part->r, part->v, part->pairs[2 * k], part->pairs[2 * k + 1], NULL, &size));
        }
        assert_int_equal(molecule_solve(&problem, rhs, &exact), 0);
        mixture_take(&m, p, v, got);
        mixture_take_bonds(&m, p, lambda, mu);
        for (int64_t k = 0; k < part->n_bonds; ++k) {
            const int64_t i = part->pairs[2 * k], j = part->pairs[2 * k + 1];
            if (part->mass[i] == 0 && part->mass[j] == 0) continue;
            long double size;
            const long double left = rate_of(part->r, got, i, j, NULL, &size);
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
            CHECK_AT_MOST(fabsl(rate_of(a->r, v, atoms[k], atoms[k + 1], box, &terms)), 16 * DBL_EPSILON * terms);
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
        turned(L, x, Lx);
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
        CHECK(hol_project_velocities_view(a.chains, &r.view, &w.view, mu, NULL));
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
        CHECK(hol_project_velocities_view(m.chains, &r.view, &v.view, NULL, NULL));
        collect(&r, x);
        collect(&v, u);
        for (int64_t k = 0; k < m.n_bonds; ++k) {
            long double terms;
            const long double left = rate_of(x, u, m.pairs[2 * k], m.pairs[2 * k + 1], NULL, &terms);
            CHECK_AT_MOST(fabsl(left), 4 * FLT_EPSILON * terms);
        }
        free(x), free(u);
        laid_out_free(&r), laid_out_free(&v);
    }
    mixture_free(&m);
}

static void zeros_are_no_rate(void **state)
{
    (void)state;
    const double none[9] = {0};
    mixture m = mixture_of_all(1, MIXED, 7);
    const size_t size = mixture_size(&m);
    double *v = copy_of(m.v, size), *u = copy_of(m.v, size), *g = untouched(size), *h = untouched(size);
    CHECK(hol_project_velocities(m.chains, m.r, v, NULL, NULL));
    CHECK(hol_forces(m.chains, m.r, m.v, m.f, NULL, NULL, g, HOL_WRITE, NULL));
    CHECK(hol_chains_set_box_rate(m.chains, L));
    CHECK(hol_chains_set_box_rate(m.chains, none));
    CHECK(hol_project_velocities(m.chains, m.r, u, NULL, NULL));
    assert_same_bits(v, u, size);
    CHECK(hol_chains_set_box_rate(m.chains, L));
    CHECK(hol_chains_set_box_rate(m.chains, NULL));
    CHECK(hol_forces(m.chains, m.r, m.v, m.f, NULL, NULL, h, HOL_WRITE, NULL));
    assert_same_bits(g, h, size);
    free(v), free(u), free(g), free(h);
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

static void violation_measures_the_whole_motion(void **state)
{
    (void)state;
    mixture m = mixture_of_kind(MOLECULE_XH3, 5, 3, 3, MIXED, 9);
    hol_worst worst;
    long double largest = 0;
    CHECK(hol_chains_set_box_rate(m.chains, L));
    CHECK(hol_violation(m.chains, m.r, m.v, &worst));
    for (int64_t k = 0; k < m.n_bonds; ++k) {
        long double terms;
        const long double rate = fabsl(rate_of(m.r, m.v, m.pairs[2 * k], m.pairs[2 * k + 1], NULL, &terms));
        if (rate > largest) largest = rate;
    }
    CHECK_AT_MOST(fabsl(worst.rate - largest), 16 * DBL_EPSILON * largest);
    CHECK(hol_violation(m.chains, m.r, NULL, &worst));
    assert_true(worst.rate == 0 && worst.rate_chain == -1);
    mixture_free(&m);
}

/** sigma''/2 = d.(A_j - A_i) + |v_j - v_i + L d|^2 = 0 with A = w (f + G). */
static void forces_keep_the_lengths_of_the_whole_motion(void **state)
{
    (void)state;
    mixture m = mixture_of_all(1, MIXED, 11);
    const size_t size = mixture_size(&m), n = (size_t)m.n_bonds;
    double *lambda = untouched(n), *tension = untouched(n), *g = untouched(size), virial[9];
    CHECK(hol_chains_set_box_rate(m.chains, L));
    CHECK(hol_forces(m.chains, m.r, m.v, m.f, lambda, tension, g, HOL_WRITE, virial));
    for (int64_t p = 0; p < m.n_parts; ++p) {
        const molecule *part = m.parts + p;
        const molecule_problem problem = molecule_problem_of(part);
        const long double unit = 2 * oracle_bound(part->n_bonds) * DBL_EPSILON;
        double *rhs = untouched((size_t)part->n_bonds), *got = untouched(3 * (size_t)part->n_atoms),
               *mu = untouched((size_t)part->n_bonds), *T = untouched((size_t)part->n_bonds);
        molecule_solution exact;
        for (int64_t k = 0; k < part->n_bonds; ++k) {
            const int64_t i = part->pairs[2 * k], j = part->pairs[2 * k + 1];
            long double d[3], Ld[3], sum = 0;
            for (int x = 0; x < 3; ++x) d[x] = (long double)part->r[3 * j + x] - part->r[3 * i + x];
            turned(L, d, Ld);
            for (int x = 0; x < 3; ++x) {
                const long double u = (long double)part->v[3 * j + x] - part->v[3 * i + x] + Ld[x];
                sum += u * u + d[x] * ((long double)part->inverse_mass[j] * part->f[3 * j + x] -
                                       (long double)part->inverse_mass[i] * part->f[3 * i + x]);
            }
            rhs[k] = (double)(2 * sum);
        }
        assert_int_equal(molecule_solve(&problem, rhs, &exact), 0);
        mixture_take(&m, p, g, got);
        mixture_take_bonds(&m, p, lambda, mu);
        mixture_take_bonds(&m, p, tension, T);
        /* the right-hand sides lose digits where d.w f cancels, up to a factor of their condition */
        for (int64_t k = 0; k < part->n_bonds; ++k) {
            CHECK_AT_MOST(fabsl(mu[k] - exact.lambda[k]), 64 * unit * exact.lambda_scale[k]);
            if (part->mass[part->pairs[2 * k]] == 0 && part->mass[part->pairs[2 * k + 1]] == 0) continue;
            const double *ri = part->r + 3 * part->pairs[2 * k], *rj = part->r + 3 * part->pairs[2 * k + 1];
            const double expected =
                2 * mu[k] * sqrt(pow(rj[0] - ri[0], 2) + pow(rj[1] - ri[1], 2) + pow(rj[2] - ri[2], 2));
            CHECK_AT_MOST(fabs(T[k] - expected), 8 * DBL_EPSILON * fabs(expected));
        }
        for (int64_t i = 0; i < 3 * part->n_atoms; ++i)
            if (exact.g_scale[i / 3] > 0) CHECK_AT_MOST(fabsl(got[i] - exact.g[i]), 64 * unit * exact.g_scale[i / 3]);
        free(rhs), free(got), free(mu), free(T);
        molecule_solution_free(&exact);
    }
    free(lambda), free(tension), free(g);
    mixture_free(&m);
}

static void bad_and_inactive_molecules_are_left_alone(void **state)
{
    (void)state;
    const double not_finite[9] = {0, 0, 0, 0, INFINITY, 0, 0, 0, 0};
    mixture m = mixture_of_kind(MOLECULE_CHAIN, 30, 1, 7, ONE_AFTER_THE_OTHER, 12);
    const size_t size = mixture_size(&m);
    double *v = copy_of(m.v, size), *good = copy_of(m.v, size), *bad, *lambda = untouched((size_t)m.n_bonds);
    unsigned char active[30];
    CHECK_FAILS(HOL_ERR_NULL, hol_chains_set_box_rate(NULL, L));
    CHECK(hol_chains_set_box_rate(m.chains, L));
    CHECK_FAILS(HOL_ERR_VALUE, hol_chains_set_box_rate(m.chains, not_finite));
    assert_message_names("(2,2)");
    CHECK(hol_project_velocities(m.chains, m.r, good, NULL, NULL));
    v[3 * m.first_atom[17] + 1] = NAN;
    bad = copy_of(v, size);
    CHECK_FAILS(HOL_ERR_NOT_FINITE, hol_project_velocities(m.chains, m.r, v, lambda, NULL));
    char name[40];
    snprintf(name, sizeof name, "velocity of atom %lld", (long long)m.first_atom[17]);
    assert_message_names(name);
    for (int64_t p = 0; p < 30; ++p) {
        const size_t at = 3 * (size_t)m.first_atom[p], n = 3 * (size_t)m.parts[p].n_atoms;
        assert_same_bits(v + at, (p == 17 ? bad : good) + at, n);
    }
    assert_untouched(lambda + m.first_bond[17], (size_t)m.parts[17].n_bonds);
    memset(active, 1, sizeof active);
    active[17] = 0;
    CHECK(hol_chains_set_active(m.chains, active));
    CHECK(hol_project_velocities(m.chains, m.r, v, NULL, NULL));
    free(v), free(good), free(bad), free(lambda);
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
        cmocka_unit_test(zeros_are_no_rate),
        cmocka_unit_test(a_box_that_turns_changes_no_velocity),
        cmocka_unit_test(violation_measures_the_whole_motion),
        cmocka_unit_test(forces_keep_the_lengths_of_the_whole_motion),
        cmocka_unit_test(bad_and_inactive_molecules_are_left_alone),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
