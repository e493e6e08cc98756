/** Velocity projection against an independent solution and against what it must conserve. */
#include "assembly.h"
#include "check.h"
#include "solution.h"

static void velocities_agree_with_an_independent_solution(void **state)
{
    (void)state;
    static const int64_t long_ones[] = {61, 100, 128, 500, 1000, 4097};
    for (int kind = 0; kind < CHAIN_KINDS; kind += quick_run() ? 5 : 1) {
        chain parts[66];
        const int first = kind == CHAIN_FIXED_ENDS || kind == CHAIN_TAUT ? 2 : 1;
        int count = 0;
        for (int64_t n = first; n <= 60; ++n) parts[count++] = chain_make((chain_kind)kind, n, (uint64_t)n);
        for (int i = 0; i < 6; ++i) parts[count++] = chain_make((chain_kind)kind, long_ones[i], 7);
        print_message("%s\n", chain_kind_name((chain_kind)kind));
        assembly a = assembly_make(parts, count, SCATTERED, 71);
        double *lambda = untouched((size_t)a.n_bonds), *v = copy_of(a.v, assembly_size(&a)), virial[9];
        long double sum[9] = {0}, scale = 0;
        CHECK(hol_project_velocities(a.chains, a.r, v, lambda, virial));
        for (int64_t c = 0; c < count; ++c) {
            const chain *one = parts + c;
            const solution_problem p = {one->n_bonds, one->mass, NULL, one->r, one->v, NULL, NULL};
            const long double unit = oracle_bound(one->n_bonds) * DBL_EPSILON;
            solution exact;
            assert_int_equal(solution_velocities(&p, &exact), 0);
            for (int64_t k = 0; k < one->n_bonds; ++k)
                CHECK_AT_MOST(fabsl(lambda[a.first_bond[c] + k] - exact.lambda[k]), unit * exact.lambda_scale[k]);
            for (int64_t i = 0; i <= one->n_bonds; ++i)
                for (int x = 0; x < 3; ++x) {
                    const double got = v[3 * a.atoms[a.first[c] + i] + x], start = one->v[3 * i + x];
                    const long double w = one->mass[i] > 0 ? 1 / (long double)one->mass[i] : 0;
                    if (w == 0) assert_true(got == start);
                    CHECK_AT_MOST(fabsl(got - (start + w * exact.g[3 * i + x])),
                                  unit * w * exact.g_scale[i] + DBL_EPSILON * fabs(start));
                }
            for (int i = 0; i < 9; ++i) sum[i] += exact.virial[i];
            scale += exact.virial_scale * oracle_bound(one->n_bonds);
            solution_free(&exact);
        }
        for (int i = 0; i < 9; ++i) CHECK_AT_MOST(fabsl(virial[i] - sum[i]), 2 * DBL_EPSILON * scale);
        free(lambda), free(v);
        assembly_free(&a);
        for (int c = 0; c < count; ++c) chain_free(parts + c);
    }
}

/** Largest |d.dv| of a chain over the root mean square of |dv|; rounding of the largest velocity counts as well. */
static long double worst_rate(const chain *c, const double *v)
{
    long double worst = 0, square = 0;
    for (int64_t k = 0; k < c->n_bonds; ++k) {
        long double rate = 0;
        for (int x = 0; x < 3; ++x) {
            const long double u = (long double)v[3 * k + 3 + x] - v[3 * k + x];
            rate += ((long double)c->r[3 * k + 3 + x] - c->r[3 * k + x]) * u;
            square += u * u;
        }
        if (fabsl(rate) > worst) worst = fabsl(rate);
    }
    return worst / sqrtl(square / c->n_bonds);
}

static long double rate_after_projection(chain_kind kind, int64_t n, uint64_t seed)
{
    chain c = chain_make(kind, n, seed);
    assembly a = assembly_make(&c, 1, IN_ORDER, 0);
    CHECK(hol_project_velocities(a.chains, a.r, a.v, NULL, NULL));
    const long double worst = worst_rate(&c, a.v);
    assembly_free(&a);
    chain_free(&c);
    return worst;
}

static void what_is_left_of_the_rates_is_rounding(void **state)
{
    (void)state;
    static const int64_t lengths[] = {1, 2, 3, 10, 100, 1000, 10000};
    for (int i = 0; i < (quick_run() ? 4 : 7); ++i) {
        long double coil = 0, straight = 0;
        for (uint64_t seed = 0; seed < 10; ++seed) {
            const long double p = rate_after_projection(CHAIN_COIL, lengths[i], seed),
                              q = rate_after_projection(CHAIN_NEARLY_STRAIGHT, lengths[i], seed);
            if (p > coil) coil = p;
            if (q > straight) straight = q;
        }
        print_message("N = %6lld: %.2Lg on coils, %.2Lg nearly straight\n", (long long)lengths[i], coil, straight);
        /* at most five roundings of velocities of up to four times the root mean square; nearly straight chains carry
           velocities along the chain that are the larger the longer they are */
        CHECK_AT_MOST(coil, 1e-15L);
        CHECK_AT_MOST(straight, 1e-14L);
    }
}

static void projected_velocities_project_to_themselves(void **state)
{
    (void)state;
    assembly a = assembly_of_kind(CHAIN_HETEROGENEOUS, 30, 1, 50, SCATTERED, 72);
    CHECK(hol_project_velocities(a.chains, a.r, a.v, NULL, NULL));
    double *again = copy_of(a.v, assembly_size(&a));
    CHECK(hol_project_velocities(a.chains, a.r, again, NULL, NULL));
    for (size_t i = 0; i < assembly_size(&a); ++i)
        if (!isnan(a.v[i])) CHECK_AT_MOST(fabs(again[i] - a.v[i]), 200 * DBL_EPSILON); /* velocities are up to 10 */
    free(again);
    assembly_free(&a);
}

static void projection_conserves_momentum_and_angular_momentum_and_lowers_kinetic_energy(void **state)
{
    (void)state;
    assembly a = assembly_of_kind(CHAIN_HETEROGENEOUS, 30, 1, 50, SCATTERED, 73);
    double *v = copy_of(a.v, assembly_size(&a));
    CHECK(hol_project_velocities(a.chains, a.r, v, NULL, NULL));
    for (int64_t c = 0; c < a.n_chains; ++c) {
        long double p[3] = {0}, l[3] = {0}, size = 0, reach = 0, before = 0, after = 0;
        for (int64_t i = 0; i <= assembly_bonds(&a, c); ++i) {
            const int64_t atom = a.atoms[a.first[c] + i];
            const long double m = a.mass[atom];
            const double *r = a.r + 3 * atom;
            long double dv[3];
            for (int x = 0; x < 3; ++x) {
                dv[x] = (long double)v[3 * atom + x] - a.v[3 * atom + x];
                p[x] += m * dv[x];
                size += m * (fabs(v[3 * atom + x]) + fabs(a.v[3 * atom + x]));
                before += m * a.v[3 * atom + x] * a.v[3 * atom + x];
                after += m * v[3 * atom + x] * v[3 * atom + x];
                if (fabs(r[x]) > reach) reach = fabs(r[x]);
            }
            for (int x = 0; x < 3; ++x)
                l[x] += m * (r[(x + 1) % 3] * dv[(x + 2) % 3] - r[(x + 2) % 3] * dv[(x + 1) % 3]);
        }
        for (int x = 0; x < 3; ++x) {
            /* every velocity is rounded once, the pulls of a bond on its atoms are opposite up to a rounding each */
            CHECK_AT_MOST(fabsl(p[x]), 4 * DBL_EPSILON * size);
            CHECK_AT_MOST(fabsl(l[x]), 8 * DBL_EPSILON * size * (reach + 1));
        }
        CHECK_AT_MOST(after, before * (1 + 8 * DBL_EPSILON));
    }
    free(v);
    assembly_free(&a);
}

static void velocities_do_not_depend_on_the_outputs_asked_for(void **state)
{
    (void)state;
    assembly a = assembly_of_kind(CHAIN_HETEROGENEOUS, 30, 1, 50, SCATTERED, 74);
    const size_t size = assembly_size(&a), n = (size_t)a.n_bonds;
    double *all = copy_of(a.v, size), *lambda = untouched(n), virial[9];
    CHECK(hol_project_velocities(a.chains, a.r, all, lambda, virial));
    for (int mask = 0; mask < 4; ++mask) {
        double *v = copy_of(a.v, size), *l = untouched(n), *s = untouched(9);
        CHECK(hol_project_velocities(a.chains, a.r, v, mask & 1 ? l : NULL, mask & 2 ? s : NULL));
        assert_same_bits(v, all, size);
        if (mask & 1) assert_same_bits(l, lambda, n);
        if (mask & 2) assert_same_bits(s, virial, 9);
        if (!(mask & 1)) assert_untouched(l, n);
        if (!(mask & 2)) assert_untouched(s, 9);
        free(v), free(l), free(s);
    }
    free(all), free(lambda);
    assembly_free(&a);
}

static void wrong_arguments_are_refused_and_nothing_is_written(void **state)
{
    (void)state;
    assembly a = assembly_of_kind(CHAIN_COIL, 3, 5, 5, IN_ORDER, 75);
    double *v = copy_of(a.v, assembly_size(&a)), *lambda = untouched(15), *virial = untouched(9);
    CHECK_FAILS(HOL_ERR_NULL, hol_project_velocities(NULL, a.r, v, lambda, virial));
    CHECK_FAILS(HOL_ERR_NULL, hol_project_velocities(a.chains, NULL, v, lambda, virial));
    CHECK_FAILS(HOL_ERR_NULL, hol_project_velocities(a.chains, a.r, NULL, lambda, virial));
    assert_same_bits(v, a.v, assembly_size(&a));
    assert_untouched(lambda, 15);
    assert_untouched(virial, 9);
    free(v), free(lambda), free(virial);
    assembly_free(&a);
}

// A call leaves in the memory of its thread what it worked on: here a chain of bonds that are not finite. All
// calculations of one chain that comes alone, its atoms anywhere, must give what they gave before.
static void nothing_depends_on_what_a_call_before_has_left_in_memory(void **state)
{
    (void)state;
    static double bad[3 * 257];
    double *mass = calloc(257, sizeof *mass);
    for (int e = 0; e < 3 * 257; ++e) bad[e] = NAN;
    for (int i = 0; i < 257; ++i) mass[i] = 1;
    hol_chains *spoiler_of_memory;
    CHECK(hol_chains_create(257, mass, &spoiler_of_memory));
    double lengths[256];
    for (int k = 0; k < 256; ++k) lengths[k] = 1;
    CHECK(hol_chains_add_block(spoiler_of_memory, 1, 256, 0, lengths));
    for (int64_t n = 1; n <= 60; ++n) {
        chain one = chain_make(CHAIN_HETEROGENEOUS, n, 5);
        assembly a = assembly_make(&one, 1, SCATTERED, 72);
        const size_t bonds = (size_t)n, size = assembly_size(&a);
        double *v[2], *lambda[2], *g[2], *r[2], *force[2], log_det[2];
        for (int again = 0; again < 2; ++again) {
            v[again] = copy_of(a.v, size), r[again] = copy_of(a.r, size);
            lambda[again] = untouched(3 * bonds), g[again] = untouched(size), force[again] = untouched(size);
            double moved[3 * 257];
            for (int call = 0; call < 4; ++call) {
                memcpy(moved, bad, sizeof moved);
                if (again)
                    CHECK_FAILS(HOL_ERR_NOT_FINITE, hol_project_velocities(spoiler_of_memory, bad, moved, NULL, NULL));
                if (call == 0)
                    CHECK(hol_forces(a.chains, a.r, a.v, a.f, lambda[again], NULL, g[again], HOL_WRITE, NULL));
                if (call == 1) CHECK(hol_project_velocities(a.chains, a.r, v[again], lambda[again] + bonds, NULL));
                if (call == 2)
                    CHECK(hol_project_positions(a.chains, a.r, r[again], NULL, 0.004, lambda[again] + 2 * bonds, 0,
                                                NULL, NULL));
                if (call == 3)
                    CHECK(hol_metric(a.chains, a.r, 1, log_det + again, NULL, NULL, force[again], HOL_WRITE));
            }
        }
        assert_same_bits(v[0], v[1], size);
        assert_same_bits(r[0], r[1], size);
        assert_same_bits(g[0], g[1], size);
        assert_same_bits(force[0], force[1], size);
        assert_same_bits(lambda[0], lambda[1], 3 * bonds);
        assert_same_bits(log_det, log_det + 1, 1);
        for (int i = 0; i < 2; ++i) free(v[i]), free(r[i]), free(g[i]), free(force[i]), free(lambda[i]);
        assembly_free(&a);
        chain_free(&one);
    }
    free(mass);
    hol_chains_destroy(spoiler_of_memory);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(velocities_agree_with_an_independent_solution),
        cmocka_unit_test(what_is_left_of_the_rates_is_rounding),
        cmocka_unit_test(projected_velocities_project_to_themselves),
        cmocka_unit_test(projection_conserves_momentum_and_angular_momentum_and_lowers_kinetic_energy),
        cmocka_unit_test(velocities_do_not_depend_on_the_outputs_asked_for),
        cmocka_unit_test(wrong_arguments_are_refused_and_nothing_is_written),
        cmocka_unit_test(nothing_depends_on_what_a_call_before_has_left_in_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
