/**
 * Atoms with many bonds, alone or with cycles through them: wheels, fans, several hubs, cores with a shell, stars. And
 * networks of light atoms between heavy ones. Small ones beside solutions in 448 bits, large ones by what multipliers
 * leave of the equations.
 */
#include <stdlib.h>
#include <string.h>

#include "network_scene.h"
#include "random.h"

typedef struct {
    int rim, arm,
        hubs; /**< so many chains of that many bonds from the first hub; others have bonds to the chains' ends */
    int bonds_of_rim;        /**< between neighbours at the ends: none, all but the last, all */
    int pendants;            /**< further atoms at the ends */
    double hub_mass, masses; /**< decades of all others */
} sort;
enum { open_rim = 1, closed_rim = 2 };

static double mass_of(double decades, random_stream *random)
{
    return pow(10, decades * (random_uniform(random) - 0.5));
}
/** A point near a sphere, evenly spread. */
static void place(int i, int n, double radius, random_stream *random, double *r)
{
    const double z = 1 - 2 * (i + 0.5) / n, s = sqrt(1 - z * z), turn = i * 2.399963;
    const double u[3] = {s * cos(turn), s * sin(turn), z};
    double shift[3];
    random_direction(random, shift);
    for (int c = 0; c < 3; ++c) r[c] = radius * u[c] + shift[c];
}
static network_scene make(sort of, uint64_t seed)
{
    network_scene s = network_scene_empty(0);
    random_stream random = random_seed(seed);
    double r[3] = {0, 0, 0};
    int64_t *end = malloc((size_t)of.rim * sizeof *end);
    for (int h = 0; h < of.hubs; ++h) {
        molecule_add_atom(&s.m, of.hub_mass, r);
        for (int c = 0; c < 3; ++c) r[c] = 6 * random_uniform(&random) - 3;
    }
    for (int i = 0; i < of.rim; ++i) {
        end[i] = 0;
        for (int k = 0; k < of.arm; ++k) {
            place(i, of.rim, 10 * (k + 1), &random, r);
            const int64_t next = molecule_add_atom(&s.m, mass_of(of.masses, &random), r);
            molecule_add_bond(&s.m, end[i], next);
            end[i] = next;
        }
        for (int h = 1; h < of.hubs; ++h) molecule_add_bond(&s.m, h, end[i]);
        if (of.bonds_of_rim && i > 0) molecule_add_bond(&s.m, end[i - 1], end[i]);
    }
    if (of.bonds_of_rim == closed_rim) molecule_add_bond(&s.m, end[of.rim - 1], end[0]);
    for (int i = 0; i < of.pendants; ++i) {
        place(i, of.rim, 10 * (of.arm + 1), &random, r);
        molecule_add_bond(&s.m, end[i % of.rim], molecule_add_atom(&s.m, mass_of(of.masses, &random), r));
    }
    free(end);
    molecule_finish(&s.m, &random);
    network_begin(&s);
    network_add(&s);
    return s;
}

/** A random tree with a quarter as many cycles, of at most four bonds at an atom, its masses over these decades. */
static network_scene tangle(int64_t n, double decades, uint64_t seed)
{
    network_scene s = network_scene_empty(0);
    random_stream random = random_seed(seed);
    int *degree = calloc((size_t)n + 1, sizeof *degree);
    double r[3] = {0, 0, 0}, step[3];
    molecule_add_atom(&s.m, mass_of(decades, &random), r);
    for (int64_t i = 1; i <= n; ++i) {
        int64_t j = (int64_t)((double)i * random_uniform(&random));
        while (degree[j] >= 4) j = (j + 1) % i;
        random_direction(&random, step);
        for (int c = 0; c < 3; ++c) r[c] = s.m.r[3 * j + c] + (0.7 + 0.6 * random_uniform(&random)) * step[c];
        molecule_add_atom(&s.m, mass_of(decades, &random), r);
        molecule_add_bond(&s.m, j, i);
        ++degree[i], ++degree[j];
    }
    for (int64_t k = 0; k < n / 4; ++k) {
        const int64_t i = (int64_t)((double)n * random_uniform(&random)),
                      j = i + 2 + (int64_t)(28 * random_uniform(&random));
        int known = j > n || degree[i] >= 4 || degree[j] >= 4;
        for (int64_t l = 0; !known && l < s.m.n_bonds; ++l) known = s.m.pairs[2 * l] == i && s.m.pairs[2 * l + 1] == j;
        if (known) continue;
        molecule_add_bond(&s.m, i, j);
        ++degree[i], ++degree[j];
    }
    free(degree);
    molecule_finish(&s.m, &random);
    network_begin(&s);
    network_add(&s);
    return s;
}

/** What is left of each bond's equation, beside its terms and the rounding of the multipliers; and no NaN. */
static void check_forces(const network_scene *s)
{
    double *lambda = untouched((size_t)s->m.n_bonds), *g = untouched(3 * (size_t)s->m.n_atoms), virial[9];
    CHECK(hol_forces(s->chains, s->m.r, s->m.v, s->m.f, lambda, NULL, g, HOL_WRITE, virial));
    for (int c = 0; c < 9; ++c) assert_true(isfinite(virial[c]));
    const long double own = sqrtl((long double)s->m.n_bonds) * long_double_rounding(); /* of these sums */
    long double *a = calloc(3 * (size_t)s->m.n_atoms, sizeof *a), *size = calloc((size_t)s->m.n_atoms, sizeof *size);
    for (int64_t k = 0; k < s->m.n_bonds; ++k)
        for (int e = 0; e < 2; ++e) {
            const int64_t i = s->m.pairs[2 * k + e], j = s->m.pairs[2 * k + 1 - e];
            size[i] += fabsl(2.0L * lambda[k] * s->m.length[k]) * s->m.inverse_mass[i];
            for (int c = 0; c < 3; ++c)
                a[3 * i + c] += 2.0L * lambda[k] * ((long double)s->m.r[3 * i + c] - s->m.r[3 * j + c]);
        }
    for (int64_t i = 0; i < s->m.n_atoms; ++i)
        for (int c = 0; c < 3; ++c) {
            CHECK_AT_MOST(fabsl(g[3 * i + c] * s->m.inverse_mass[i] + a[3 * i + c] * s->m.inverse_mass[i]),
                          16 * DBL_EPSILON * size[i]);
            a[3 * i + c] = s->m.inverse_mass[i] * (s->m.f[3 * i + c] - a[3 * i + c]);
            size[i] += fabsl(s->m.inverse_mass[i] * s->m.f[3 * i + c]);
        }
    for (int64_t k = 0; k < s->m.n_bonds; ++k) {
        const int64_t i = s->m.pairs[2 * k], j = s->m.pairs[2 * k + 1];
        long double sum = 0, terms = s->m.length[k] * (size[i] + size[j]);
        for (int c = 0; c < 3; ++c) {
            const long double d = (long double)s->m.r[3 * j + c] - s->m.r[3 * i + c],
                              dv = (long double)s->m.v[3 * j + c] - s->m.v[3 * i + c];
            sum += d * (a[3 * j + c] - a[3 * i + c]) + dv * dv;
            terms += dv * dv;
        }
        CHECK_AT_MOST(fabsl(sum), (4 * DBL_EPSILON + own) * terms);
    }
    free(lambda), free(g), free(a), free(size);
}
static void check_moves(const network_scene *s, double dt)
{
    double *v = copy_of(s->m.v, 3 * (size_t)s->m.n_atoms), *r;
    CHECK(hol_project_velocities(s->chains, s->m.r, v, NULL, NULL));
    for (int64_t k = 0; k < s->m.n_bonds; ++k) {
        const int64_t i = s->m.pairs[2 * k], j = s->m.pairs[2 * k + 1];
        long double rate = 0, size = 0;
        for (int c = 0; c < 3; ++c) {
            const long double d = (long double)s->m.r[3 * j + c] - s->m.r[3 * i + c];
            rate += d * ((long double)v[3 * j + c] - v[3 * i + c]);
            size += fabsl(d) * (fabs(v[3 * j + c]) + fabs(v[3 * i + c]));
        }
        CHECK_AT_MOST(fabsl(rate), 8 * DBL_EPSILON * size);
    }
    r = copy_of(s->m.r, 3 * (size_t)s->m.n_atoms);
    for (int64_t i = 0; i < 3 * s->m.n_atoms; ++i) r[i] += dt * v[i];
    CHECK(hol_project_positions(s->chains, s->m.r, r, NULL, dt, NULL, 0, NULL, NULL));
    CHECK_AT_MOST(network_worst_length(s, r), 64 * DBL_EPSILON * 50);
    free(v), free(r);
}

static void large_hubs_are_solved(void **state)
{
    (void)state;
    static const sort sorts[] = {
        {3113, 1, 1, closed_rim, 0, 1, 0}, /* its forces were HOL_OK with NaN, those of the next four refused */
        {2000, 1, 1, closed_rim, 0, 1, 0},
        {2500, 1, 1, open_rim, 0, 1, 0},
        {1800, 1, 1, closed_rim, 900, 1, 2},
        {1500, 1, 3, 0, 0, 1, 0},
        {800, 1, 2, open_rim, 0, 1, 0},
        {700, 2, 1, closed_rim, 0, 1e3, 0},
        {700, 3, 1, closed_rim, 0, 1e-3, 3},
        {20000, 1, 1, closed_rim, 0, 1e4, 0},
        {500, 3, 2, 0, 0, 1, 2},
        {4000, 1, 1, closed_rim, 0, 0, 1}};
    for (size_t i = 0; i < sizeof sorts / sizeof *sorts; ++i) {
        if (quick_run() && sorts[i].rim > 600) continue;
        network_scene s = make(sorts[i], 1 + i);
        check_forces(&s);
        check_moves(&s, 1e-4);
        network_free(s);
    }
}

static void compare(const network_scene *s)
{
    const molecule_problem p = network_problem(s);
    double *lambda = untouched((size_t)s->m.n_bonds);
    molecule_solution exact;
    assert_int_equal(molecule_forces(&p, &exact), 0);
    CHECK(hol_forces(s->chains, s->m.r, s->m.v, s->m.f, lambda, NULL, NULL, HOL_WRITE, NULL));
    for (int64_t k = 0; k < s->m.n_bonds; ++k)
        CHECK_AT_MOST(fabsl(lambda[k] - exact.lambda[k]), network_unit(s) * exact.lambda_scale[k]);
    molecule_solution_free(&exact);
    free(lambda);
    check_network_velocities(s);
}
static void all_levels_are_those_of_many_digits(void **state)
{
    (void)state;
    static const sort sorts[] = {{80, 1, 1, closed_rim, 0, 1, 0},    {80, 1, 2, closed_rim, 0, 1, 0},
                                 {70, 2, 1, closed_rim, 40, 1e3, 2}, {75, 2, 2, 0, 0, 1e-3, 6},
                                 {90, 1, 1, 0, 0, 1e-6, 8},          {90, 1, 1, 0, 0, 1, 14}};
    for (size_t i = 0; i < (quick_run() ? 1 : sizeof sorts / sizeof *sorts); ++i) {
        network_scene s = make(sorts[i], 100 + i);
        compare(&s);
        network_free(s);
    }
}

/** Two hubs and a closed rim have as many bonds as freedoms. */
static void networks_are_solved_whose_bonds_nearly_depend_on_each_other(void **state)
{
    (void)state;
    if (quick_run()) return;
    network_scene s = make((sort){100, 1, 2, closed_rim, 0, 1, 0}, 5);
    const molecule_problem p = network_problem(&s);
    molecule_metric exact;
    assert_int_equal(molecule_metric_make(&p, &exact), 0);
    assert_true(exact.condition > 1e8L);
    compare(&s);
    molecule_metric_free(&exact);
    network_free(s);
}

/** Arms that a hub's fixed neighbours hold, among many that give way. */
static void held_stars_are_those_of_many_digits(void **state)
{
    (void)state;
    for (int held = 1; held <= (quick_run() ? 1 : 3); ++held) {
        network_scene s = network_scene_empty(0);
        random_stream random = random_seed((uint64_t)held);
        double r[3] = {0, 0, 0};
        molecule_add_atom(&s.m, 1e-9, r);
        for (int i = 0; i < 90; ++i) {
            place(i, 90, 3, &random, r);
            const double mass = i % 30 == 7 && i / 30 < held ? 0 : mass_of(12, &random);
            const int64_t next = molecule_add_atom(&s.m, mass, r);
            molecule_add_bond(&s.m, 0, next);
            place(i, 90, 6, &random, r);
            if (i % 9 == 0) molecule_add_bond(&s.m, next, molecule_add_atom(&s.m, mass_of(12, &random), r));
        }
        molecule_finish(&s.m, &random);
        network_begin(&s);
        network_add(&s);
        compare(&s);
        network_free(s);
    }
}

/** The metric determinant and the Fixman force of a star. */
static void metrics_of_stars_are_those_of_many_digits(void **state)
{
    (void)state;
    network_scene s = make((sort){80, 2, 1, 0, 0, 1e-2, 2}, 7);
    const molecule_problem p = network_problem(&s);
    molecule_metric exact;
    double log_det, *force = untouched(3 * (size_t)s.m.n_atoms);
    assert_int_equal(molecule_metric_make(&p, &exact), 0);
    CHECK(hol_metric(s.chains, s.m.r, 1, &log_det, NULL, NULL, force, HOL_WRITE));
    CHECK_AT_MOST(fabsl(log_det - exact.log_det), 64 * network_unit(&s));
    for (int64_t i = 0; i < 3 * s.m.n_atoms; ++i)
        CHECK_AT_MOST(fabsl(force[i] - exact.fixman_force[i]), network_unit(&s) * exact.fixman_scale[i / 3]);
    molecule_metric_free(&exact);
    free(force);
    network_free(s);
}

/** Time and memory are linear; beside Sherman and Morrison's formula. */
static void a_star_of_many_arms_is_solved(void **state)
{
    (void)state;
    const int n = quick_run() ? 2000 : 100000;
    network_scene s = make((sort){n, 1, 1, 0, 0, 1e4, 0}, 3);
    check_forces(&s);
    check_moves(&s, 1e-4);
    CHECK(hol_chains_set_memory_limit(s.chains, (int64_t)1000 * n));
    double log_det;
    CHECK(hol_metric(s.chains, s.m.r, 1, &log_det, NULL, NULL, NULL, HOL_WRITE));
    /* ln det of diag(w) + w_0 E E^T, over its diagonal */
    long double m[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    const long double part = 1e-4L;
    for (int64_t k = 0; k < n; ++k) {
        long double d[3], square = 0;
        for (int c = 0; c < 3; ++c) d[c] = (long double)s.m.r[3 * (k + 1) + c] - s.m.r[c], square += d[c] * d[c];
        for (int a = 0; a < 3; ++a)
            for (int b = 0; b < 3; ++b) m[a][b] += part * d[a] * d[b] / square;
    }
    const long double det = m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
                            m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
                            m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
    const long double wanted = logl(det) - n * log1pl(part);
    CHECK_AT_MOST(fabsl(log_det - wanted), 1e-11L);
    network_free(s);
}

static void a_hub_in_cycles_has_no_metric_beyond_the_limit(void **state)
{
    (void)state;
    network_scene s = make((sort){4000, 1, 1, closed_rim, 0, 1, 0}, 4);
    double log_det = 12345;
    CHECK(hol_chains_set_memory_limit(s.chains, 100000000));
    CHECK_FAILS(HOL_ERR_MEMORY, hol_metric(s.chains, s.m.r, 1, &log_det, NULL, NULL, NULL, HOL_WRITE));
    assert_non_null(strstr(hol_error_message(), "bytes of memory"));
    assert_true(log_det == 12345);
    check_forces(&s);
    network_free(s);
}

static void light_atoms_between_heavy_ones_are_solved(void **state)
{
    (void)state;
    for (uint64_t seed = 0; seed < (quick_run() ? 1 : 8); ++seed) {
        network_scene s = tangle(seed % 2 || quick_run() ? 1000 : 2000, seed % 3 ? 8 : 6, seed);
        check_forces(&s);
        check_moves(&s, 1e-7);
        network_free(s);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(large_hubs_are_solved),
        cmocka_unit_test(all_levels_are_those_of_many_digits),
        cmocka_unit_test(networks_are_solved_whose_bonds_nearly_depend_on_each_other),
        cmocka_unit_test(held_stars_are_those_of_many_digits),
        cmocka_unit_test(metrics_of_stars_are_those_of_many_digits),
        cmocka_unit_test(a_star_of_many_arms_is_solved),
        cmocka_unit_test(a_hub_in_cycles_has_no_metric_beyond_the_limit),
        cmocka_unit_test(light_atoms_between_heavy_ones_are_solved),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
