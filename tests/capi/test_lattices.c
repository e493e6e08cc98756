/**
 * Lattices and sheets of single bonds, whose cycles are eliminated front by front: small ones beside solutions in 448
 * bits, large ones by what multipliers leave of the equations.
 */
#include <stdlib.h>
#include <string.h>

#include "network_scene.h"
#include "random.h"

typedef struct {
    int n, flat; /**< atoms in a row; a sheet with diagonals, of that height, or a cube */
    double height;
    double masses; /**< decades */
    int fixed;     /**< every eleventh atom is held fixed */
    int periodic;  /**< all bonds of the cube but a fifth, and those that go round the box */
} sort;

static network_scene make(sort of, uint64_t seed)
{
    network_scene s = network_scene_empty(of.periodic ? of.n : 0);
    random_stream random = random_seed(seed);
    const int64_t n = of.n, atoms = of.flat ? n * n : n * n * n;
    for (int64_t i = 0; i < atoms; ++i) {
        double r[3] = {(double)(i % n), (double)(i / n % n), of.flat ? 0 : (double)(i / (n * n))};
        for (int c = of.flat ? 2 : 0; c < 3; ++c)
            r[c] += (of.flat ? 2 * of.height : 0.3) * (random_uniform(&random) - 0.5);
        const double mass = pow(10, of.masses * (random_uniform(&random) - 0.5));
        molecule_add_atom(&s.m, of.fixed && i % 11 == 3 ? 0 : mass, r);
    }
    for (int64_t i = 0; i < atoms; ++i) {
        const int64_t at[3] = {i % n, i / n % n, i / (n * n)}, step[3] = {1, n, n * n};
        for (int x = 0; x < (of.flat ? 2 : 3); ++x) {
            if (at[x] + 1 == n && !of.periodic) continue;
            const int64_t j = at[x] + 1 < n ? i + step[x] : i - (n - 1) * step[x];
            if ((of.flat || random_uniform(&random) > 0.2) && (s.m.mass[i] > 0 || s.m.mass[j] > 0))
                molecule_add_bond(&s.m, i, j);
        }
        if (of.flat && at[0] + 1 < n && at[1] + 1 < n) molecule_add_bond(&s.m, i, i + n + 1);
    }
    molecule_finish(&s.m, &random);
    network_begin(&s);
    return s;
}
static network_scene added(sort of, uint64_t seed)
{
    network_scene s = make(of, seed);
    network_add(&s);
    return s;
}
static const sort sorts[] = {{6, 0, 0, 0, 0, 0}, {6, 0, 0, 5, 0, 1}, {6, 0, 0, 2, 1, 1}, {15, 1, 0.3, 3, 0, 0}};
enum { n_sorts = sizeof sorts / sizeof *sorts };
static const sort sheet = {60, 1, 0.3, 0, 0, 0};

static void all_levels_are_those_of_many_digits(void **state)
{
    (void)state;
    /* A sheet has fewer digits to find than a cube, which the next test has. */
    for (int which = quick_run() ? n_sorts - 1 : 0; which < n_sorts; ++which) {
        sort of = sorts[which];
        if (quick_run()) of.n = 10;
        network_scene s = added(of, 1 + (uint64_t)which);
        const molecule_problem p = network_problem(&s);
        double *lambda = untouched((size_t)s.m.n_bonds);
        molecule_solution exact;
        assert_int_equal(molecule_forces(&p, &exact), 0);
        CHECK(hol_chains_set_outcomes(s.chains, 1));
        CHECK(hol_forces(s.chains, s.m.r, s.m.v, s.m.f, lambda, NULL, NULL, HOL_WRITE, NULL));
        int status[8], rounds[8];
        CHECK(hol_outcomes(s.chains, status, rounds));
        assert_in_range(rounds[0], 1, 8); /* it is worked on as a network, and iterates little */
        for (int64_t k = 0; k < s.m.n_bonds; ++k)
            CHECK_AT_MOST(fabsl(lambda[k] - exact.lambda[k]), network_unit(&s) * exact.lambda_scale[k]);
        molecule_solution_free(&exact);
        check_network_velocities(&s);
        free(lambda);
        network_free(s);
    }
}

static void positions_get_their_lengths(void **state)
{
    (void)state;
    for (int which = 0; which < (quick_run() ? 1 : n_sorts + 1); ++which) {
        const sort of = which < n_sorts ? sorts[which] : sheet;
        network_scene s = added(of, 1 + (uint64_t)which);
        CHECK(hol_project_velocities(s.chains, s.m.r, s.m.v, NULL, NULL));
        const double dt = of.masses > 0 ? 1e-5 : of.flat ? 1e-3 : 0.01;
        double *r = molecule_drifted(&s.m, dt);
        hol_report report;
        CHECK(hol_project_positions(s.chains, s.m.r, r, NULL, dt, NULL, 0, NULL, &report));
        assert_true(report.n_corrected == 1 && report.iterations < 8);
        CHECK_AT_MOST(network_worst_length(&s, r), 16 * DBL_EPSILON * (1 + 2. * of.n));
        free(r);
        network_free(s);
    }
}

/** What is left of each bond's equation, beside its terms and the rounding of the multipliers. */
static void a_corrugated_sheet_is_solved_to_rounding(void **state)
{
    (void)state;
    sort of = sheet;
    if (quick_run()) of.n = 30;
    network_scene s = added(of, 3);
    double *lambda = untouched((size_t)s.m.n_bonds), *g = untouched(3 * (size_t)s.m.n_atoms);
    CHECK(hol_forces(s.chains, s.m.r, s.m.v, s.m.f, lambda, NULL, g, HOL_WRITE, NULL));
    double *tension = calloc((size_t)s.m.n_atoms, sizeof *tension);
    for (int64_t k = 0; k < s.m.n_bonds; ++k)
        for (int e = 0; e < 2; ++e) tension[s.m.pairs[2 * k + e]] += fabs(2 * lambda[k] * s.m.length[k]);
    for (int64_t k = 0; k < s.m.n_bonds; ++k) {
        const int64_t i = s.m.pairs[2 * k], j = s.m.pairs[2 * k + 1];
        long double sum = 0, size = s.m.length[k] * (tension[i] + tension[j]);
        for (int c = 0; c < 3; ++c) {
            const long double d = (long double)s.m.r[3 * j + c] - s.m.r[3 * i + c],
                              dv = (long double)s.m.v[3 * j + c] - s.m.v[3 * i + c];
            sum += d * ((long double)s.m.f[3 * j + c] + g[3 * j + c] - s.m.f[3 * i + c] - g[3 * i + c]) + dv * dv;
        }
        CHECK_AT_MOST(fabsl(sum), 4 * DBL_EPSILON * size);
    }
    free(lambda), free(g), free(tension);
    network_free(s);
}

static void a_flat_sheet_is_refused_as_dependent(void **state)
{
    (void)state;
    sort of = sheet;
    of.height = 0;
    if (quick_run()) of.n = 30;
    network_scene s = added(of, 4);
    const size_t size = 3 * (size_t)s.m.n_atoms;
    double *g = untouched(size), *before = copy_of(g, size), *v = copy_of(s.m.v, size);
    CHECK_FAILS(HOL_ERR_DEGENERATE, hol_forces(s.chains, s.m.r, s.m.v, s.m.f, NULL, NULL, g, HOL_WRITE, NULL));
    assert_same_bits(g, before, size);
    CHECK_FAILS(HOL_ERR_DEGENERATE, hol_project_velocities(s.chains, s.m.r, v, NULL, NULL));
    assert_same_bits(v, s.m.v, size);
    free(g), free(before), free(v);
    network_free(s);
}

/** Fronts that would take more than the limit are not made; then nothing solves a large sheet. */
static void fronts_count_in_the_memory_limit(void **state)
{
    (void)state;
    sort of = sheet;
    if (quick_run()) of.n = 40;
    network_scene s = make(of, 3);
    CHECK(hol_chains_set_memory_limit(s.chains, 1000 * s.m.n_bonds));
    network_add(&s);
    CHECK_FAILS(HOL_ERR_DEGENERATE, hol_forces(s.chains, s.m.r, s.m.v, s.m.f, NULL, NULL, s.m.f, HOL_ADD, NULL));
    network_free(s);
}

static void threads_change_no_bit(void **state)
{
    (void)state;
    const sort of = {quick_run() ? 7 : 14, 0, 0, 0, 0, 1};
    network_scene s = added(of, 6);
    const size_t size = 3 * (size_t)s.m.n_atoms;
    double *g[2], *v[2], *r[2];
    for (int i = 0; i < 2; ++i) {
        g[i] = untouched(size), v[i] = copy_of(s.m.v, size), r[i] = molecule_drifted(&s.m, 0.005);
        CHECK(hol_chains_set_threads(s.chains, i ? 3 : 1));
        CHECK(hol_forces(s.chains, s.m.r, s.m.v, s.m.f, NULL, NULL, g[i], HOL_WRITE, NULL));
        CHECK(hol_project_velocities(s.chains, s.m.r, v[i], NULL, NULL));
        CHECK(hol_project_positions(s.chains, s.m.r, r[i], NULL, 0.005, NULL, 0, NULL, NULL));
    }
    assert_same_bits(g[0], g[1], size);
    assert_same_bits(v[0], v[1], size);
    assert_same_bits(r[0], r[1], size);
    for (int i = 0; i < 2; ++i) free(g[i]), free(v[i]), free(r[i]);
    network_free(s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(all_levels_are_those_of_many_digits),
        cmocka_unit_test(positions_get_their_lengths),
        cmocka_unit_test(a_corrugated_sheet_is_solved_to_rounding),
        cmocka_unit_test(a_flat_sheet_is_refused_as_dependent),
        cmocka_unit_test(fronts_count_in_the_memory_limit),
        cmocka_unit_test(threads_change_no_bit),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
