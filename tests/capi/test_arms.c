/**
 * Large trees with linear arms, which are cut into segments where their atoms have consecutive numbers: arms of all
 * lengths, numbered outwards and inwards, straight ones beside coils, fixed ends, boxes, layouts, threads.
 */
#include "check.h"
#include "input.h"
#include "large.h"

static long double eps(void)
{
    return fmaxl(DBL_EPSILON, long_double_rounding());
}

static long double difference(const double *r, int64_t j, int64_t i, int c)
{
    return (long double)r[3 * j + c] - r[3 * i + c];
}

/** What multipliers do to the atoms, and 2 lambda d by which each bond pulls, in long double. */
static long double *pulls_of(const molecule *m, const double *lambda)
{
    long double *g = calloc(3 * (size_t)m->n_atoms, sizeof *g);
    for (int64_t k = 0; k < m->n_bonds; ++k)
        for (int c = 0; c < 3; ++c) {
            const int64_t i = m->pairs[2 * k], j = m->pairs[2 * k + 1];
            const long double p = 2 * (long double)lambda[k] * difference(m->r, j, i, c);
            g[3 * i + c] += p;
            g[3 * j + c] -= p;
        }
    return g;
}

/**
 * Fails unless lambda solves the equations to some roundings: what it leaves of them, in long double, is solved for
 * once more by hol_solve, which knows no arms. Errors relative to the largest multiplier at the bond's atoms, or of
 * all.
 */
static void check_multipliers(const molecule *m, const hol_chains *chains, const double *lambda, int rates, int of_all)
{
    const size_t n = (size_t)m->n_bonds;
    long double *g = pulls_of(m, lambda);
    double *left = untouched(n), *error = untouched(n), *largest = calloc((size_t)m->n_atoms, sizeof *largest),
           most = 0;
    for (size_t k = 0; k < n; ++k) {
        const int64_t i = m->pairs[2 * k], j = m->pairs[2 * k + 1];
        const long double wi = m->inverse_mass[i], wj = m->inverse_mass[j];
        long double sum = 0;
        for (int c = 0; c < 3; ++c) {
            const long double d = difference(m->r, j, i, c), dv = difference(m->v, j, i, c);
            const long double fi = rates ? 0 : m->f[3 * i + c], fj = rates ? 0 : m->f[3 * j + c];
            sum += d * (wj * (g[3 * j + c] + fj) - wi * (g[3 * i + c] + fi)) + (rates ? d : dv) * dv;
        }
        left[k] = (double)(2 * sum);
        largest[i] = fmax(largest[i], fabs(lambda[k])), largest[j] = fmax(largest[j], fabs(lambda[k]));
        most = fmax(most, fabs(lambda[k]));
    }
    CHECK(hol_solve(chains, m->r, left, error, NULL, HOL_WRITE, NULL));
    for (size_t k = 0; k < n; ++k) {
        const double here = fmax(largest[m->pairs[2 * k]], largest[m->pairs[2 * k + 1]]);
        CHECK_AT_MOST(fabs(error[k]), 1000 * eps() * (of_all ? most : here));
    }
    free(g), free(left), free(error), free(largest);
}

static void check_forces(const molecule *m, const hol_chains *chains, int of_all)
{
    const size_t n = (size_t)m->n_bonds, size = 3 * (size_t)m->n_atoms;
    double *lambda = untouched(n), *tension = untouched(n), *g = untouched(size), *added = copy_of(m->f, size),
           virial[9];
    CHECK(hol_forces(chains, m->r, m->v, m->f, lambda, tension, g, HOL_WRITE, virial));
    check_multipliers(m, chains, lambda, 0, of_all);
    CHECK(hol_forces(chains, m->r, m->v, m->f, NULL, NULL, added, HOL_ADD, NULL));
    long double *exact = pulls_of(m, lambda), sum[9] = {0}, sizes[9] = {0}, most = 0;
    for (size_t k = 0; k < n; ++k) most = fmaxl(most, fabs(lambda[k]));
    for (size_t i = 0; i < size; ++i) {
        CHECK_AT_MOST(fabsl(g[i] - exact[i]), 40 * eps() * most);
        assert_true(added[i] == m->f[i] + g[i]);
    }
    for (size_t k = 0; k < n; ++k) {
        const int64_t i = m->pairs[2 * k], j = m->pairs[2 * k + 1];
        long double q = 0;
        for (int a = 0; a < 3; ++a) {
            q += difference(m->r, j, i, a) * difference(m->r, j, i, a);
            for (int b = 0; b < 3; ++b) {
                const long double p = 2 * lambda[k] * difference(m->r, j, i, a) * difference(m->r, j, i, b);
                sum[3 * a + b] -= p, sizes[3 * a + b] += fabsl(p);
            }
        }
        CHECK_AT_MOST(fabsl(tension[k] - 2 * lambda[k] * sqrtl(q)), 10 * eps() * fabs(lambda[k]));
    }
    for (int e = 0; e < 9; ++e) CHECK_AT_MOST(fabsl(virial[e] - sum[e]), 100 * eps() * sizes[e]);
    free(lambda), free(tension), free(g), free(added), free(exact);
}

/** The second projection leaves what the rounding of the velocities does. */
static void check_velocities(const molecule *m, const hol_chains *chains, int of_all)
{
    const size_t n = (size_t)m->n_bonds, size = 3 * (size_t)m->n_atoms;
    double *v = copy_of(m->v, size), *mu = untouched(n), virial[9];
    CHECK(hol_project_velocities(chains, m->r, v, mu, virial));
    check_multipliers(m, chains, mu, 1, of_all);
    long double *g = pulls_of(m, mu), most = 0;
    for (size_t i = 0; i < size; ++i) most = fmaxl(most, fabsl(g[i]));
    for (size_t i = 0; i < size; ++i)
        CHECK_AT_MOST(fabsl(v[i] - (m->v[i] + (long double)m->inverse_mass[i / 3] * g[i])), 1000 * eps() * (1 + most));
    for (size_t k = 0; k < n; ++k) {
        const int64_t i = m->pairs[2 * k], j = m->pairs[2 * k + 1];
        long double rate = 0, size_of_terms = 0;
        for (int c = 0; c < 3; ++c) {
            rate += difference(m->r, j, i, c) * difference(v, j, i, c);
            size_of_terms += fabsl(difference(m->r, j, i, c)) * (fabs(v[3 * i + c]) + fabs(v[3 * j + c]));
        }
        CHECK_AT_MOST(fabsl(rate), 8 * eps() * (size_of_terms + (of_all ? most : 0)));
    }
    free(v), free(mu), free(g);
}

static void check_and_free(molecule m, int of_all)
{
    hol_chains *chains = large_chains(&m);
    check_forces(&m, chains, of_all);
    check_velocities(&m, chains, of_all);
    hol_chains_destroy(chains);
    molecule_free(&m);
}

static void arms_of_all_lengths_are_solved(void **state)
{
    (void)state;
    const int64_t range[][2] = {{1, 60}, {60, 90}, {120, 140}, {250, 266}, {1018, 1036}, {2040, 2056}};
    for (size_t i = 0; i < (quick_run() ? 2 : sizeof range / sizeof *range); ++i)
        check_and_free(large_arms(range[i][0], range[i][1], 2), 0);
}

static void straight_arms_and_fixed_ends_are_solved(void **state)
{
    (void)state;
    check_and_free(large_mixed_arms(quick_run() ? 3000 : 20000), 1);
}

static void threads_change_no_bit(void **state)
{
    (void)state;
    molecule m = large_mixed_arms(quick_run() ? 3000 : 60000);
    hol_chains *chains = large_chains(&m);
    const size_t n = (size_t)m.n_bonds, size = 3 * (size_t)m.n_atoms;
    double *lambda[2], *g[2], *v[2], *mu[2], virial[2][2][9];
    for (int several = 0; several < 2; ++several) {
        lambda[several] = untouched(n), mu[several] = untouched(n);
        g[several] = untouched(size), v[several] = copy_of(m.v, size);
        CHECK(hol_chains_set_threads(chains, 1 + 2 * several));
        CHECK(hol_forces(chains, m.r, m.v, m.f, lambda[several], NULL, g[several], HOL_WRITE, virial[several][0]));
        CHECK(hol_project_velocities(chains, m.r, v[several], mu[several], virial[several][1]));
    }
    assert_same_bits(lambda[1], lambda[0], n);
    assert_same_bits(mu[1], mu[0], n);
    assert_same_bits(g[1], g[0], size);
    assert_same_bits(v[1], v[0], size);
    assert_same_bits(virial[1][0], virial[0][0], 18);
    for (int i = 0; i < 2; ++i) free(lambda[i]), free(mu[i]), free(g[i]), free(v[i]);
    hol_chains_destroy(chains);
    molecule_free(&m);
}

/** The same molecule over every other atom, and in arrays of x, y and z. */
static void lists_and_layouts_change_no_bit(void **state)
{
    (void)state;
    molecule m = large_mixed_arms(quick_run() ? 3000 : 8000);
    const size_t n = (size_t)m.n_bonds, size = 3 * (size_t)m.n_atoms, atoms = (size_t)m.n_atoms;
    double *lambda = untouched(n), *g = untouched(size), *v = copy_of(m.v, size), *other = untouched(n);
    hol_chains *chains = large_chains(&m), *apart = NULL;
    CHECK(hol_forces(chains, m.r, m.v, m.f, lambda, NULL, g, HOL_WRITE, NULL));
    CHECK(hol_project_velocities(chains, m.r, v, NULL, NULL));
    double *mass = untouched(2 * atoms), *at[4]; /* r, v, f, G; and x, y, z of each */
    int64_t *pairs = malloc(2 * n * sizeof *pairs);
    for (size_t e = 0; e < 2 * n; ++e) pairs[e] = 2 * m.pairs[e];
    for (int a = 0; a < 4; ++a) at[a] = untouched(2 * size);
    for (size_t i = 0; i < atoms; ++i) {
        mass[2 * i] = m.mass[i], mass[2 * i + 1] = 1;
        for (size_t c = 0; c < 3; ++c) {
            at[0][6 * i + c] = m.r[3 * i + c], at[1][6 * i + c] = m.v[3 * i + c], at[2][6 * i + c] = m.f[3 * i + c];
            for (int a = 0; a < 4; ++a) at[a][6 * i + 3 + c] = 0;
        }
    }
    CHECK(hol_chains_create(2 * m.n_atoms, mass, &apart));
    CHECK(hol_chains_add_bonds(apart, m.n_bonds, pairs, m.length));
    CHECK(hol_forces(apart, at[0], at[1], at[2], other, NULL, at[3], HOL_WRITE, NULL));
    CHECK(hol_project_velocities(apart, at[0], at[1], NULL, NULL));
    assert_same_bits(other, lambda, n);
    for (size_t i = 0; i < atoms; ++i) {
        assert_same_bits(at[3] + 6 * i, g + 3 * i, 3);
        assert_same_bits(at[1] + 6 * i, v + 3 * i, 3);
    }
    hol_view view[4];
    const double *const packed[] = {m.r, m.v, m.f};
    for (int a = 0; a < 4; ++a) {
        double *const x = at[a];
        const hol_view of = {x, x + atoms, x + 2 * atoms, sizeof *x, HOL_DOUBLE, 0};
        view[a] = of;
        for (size_t i = 0; i < atoms && a < 3; ++i)
            for (size_t c = 0; c < 3; ++c) x[c * atoms + i] = packed[a][3 * i + c];
    }
    CHECK(
        hol_forces_view(chains, INPUT(view), INPUT(view + 1), INPUT(view + 2), other, NULL, view + 3, HOL_WRITE, NULL));
    CHECK(hol_project_velocities_view(chains, INPUT(view), view + 1, NULL, NULL));
    assert_same_bits(other, lambda, n);
    for (size_t i = 0; i < atoms; ++i)
        for (size_t c = 0; c < 3; ++c) {
            assert_same_bits(at[3] + c * atoms + i, g + 3 * i + c, 1);
            assert_same_bits(at[1] + c * atoms + i, v + 3 * i + c, 1);
        }
    for (int a = 0; a < 4; ++a) free(at[a]);
    free(lambda), free(g), free(v), free(other), free(mass), free(pairs);
    hol_chains_destroy(apart);
    hol_chains_destroy(chains);
    molecule_free(&m);
}

/** Coordinates are rounded anew when they are moved into the box, and so are bonds. */
static void boxes_take_the_nearest_images(void **state)
{
    (void)state;
    const double boxes[2][9] = {{7, 0, 0, 0, 8, 0, 0, 0, 9}, {7, 0, 0, 1, 8, 0, -1, 2, 9}};
    molecule m = large_arms(120, quick_run() ? 130 : 140, 2);
    const size_t n = (size_t)m.n_bonds;
    double *lambda = untouched(n), *inside = untouched(n), most = 0;
    hol_chains *chains = large_chains(&m);
    CHECK(hol_forces(chains, m.r, m.v, m.f, lambda, NULL, NULL, HOL_WRITE, NULL));
    for (size_t k = 0; k < n; ++k) most = fmax(most, fabs(lambda[k]));
    for (int b = 0; b < 2; ++b) {
        double *r = copy_of(m.r, 3 * (size_t)m.n_atoms);
        for (int64_t i = 0; i < m.n_atoms; ++i)
            for (int row = 2; row >= 0; --row) {
                const double turns = floor(r[3 * i + row] / boxes[b][4 * row]);
                for (int c = 0; c < 3; ++c) r[3 * i + c] -= turns * boxes[b][3 * row + c];
            }
        CHECK(hol_chains_set_box(chains, boxes[b]));
        CHECK(hol_forces(chains, r, m.v, m.f, inside, NULL, NULL, HOL_WRITE, NULL));
        for (size_t k = 0; k < n; ++k) CHECK_AT_MOST(fabs(inside[k] - lambda[k]), 1e-11 * most);
        free(r);
    }
    free(lambda), free(inside);
    hol_chains_destroy(chains);
    molecule_free(&m);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(arms_of_all_lengths_are_solved), cmocka_unit_test(straight_arms_and_fixed_ends_are_solved),
        cmocka_unit_test(threads_change_no_bit),          cmocka_unit_test(lists_and_layouts_change_no_bit),
        cmocka_unit_test(boxes_take_the_nearest_images),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
