/**
 * Gels: strands between nodes, in a periodic box whose cycles go round it, of random topology, so large that no
 * elimination of their cycles is stored. Small ones beside solutions in 448 bits, large ones by what multipliers leave
 * of the equations.
 */
#include <stdlib.h>
#include <string.h>

#include "input.h"
#include "large.h"
#include "network_scene.h"
#include "random.h"

typedef struct {
    int64_t nodes, shortest, longest; /**< strands */
    double masses;                    /**< decades */
    int trees, fixed;                 /**< tails and side atoms; every seventh node is held fixed */
    double curl;                      /**< 1: coils; little: nearly straight strands */
} sort;

static double mass_of(const sort *of, random_stream *random)
{
    return pow(10, of->masses * (random_uniform(random) - 0.5));
}
static void add_strand(network_scene *s, const sort *of, int64_t from, int64_t to, random_stream *random)
{
    double gap[3], step[3], sum[3] = {0, 0, 0}, r[3];
    const double distance = sqrt(network_nearest(s, s->m.r, from, to, gap));
    int64_t n = of->shortest + (int64_t)((double)(of->longest - of->shortest + 1) * random_uniform(random));
    if ((double)n * 0.3 * s->side < distance) n = 1 + (int64_t)(distance / (0.3 * s->side));
    double *walk = malloc(3 * (size_t)n * sizeof *walk);
    for (int64_t k = 0; k < n; ++k) {
        random_direction(random, step);
        for (int c = 0; c < 3; ++c) sum[c] += walk[3 * k + c] = of->curl * step[c];
    }
    int64_t last = from;
    memcpy(r, s->m.r + 3 * from, sizeof r);
    for (int64_t k = 0; k < n; ++k) {
        for (int c = 0; c < 3; ++c) r[c] += walk[3 * k + c] + (gap[c] - sum[c]) / (double)n;
        const int64_t next = k + 1 < n ? molecule_add_atom(&s->m, mass_of(of, random), r) : to;
        molecule_add_bond(&s->m, last, next);
        last = next;
        int64_t tail = next;
        for (int64_t t = 0; t < 3 && k + 1 < n && of->trees && k % 11 == 5; ++t) {
            random_direction(random, step);
            tail = molecule_grow(&s->m, tail, mass_of(of, random), 1, step);
        }
    }
    free(walk);
}

static network_scene make(sort of, uint64_t seed)
{
    network_scene s = network_scene_empty(cbrt((double)of.nodes) * 2.5);
    random_stream random = random_seed(seed);
    int64_t *stub = malloc(4 * (size_t)of.nodes * sizeof *stub);
    for (int64_t i = 0; i < of.nodes; ++i) {
        double r[3];
        for (int c = 0; c < 3; ++c) r[c] = s.side * random_uniform(&random);
        molecule_add_atom(&s.m, of.fixed && i % 7 == 3 ? 0 : mass_of(&of, &random), r);
        for (int e = 0; e < 4; ++e) stub[4 * i + e] = i;
    }
    for (int64_t i = 4 * of.nodes - 1; i > 0; --i) {
        const int64_t j = (int64_t)((double)(i + 1) * random_uniform(&random)), kept = stub[i];
        stub[i] = stub[j], stub[j] = kept;
    }
    for (int64_t k = 0; k < 2 * of.nodes; ++k)
        if (stub[2 * k] != stub[2 * k + 1]) add_strand(&s, &of, stub[2 * k], stub[2 * k + 1], &random);
    for (int64_t i = 0; i < of.nodes && of.trees; i += 3)
        for (int e = 0; e < 2; ++e) {
            double u[3];
            random_direction(&random, u);
            molecule_grow(&s.m, i, mass_of(&of, &random), 1, u);
        }
    molecule_finish(&s.m, &random);
    network_begin(&s);
    network_add(&s);
    free(stub);
    return s;
}
static const sort sorts[] = {
    {36, 5, 5, 0, 0, 0, 1}, {36, 4, 6, 0, 0, 0, 1},    {34, 5, 7, 0, 1, 0, 1},
    {48, 4, 5, 4, 1, 1, 1}, {46, 4, 5, 0, 0, 1, 0.02},
};
enum { n_sorts = sizeof sorts / sizeof *sorts };

/** So large that the order of its elimination is made for the metric alone. The first test: none before has asked for
 * as much memory. */
static void metric_force_of_a_large_gel_is_what_its_energy_falls_by(void **state)
{
    (void)state;
    if (quick_run()) return; /* only a large one has such an order */
    const double h = 1e-5;
    network_scene s = make((sort){64, 66, 66, 0, 0, 0, 1}, 4);
    const size_t size = 3 * (size_t)s.m.n_atoms;
    double *force = untouched(size), energy[2], work = 0, whole = 0;
    assert_true(s.m.n_bonds > 8192);
    CHECK(hol_metric(s.chains, s.m.r, 1, NULL, NULL, NULL, force, HOL_WRITE));
    for (int side = 0; side < 2; ++side) {
        double *moved = copy_of(s.m.r, size);
        for (size_t i = 0; i < size; ++i) moved[i] += (side == 0 ? -h : h) * s.m.v[i];
        CHECK(hol_metric(s.chains, moved, 1, NULL, NULL, &energy[side], NULL, HOL_WRITE));
        free(moved);
    }
    for (size_t i = 0; i < size; ++i) work += force[i] * s.m.v[i], whole += fabs(force[i] * s.m.v[i]);
    CHECK_AT_MOST(fabs(work + (energy[1] - energy[0]) / (2 * h)), 1e-6 * whole);
    free(force);
    network_free(s);
}

/** What a call has found. */
typedef struct {
    double *lambda, *tension, *g, virial[9];
} found;

static found nothing_found(const network_scene *s)
{
    return (found){
        untouched((size_t)s->m.n_bonds), untouched((size_t)s->m.n_bonds), untouched(3 * (size_t)s->m.n_atoms), {0}};
}
static void check_found(const network_scene *s, const molecule_solution *exact, found is)
{
    const long double unit = network_unit(s);
    for (int64_t k = 0; k < s->m.n_bonds; ++k) {
        CHECK_AT_MOST(fabsl(is.lambda[k] - exact->lambda[k]), unit * exact->lambda_scale[k]);
        CHECK_AT_MOST(fabsl(is.tension[k] - exact->tension[k]), unit * 2 * s->m.length[k] * exact->lambda_scale[k]);
    }
    for (int64_t i = 0; i < 3 * s->m.n_atoms; ++i)
        CHECK_AT_MOST(fabsl(is.g[i] - exact->g[i]), unit * exact->g_scale[i / 3]);
    for (int a = 0; a < 9; ++a) CHECK_AT_MOST(fabsl(is.virial[a] - exact->virial[a]), unit * exact->virial_scale);
    free(is.lambda), free(is.tension), free(is.g);
}

/** By one call, and by factors that are kept. */
static void forces_are_those_of_many_digits(void **state)
{
    (void)state;
    for (int which = 0; which < (quick_run() ? 1 : n_sorts); ++which) {
        network_scene s = make(sorts[which], 1 + (uint64_t)which);
        const molecule_problem p = network_problem(&s);
        molecule_solution exact;
        const size_t n = (size_t)s.m.n_bonds;
        double *rhs = untouched(2 * n), *solved = untouched(2 * n), *kept = untouched(2 * n);
        found once = nothing_found(&s), by_factors = nothing_found(&s);
        hol_factors *factors;
        CHECK(hol_factors_create(s.chains, &factors));
        CHECK(hol_factors_update(factors, s.m.r));
        assert_int_equal(molecule_forces(&p, &exact), 0);
        CHECK(hol_forces(s.chains, s.m.r, s.m.v, s.m.f, once.lambda, once.tension, once.g, HOL_WRITE, once.virial));
        check_found(&s, &exact, once);
        CHECK(hol_factors_forces(factors, s.m.v, s.m.f, by_factors.lambda, by_factors.tension, by_factors.g, HOL_WRITE,
                                 by_factors.virial));
        check_found(&s, &exact, by_factors);
        molecule_solution_free(&exact);
        random_stream random = random_seed(4);
        for (size_t k = 0; k < n; ++k) rhs[k] = k % 50 == 7 ? 1 : 0, rhs[n + k] = random_normal(&random);
        CHECK(hol_solve(s.chains, s.m.r, rhs, solved, NULL, HOL_WRITE, NULL));
        CHECK(hol_solve(s.chains, s.m.r, rhs + n, solved + n, NULL, HOL_WRITE, NULL));
        CHECK(hol_factors_solve(factors, 2, rhs, kept, NULL, HOL_WRITE, NULL));
        for (size_t first = 0; first < 2 * n; first += n) {
            assert_int_equal(molecule_solve(&p, rhs + first, &exact), 0);
            for (size_t k = 0; k < n; ++k) {
                const long double may_be_wrong = network_unit(&s) * exact.lambda_scale[k];
                CHECK_AT_MOST(fabsl(solved[first + k] - exact.lambda[k]), may_be_wrong);
                CHECK_AT_MOST(fabsl(kept[first + k] - exact.lambda[k]), may_be_wrong);
            }
            molecule_solution_free(&exact);
        }
        hol_factors_destroy(factors);
        free(rhs), free(solved), free(kept);
        network_free(s);
    }
}

static void velocities_are_those_of_many_digits(void **state)
{
    (void)state;
    for (int which = 0; which < (quick_run() ? 1 : n_sorts); ++which) {
        network_scene s = make(sorts[which], 1 + (uint64_t)which);
        check_network_velocities(&s);
        network_free(s);
    }
}

/** Nothing hangs loose from its cycle, and there is no other one. */
static void a_ring_with_tethers_to_fixed_atoms_is_a_network(void **state)
{
    (void)state;
    network_scene s = network_scene_empty(0);
    random_stream random = random_seed(5);
    const int64_t n = quick_run() ? 256 : 400;
    for (int64_t i = 0; i < n; ++i) {
        const double angle = 2 * acos(-1.0) * (double)i / (double)n, radius = (double)n / 6;
        molecule_add_atom(&s.m, 1 + random_uniform(&random),
                          (const double[]){radius * cos(angle), radius * sin(angle), 0.5 * sin(1.7 * (double)i)});
    }
    for (int64_t i = 0; i < n; ++i) molecule_add_bond(&s.m, i, (i + 1) % n);
    for (int64_t i = 0; i < n; i += 4) {
        double u[3], r[3];
        random_direction(&random, u);
        for (int c = 0; c < 3; ++c) r[c] = s.m.r[3 * i + c] + u[c];
        molecule_add_atom(&s.m, 0, r);
        molecule_add_bond(&s.m, i, s.m.n_atoms - 1);
    }
    molecule_finish(&s.m, &random);
    network_begin(&s);
    network_add(&s);
    check_network_velocities(&s);
    network_free(s);
}

static void positions_get_their_lengths(void **state)
{
    (void)state;
    for (int which = 0; which < (quick_run() ? 1 : n_sorts); ++which) {
        network_scene s = make(sorts[which], 1 + (uint64_t)which);
        const size_t size = 3 * (size_t)s.m.n_atoms;
        CHECK(hol_project_velocities(s.chains, s.m.r, s.m.v, NULL, NULL));
        const double dt = sorts[which].masses > 0 || sorts[which].curl < 1 ? 1e-5 : 0.01;
        double *start = molecule_drifted(&s.m, dt), *r = copy_of(start, size), *v = copy_of(s.m.v, size);
        double *lambda = untouched((size_t)s.m.n_bonds), shortest = HUGE_VAL;
        molecule_solution exact;
        const molecule_problem p = network_problem(&s);
        hol_report report;
        assert_int_equal(molecule_positions(&p, start, s.box, s.m.length, dt, &exact), 0);
        CHECK(hol_project_positions(s.chains, s.m.r, r, v, dt, lambda, 0, NULL, &report));
        assert_true(report.n_corrected > 0 && report.iterations < 12);
        for (size_t i = 0; i < size; ++i)
            CHECK_AT_MOST(fabsl(r[i] - exact.moved[i]), network_unit(&s) * exact.moved_scale[i / 3]);
        for (int64_t k = 0; k < s.m.n_bonds; ++k) shortest = fmin(shortest, s.m.length[k]);
        CHECK_AT_MOST(network_worst_length(&s, r), 16 * DBL_EPSILON * (1 + 2 * s.side / shortest));
        for (size_t i = 0; i < size; ++i)
            CHECK_AT_MOST(fabs(s.m.v[i] + (r[i] - start[i]) / dt - v[i]),
                          8 * DBL_EPSILON * (fabs(v[i]) + fabs(s.m.v[i]) + (fabs(r[i]) + fabs(start[i])) / dt));
        /* Once more, with these as a guess: nothing but roundings can have changed. Forces have used the memory
         * meanwhile, and a refused call has left no numbers there. */
        double *other = copy_of(start, size), *forces = untouched(size), *none = copy_of(start, size);
        CHECK(hol_forces(s.chains, s.m.r, s.m.v, s.m.f, NULL, NULL, forces, HOL_WRITE, NULL));
        none[7] = (double)NAN;
        assert_int_not_equal(hol_project_positions(s.chains, s.m.r, none, NULL, dt, lambda, 1, NULL, NULL), HOL_OK);
        CHECK(hol_project_positions(s.chains, s.m.r, other, NULL, dt, lambda, 1, NULL, &report));
        assert_true(report.iterations <= 1);
        free(forces), free(none);
        CHECK_AT_MOST(network_worst_length(&s, other), 16 * DBL_EPSILON * (1 + 2 * s.side / shortest));
        molecule_solution_free(&exact);
        free(start), free(r), free(v), free(lambda), free(other);
        network_free(s);
    }
}

static void threads_and_layouts_change_no_bit(void **state)
{
    (void)state;
    const sort of = {quick_run() ? 540 : 700, 4, 12, 0, 1, 0, 1}; /* so many bonds that threads share them */
    network_scene s = make(of, 3);
    const size_t size = 3 * (size_t)s.m.n_atoms, n = (size_t)s.m.n_bonds;
    double *g = untouched(size), *lambda = untouched(n), *v = copy_of(s.m.v, size), *r = molecule_drifted(&s.m, 0.005);
    double *h = untouched(size), *mu = untouched(n), *w = copy_of(s.m.v, size), *q = copy_of(r, size);
    double *kept[2] = {untouched(n), untouched(n)}, *kept_g[2] = {untouched(size), untouched(size)};
    hol_factors *factors;
    CHECK(hol_factors_create(s.chains, &factors));
    for (int threads = 1; threads <= 3; threads += 2) {
        CHECK(hol_chains_set_threads(s.chains, threads));
        CHECK(hol_factors_update(factors, s.m.r));
        CHECK(hol_factors_forces(factors, s.m.v, s.m.f, kept[threads / 2], NULL, kept_g[threads / 2], HOL_WRITE, NULL));
    }
    hol_factors_destroy(factors);
    assert_same_bits(kept[0], kept[1], n);
    assert_same_bits(kept_g[0], kept_g[1], size);
    for (int i = 0; i < 2; ++i) free(kept[i]), free(kept_g[i]);
    CHECK(hol_chains_set_threads(s.chains, 1));
    CHECK(hol_forces(s.chains, s.m.r, s.m.v, s.m.f, lambda, NULL, g, HOL_WRITE, NULL));
    CHECK(hol_project_velocities(s.chains, s.m.r, v, NULL, NULL));
    CHECK(hol_project_positions(s.chains, s.m.r, r, NULL, 0.005, NULL, 0, NULL, NULL));
    CHECK(hol_chains_set_threads(s.chains, 3));
    CHECK(hol_forces(s.chains, s.m.r, s.m.v, s.m.f, mu, NULL, h, HOL_WRITE, NULL));
    CHECK(hol_project_velocities(s.chains, s.m.r, w, NULL, NULL));
    assert_same_bits(lambda, mu, n);
    assert_same_bits(g, h, size);
    assert_same_bits(v, w, size);
    double *components = untouched(size);
    for (size_t i = 0; i < size; ++i) components[i % 3 * (size / 3) + i / 3] = q[i];
    const hol_view ref = {s.m.r, s.m.r + 1, s.m.r + 2, 3 * sizeof(double), HOL_DOUBLE, 0},
                   now = {components, components + size / 3, components + 2 * (size / 3), sizeof(double), HOL_DOUBLE,
                          0};
    CHECK(hol_project_positions_view(s.chains, INPUT(&ref), &now, NULL, 0.005, NULL, 0, NULL, NULL));
    for (size_t i = 0; i < size; ++i) assert_same_bits(components + i % 3 * (size / 3) + i / 3, r + i, 1);
    free(g), free(lambda), free(v), free(r), free(h), free(mu), free(w), free(q), free(components);
    network_free(s);
}

static void bad_data_leave_everything_untouched(void **state)
{
    (void)state;
    const sort gel = {70, 4, 6, 0, 1, 0, 1}, straight = {70, 8, 8, 0, 0, 0, 0.01};
    for (int which = 0; which < (quick_run() ? 1 : 2); ++which) {
        network_scene s = make(which == 0 ? gel : straight, 3);
        check_bad_data_change_nothing(&s.m, s.chains, quick_run() ? 1 : 2);
        network_free(s);
    }
}

/** Of the equations of forces. */
static void check_rounding_left(const molecule *m, const double *lambda, const double *g)
{
    double *tension = calloc((size_t)m->n_atoms, sizeof *tension); /* the rounding of lambda is felt as that of these */
    for (int64_t k = 0; k < m->n_bonds; ++k)
        for (int e = 0; e < 2; ++e) tension[m->pairs[2 * k + e]] += fabs(2 * lambda[k] * m->length[k]);
    for (int64_t k = 0; k < m->n_bonds; ++k) {
        const int64_t i = m->pairs[2 * k], j = m->pairs[2 * k + 1];
        long double sum = 0, size = m->length[k] * (tension[i] + tension[j]);
        for (int c = 0; c < 3; ++c) {
            const long double d = (long double)m->r[3 * j + c] - m->r[3 * i + c],
                              dv = m->v[3 * j + c] - m->v[3 * i + c];
            const long double a = (long double)m->f[3 * j + c] + g[3 * j + c] - m->f[3 * i + c] - g[3 * i + c];
            sum += d * a + dv * dv;
            size += fabsl(d) *
                        (fabsl(m->f[3 * j + c]) + fabsl(g[3 * j + c]) + fabsl(m->f[3 * i + c]) + fabsl(g[3 * i + c])) +
                    dv * dv;
        }
        CHECK_AT_MOST(fabsl(sum), 4 * DBL_EPSILON * size);
    }
    free(tension);
}

/** A cubic lattice without a fifth of its bonds, whose elimination would fill gigabytes. */
static void what_a_lattice_leaves_of_its_equations_is_rounding(void **state)
{
    (void)state;
    const int64_t n = quick_run() ? 8 : 10;
    molecule m = molecule_empty();
    random_stream random = random_seed(9);
    for (int64_t i = 0; i < n * n * n; ++i) {
        double r[3] = {(double)(i % n), (double)(i / n % n), (double)(i / (n * n))};
        for (int c = 0; c < 3; ++c) r[c] += 0.2 * (random_uniform(&random) - 0.5);
        molecule_add_atom(&m, 1, r);
    }
    for (int64_t i = 0; i < n * n * n; ++i) {
        const int64_t at[3] = {i % n, i / n % n, i / (n * n)}, step[3] = {1, n, n * n};
        for (int c = 0; c < 3; ++c)
            if (at[c] + 1 < n && random_uniform(&random) > 0.2) molecule_add_bond(&m, i, i + step[c]);
    }
    molecule_finish(&m, &random);
    hol_chains *chains = NULL;
    double *lambda = untouched((size_t)m.n_bonds), *g = untouched(3 * (size_t)m.n_atoms);
    CHECK(hol_chains_create(m.n_atoms, m.mass, &chains));
    CHECK(hol_chains_set_memory_limit(chains, 1000 * m.n_bonds));
    CHECK(hol_chains_add_bonds(chains, m.n_bonds, m.pairs, m.length));
    CHECK(hol_forces(chains, m.r, m.v, m.f, lambda, NULL, g, HOL_WRITE, NULL));
    check_rounding_left(&m, lambda, g);
    hol_factors *factors;
    CHECK(hol_factors_create(chains, &factors));
    CHECK(hol_factors_update(factors, m.r));
    CHECK(hol_factors_forces(factors, m.v, m.f, lambda, NULL, g, HOL_WRITE, NULL));
    check_rounding_left(&m, lambda, g);
    hol_factors_destroy(factors);
    CHECK_FAILS(HOL_ERR_MEMORY, hol_metric(chains, m.r, 1, NULL, NULL, g, NULL, HOL_WRITE));
    assert_message_names("metric of a network");
    free(lambda), free(g);
    hol_chains_destroy(chains);
    molecule_free(&m);
}

/** Rounds of the iteration, of all levels, where outcomes are kept. Nearly straight strands take more. */
static void rounds_are_told(void **state)
{
    (void)state;
    int rounds[2];
    for (int straight = 0; straight < 2; ++straight) {
        network_scene s = make(sorts[straight ? n_sorts - 1 : 0], 5);
        int status[1], iterations[1];
        CHECK(hol_chains_set_outcomes(s.chains, 1));
        CHECK(hol_forces(s.chains, s.m.r, s.m.v, s.m.f, NULL, NULL, s.m.f, HOL_ADD, NULL));
        CHECK(hol_outcomes(s.chains, status, iterations));
        assert_int_equal(status[0], HOL_OK);
        rounds[straight] = iterations[0];
        CHECK(hol_project_velocities(s.chains, s.m.r, s.m.v, NULL, NULL));
        CHECK(hol_outcomes(s.chains, status, iterations));
        assert_in_range(iterations[0], 1, 2000);
        network_free(s);
    }
    assert_in_range(rounds[0], 1, 40);
    assert_in_range(rounds[1], rounds[0] + 1, 2000);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(metric_force_of_a_large_gel_is_what_its_energy_falls_by),
        cmocka_unit_test(rounds_are_told),
        cmocka_unit_test(forces_are_those_of_many_digits),
        cmocka_unit_test(velocities_are_those_of_many_digits),
        cmocka_unit_test(a_ring_with_tethers_to_fixed_atoms_is_a_network),
        cmocka_unit_test(positions_get_their_lengths),
        cmocka_unit_test(threads_and_layouts_change_no_bit),
        cmocka_unit_test(bad_data_leave_everything_untouched),
        cmocka_unit_test(what_a_lattice_leaves_of_its_equations_is_rounding),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
