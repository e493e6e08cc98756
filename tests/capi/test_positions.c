/** Position projection against Newton's method in 113 bits, and against what the step must conserve. */
#include "assembly.h"
#include "check.h"
#include "positions.h"
#include "solution.h"

static long double extent_of(const double *r, size_t n)
{
    long double largest = 0;
    for (size_t i = 0; i < n; ++i)
        if (fabs(r[i]) > largest) largest = fabs(r[i]);
    return largest;
}

/** One chain: lengths to the rounding of the coordinates, positions and multipliers as those of the exact solution. */
static void check_against_newton(const chain *one, double dt, long double close)
{
    assembly a = assembly_make(one, 1, IN_ORDER, 0);
    const int64_t n = one->n_bonds;
    double *start = drift(&a, dt, 1), *q = copy_of(start, assembly_size(&a)), *lambda = untouched((size_t)n);
    long double *exact_q = malloc(sizeof *exact_q * 3 * (size_t)(n + 1));
    const solution_problem p = {n, one->mass, NULL, one->r, NULL, NULL, NULL};
    solution exact;
    hol_report report;
    const int steps = solution_positions(&p, start, one->length, dt, exact_q, &exact);
    const int status = hol_project_positions(a.chains, a.r, q, NULL, dt, lambda, 0, NULL, &report);
    if (steps < 0) fail_msg("N = %lld: the problem has no solution", (long long)n);
    if (status != HOL_OK) fail_msg("N = %lld: %s", (long long)n, hol_error_message());
    const long double extent = extent_of(start, 3 * (size_t)(n + 1)) + dt;
    long double lambda_size = 0;
    for (int64_t k = 0; k < n; ++k) lambda_size = fmaxl(lambda_size, fabsl(exact.lambda[k]));
    for (int64_t k = 0; k < n; ++k) {
        long double square = 0;
        const long double length = one->length[k];
        for (int x = 0; x < 3; ++x) {
            const long double d = (long double)q[3 * k + 3 + x] - q[3 * k + x];
            square += d * d;
        }
        CHECK_AT_MOST(fabsl(square - length * length) / (length * length), rounding_of_a_bond(extent, length));
    }
    for (int64_t i = 0; i < 3 * (n + 1); ++i)
        CHECK_AT_MOST(fabsl(q[i] - exact_q[i]), close * DBL_EPSILON * (extent + 1));
    /* dt^2 w 2 lambda |b| moves an atom; an error of it is one of the positions */
    for (int64_t k = 0; k < n; ++k) {
        const long double w = 1 / (long double)(one->mass[k] > 0 ? one->mass[k] : one->mass[k + 1]);
        CHECK_AT_MOST(fabsl(lambda[k] - exact.lambda[k]) * dt * dt * w * 2 * one->length[k],
                      4 * close * DBL_EPSILON * (extent + 1));
    }
    solution_free(&exact);
    free(start), free(q), free(lambda), free(exact_q);
    assembly_free(&a);
}

static void positions_agree_with_newton_in_113_bits(void **state)
{
    (void)state;
    static const struct {
        chain_kind kind;
        double dt;
        long double close; /* how many roundings of the coordinates the geometry may make out of one */
    } problems[] = {
        {CHAIN_COIL, 0.005, 20},        {CHAIN_COIL, 0.02, 20},        {CHAIN_HETEROGENEOUS, 0.005, 40},
        {CHAIN_LATTICE, 0.02, 20},      {CHAIN_MASSES_1E3, 0.005, 40}, {CHAIN_MASSES_1E6, 0.005, 40},
        {CHAIN_FIXED_ENDS, 0.005, 100},
    };
    for (size_t i = 0; i < sizeof problems / sizeof *problems; ++i) {
        print_message("%s, dt = %g\n", chain_kind_name(problems[i].kind), problems[i].dt);
        for (int64_t n = problems[i].kind == CHAIN_FIXED_ENDS ? 3 : 1; n <= 60; n += quick_run() ? 11 : 1)
            for (uint64_t seed = 0; seed < 3; ++seed) {
                chain one = chain_make(problems[i].kind, n, seed);
                check_against_newton(&one, problems[i].dt, problems[i].close);
                chain_free(&one);
            }
    }
}

static void long_chains_agree_with_newton_in_113_bits(void **state)
{
    (void)state;
    static const int64_t lengths[] = {100, 800, 1030, 3001, 500, 1000, 1001, 1024, 2049, 4096, 20000};
    static const chain_kind kinds[] = {CHAIN_HETEROGENEOUS, CHAIN_LATTICE, CHAIN_MASSES_1E6, CHAIN_FIXED_ENDS};
    for (int i = 0; i < (quick_run() ? 4 : 11); ++i) {
        chain one = chain_make(CHAIN_COIL, lengths[i], 4);
        check_against_newton(&one, 0.005, 20);
        chain_free(&one);
    }
    for (int i = 0; i < 4; ++i) {
        chain one = chain_make(kinds[i], 2500, 5);
        check_against_newton(&one, 0.005, 100);
        chain_free(&one);
    }
}

static void every_chain_of_a_mixed_set_ends_on_its_lengths(void **state)
{
    (void)state;
    for (int threads = 1; threads <= 3; ++threads) {
        assembly a = assembly_of_kind(CHAIN_HETEROGENEOUS, 120, 1, 90, SCATTERED, 81);
        double *q = drift(&a, 0.004, 0);
        hol_report report;
        CHECK(hol_chains_set_threads(a.chains, threads));
        CHECK(hol_project_positions(a.chains, a.r, q, NULL, 0.004, NULL, 0, NULL, &report));
        assert_int_equal(report.n_corrected, 120);
        assert_int_equal(report.n_failed, 0);
        assert_true(report.iterations >= 2 && report.iterations <= 6);
        hol_worst worst;
        CHECK(hol_violation(a.chains, q, NULL, &worst));
        CHECK_AT_MOST(worst.length, rounding_of_a_bond(40, 0.7L)); /* walks of 90 steps end within 40 */
        free(q);
        assembly_free(&a);
    }
}

/** Beside others that move they have no multiplier, and keep every bit. */
static void short_chains_that_are_right_stay_as_they_came(void **state)
{
    (void)state;
    enum { n_chains = 101, n_right = 34 };
    for (int64_t n = 1; n <= 3; ++n)
        for (int reports = 0; reports < 2; ++reports) {
            assembly a = assembly_of_kind(CHAIN_COIL, n_chains, n, n, IN_ORDER, 83);
            const size_t size = assembly_size(&a), of_chain = 3 * (size_t)(n + 1);
            double *q = drift(&a, 0.004, 0), *v = copy_of(a.v, size), *lambda = untouched((size_t)a.n_bonds);
            for (size_t c = 0; c < n_chains; c += 3) memcpy(q + c * of_chain, a.r + c * of_chain, of_chain * sizeof *q);
            hol_report report;
            CHECK(hol_project_positions(a.chains, a.r, q, v, 0.004, lambda, 0, NULL, reports ? &report : NULL));
            if (reports) assert_int_equal(report.n_corrected, n_chains - n_right);
            for (size_t c = 0; c < n_chains; ++c) {
                const int right = c % 3 == 0;
                assert_true(right == !memcmp(v + c * of_chain, a.v + c * of_chain, of_chain * sizeof *v));
                if (right) assert_same_bits(q + c * of_chain, a.r + c * of_chain, of_chain);
                for (size_t k = 0; k < (size_t)n; ++k) assert_true(right == (lambda[c * (size_t)n + k] == 0));
            }
            hol_worst worst;
            CHECK(hol_violation(a.chains, q, NULL, &worst));
            CHECK_AT_MOST(worst.length, rounding_of_a_bond(extent_of(q, size), 0.7L));
            free(q), free(v), free(lambda);
            assembly_free(&a);
        }
}

static void check_velocities(int is_long)
{
    const double dt = 0.004;
    assembly a = short_or_long(CHAIN_HETEROGENEOUS, is_long, IN_ORDER, 82);
    double *start = drift(&a, dt, 0), *q = copy_of(start, assembly_size(&a)), *v = copy_of(a.v, assembly_size(&a));
    double *without = copy_of(start, assembly_size(&a));
    CHECK(hol_project_positions(a.chains, a.r, q, v, dt, NULL, 0, NULL, NULL));
    CHECK(hol_project_positions(a.chains, a.r, without, NULL, dt, NULL, 0, NULL, NULL));
    assert_same_bits(q, without, assembly_size(&a));
    for (size_t i = 0; i < assembly_size(&a); ++i) {
        const long double moved = ((long double)q[i] - start[i]) / dt,
                          bound = DBL_EPSILON * (fabs(q[i]) / dt + fabs(v[i]) + fabs(a.v[i]) + 4 * fabsl(moved));
        CHECK_AT_MOST(fabsl((long double)v[i] - a.v[i] - moved), bound);
    }
    free(start), free(q), free(v), free(without);
    assembly_free(&a);
}

static void velocities_take_the_displacement_over_the_time_step(void **state)
{
    (void)state;
    for (int is_long = 0; is_long < 2; ++is_long) check_velocities(is_long);
}

static void check_momenta(int is_long)
{
    const double dt = 0.004;
    assembly a = short_or_long(CHAIN_HETEROGENEOUS, is_long, SCATTERED, 83);
    double *start = drift(&a, dt, 0), *q = copy_of(start, assembly_size(&a));
    CHECK(hol_project_positions(a.chains, a.r, q, NULL, dt, NULL, 0, NULL, NULL));
    for (int64_t c = 0; c < a.n_chains; ++c) {
        long double p[3] = {0}, l[3] = {0}, size = 0, reach = 0;
        for (int64_t i = 0; i <= assembly_bonds(&a, c); ++i) {
            const int64_t atom = a.atoms[a.first[c] + i];
            long double move[3];
            for (int x = 0; x < 3; ++x) {
                move[x] = a.mass[atom] * ((long double)q[3 * atom + x] - start[3 * atom + x]);
                p[x] += move[x];
                reach = fmaxl(reach, fabs(q[3 * atom + x]));
            }
            size += a.mass[atom];
            for (int x = 0; x < 3; ++x)
                l[x] +=
                    a.r[3 * atom + (x + 1) % 3] * move[(x + 2) % 3] - a.r[3 * atom + (x + 2) % 3] * move[(x + 1) % 3];
        }
        /* each coordinate is rounded once, by half an eps of it, and moves there by a sum of two terms; the force is
           along the bonds of the reference positions, so that its torque vanishes about those */
        for (int x = 0; x < 3; ++x) {
            CHECK_AT_MOST(fabsl(p[x]), DBL_EPSILON * size * (reach + 1));
            CHECK_AT_MOST(fabsl(l[x]), 2 * DBL_EPSILON * size * (reach + 1) * (reach + 1));
        }
    }
    free(start), free(q);
    assembly_free(&a);
}

static void corrections_conserve_momentum_and_angular_momentum(void **state)
{
    (void)state;
    for (int is_long = 0; is_long < 2; ++is_long) check_momenta(is_long);
}

static void check_virial(int is_long)
{
    const double dt = 0.004;
    assembly a = short_or_long(CHAIN_HETEROGENEOUS, is_long, SCATTERED, 84);
    double *q = drift(&a, dt, 0), *lambda = untouched((size_t)a.n_bonds), virial[9];
    long double sum[9] = {0}, size = 0;
    CHECK(hol_project_positions(a.chains, a.r, q, NULL, dt, lambda, 0, virial, NULL));
    for (int64_t c = 0; c < a.n_chains; ++c)
        for (int64_t k = 0; k < assembly_bonds(&a, c); ++k) {
            const double *p = a.r + 3 * a.atoms[a.first[c] + k], *r = a.r + 3 * a.atoms[a.first[c] + k + 1];
            for (int x = 0; x < 9; ++x) {
                const long double t = 2 * lambda[a.first_bond[c] + k] * ((long double)r[x / 3] - p[x / 3]) *
                                      ((long double)r[x % 3] - p[x % 3]);
                sum[x] -= t;
                size += fabsl(t);
            }
        }
    for (int x = 0; x < 9; ++x) CHECK_AT_MOST(fabsl(virial[x] - sum[x]), 16 * DBL_EPSILON * size);
    free(q), free(lambda);
    assembly_free(&a);
}

static void virial_is_the_sum_over_the_reference_bonds(void **state)
{
    (void)state;
    for (int is_long = 0; is_long < 2; ++is_long) check_virial(is_long);
}

/** Largest difference between lambda of the position level times `factor` and of the acceleration level. */
static double multiplier_difference(const chain *one, double dt, int leap_frog)
{
    assembly a = assembly_make(one, 1, IN_ORDER, 0);
    const size_t size = assembly_size(&a), n = (size_t)one->n_bonds;
    double *q = copy_of(a.r, size), *before = copy_of(a.r, size), *g = untouched(size), *exact = untouched(n),
           *lambda = untouched(n);
    CHECK(hol_project_velocities(a.chains, a.r, a.v, NULL, NULL));
    CHECK(hol_forces(a.chains, a.r, a.v, a.f, exact, NULL, g, HOL_WRITE, NULL));
    for (size_t i = 0; i < size; ++i) {
        const double m = a.mass[i / 3];
        before[i] = a.r[i] - dt * a.v[i] + dt * dt / 2 * (a.f[i] + g[i]) / m;
        q[i] = a.r[i] + dt * a.v[i] + dt * dt / 2 * a.f[i] / m;
    }
    if (leap_frog) { /* Stoermer-Verlet: 2 r - r_before + dt^2 w f, with r_before on the constraints */
        CHECK(hol_project_positions(a.chains, a.r, before, NULL, dt, NULL, 0, NULL, NULL));
        for (size_t i = 0; i < size; ++i) q[i] = 2 * a.r[i] - before[i] + dt * dt * a.f[i] / a.mass[i / 3];
    }
    CHECK(hol_project_positions(a.chains, a.r, q, NULL, dt, lambda, 0, NULL, NULL));
    double worst = 0;
    for (size_t k = 0; k < n; ++k) worst = fmax(worst, fabs((leap_frog ? 1 : 2) * lambda[k] - exact[k]));
    free(q), free(before), free(g), free(exact), free(lambda);
    assembly_free(&a);
    return worst;
}

static void multipliers_tend_to_those_of_the_acceleration_level(void **state)
{
    (void)state;
    for (int64_t n = 1; n <= 30; n += 7) {
        chain one = chain_make(CHAIN_COIL, n, 12);
        for (int leap_frog = 0; leap_frog < 2; ++leap_frog) {
            const double coarse = multiplier_difference(&one, 4e-4, leap_frog),
                         fine = multiplier_difference(&one, 2e-4, leap_frog);
            /* velocity Verlet, half of the force: first order; leap-frog, the force: second order */
            CHECK_AT_MOST(fine, coarse / (leap_frog ? 3.2 : 1.7));
            CHECK_AT_MOST(fine, leap_frog ? 0.05 : 1.0);
        }
        chain_free(&one);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(positions_agree_with_newton_in_113_bits),
        cmocka_unit_test(long_chains_agree_with_newton_in_113_bits),
        cmocka_unit_test(every_chain_of_a_mixed_set_ends_on_its_lengths),
        cmocka_unit_test(short_chains_that_are_right_stay_as_they_came),
        cmocka_unit_test(velocities_take_the_displacement_over_the_time_step),
        cmocka_unit_test(corrections_conserve_momentum_and_angular_momentum),
        cmocka_unit_test(virial_is_the_sum_over_the_reference_bonds),
        cmocka_unit_test(multipliers_tend_to_those_of_the_acceleration_level),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
