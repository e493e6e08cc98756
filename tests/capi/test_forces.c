/** Constraint forces against an independent solution, and against what physics demands of them. */
#include "assembly.h"
#include "check.h"
#include "forces.h"
#include "oracle_file.h"
#include "random.h"
#include "solution.h"

/** Every number of every chain within `allowed` times the bound that tests/oracle/README.md sets. */
static void assert_solution(const assembly *a, const double *v, const double *f, long double allowed)
{
    forces_results s = forces_of(a, v, f);
    long double virial[9] = {0}, virial_scale = 0;
    for (int64_t c = 0; c < a->n_chains; ++c) {
        chain one = assembly_chain(a, c);
        const int64_t n = one.n_bonds;
        const solution_problem p = {n, one.mass, NULL, one.r, v ? one.v : NULL, f ? one.f : NULL, NULL};
        const long double unit = allowed * oracle_bound(n) * DBL_EPSILON;
        solution exact;
        assert_int_equal(solution_forces(&p, &exact), 0);
        for (int64_t k = 0; k < n; ++k) {
            const int64_t at = a->first_bond[c] + k;
            CHECK_AT_MOST(fabsl(s.lambda[at] - exact.lambda[k]), unit * exact.lambda_scale[k]);
            /* T = 2 lambda |d|: two more roundings than lambda, of a number no larger than its scale */
            const long double size = exact.lambda[k] != 0 ? fabsl(exact.tension[k] / exact.lambda[k]) : 0;
            CHECK_AT_MOST(fabsl(s.tension[at] - exact.tension[k]), 1.2L * unit * exact.lambda_scale[k] * size);
        }
        double *g = untouched(3 * (size_t)(n + 1));
        assembly_take(a, c, s.g, g);
        for (int64_t i = 0; i < 3 * (n + 1); ++i) CHECK_AT_MOST(fabsl(g[i] - exact.g[i]), unit * exact.g_scale[i / 3]);
        for (int i = 0; i < 9; ++i) virial[i] += exact.virial[i];
        virial_scale += exact.virial_scale * oracle_bound(n);
        free(g);
        solution_free(&exact);
        chain_free(&one);
    }
    /* the sum over chains adds at most one rounding of the largest partial sum per chain, sqrt of that if they are
     * random */
    for (int i = 0; i < 9; ++i)
        CHECK_AT_MOST(fabsl(s.virial[i] - virial[i]),
                      allowed * DBL_EPSILON * virial_scale * (1 + sqrtl((long double)a->n_chains) / 16));
    forces_results_free(&s);
}

static void forces_agree_with_a_dense_solution_for_every_length_to_60(void **state)
{
    (void)state;
    for (int kind = 0; kind < CHAIN_KINDS; kind += quick_run() ? 5 : 1) {
        chain parts[60];
        for (int n = 1; n <= 60; ++n) parts[n - 1] = chain_make((chain_kind)kind, n, (uint64_t)n);
        print_message("%s\n", chain_kind_name((chain_kind)kind));
        /* a chain exactly straight between two fixed ends is singular: one bond between two fixed atoms is always */
        const int skip = kind == CHAIN_FIXED_ENDS || kind == CHAIN_TAUT ? 2 : 0;
        assembly a = assembly_make(parts + skip, 60 - skip, SCATTERED, 9);
        assert_solution(&a, a.v, a.f, 1);
        assembly_free(&a);
        for (int n = 1; n <= 60; ++n) chain_free(parts + n - 1);
    }
}

static void forces_agree_with_a_banded_solution_for_long_chains(void **state)
{
    (void)state;
    static const int64_t lengths[] = {61, 64, 100, 127, 128, 129, 500, 1000, 1023, 4096, 10001};
    for (int kind = 0; kind < CHAIN_KINDS; kind += quick_run() ? 4 : 1) {
        print_message("%s\n", chain_kind_name((chain_kind)kind));
        for (size_t i = 0; i < sizeof lengths / sizeof *lengths - (quick_run() ? 5 : 0); ++i) {
            /* joining segments loses digits as the length where a chain between fixed ends is taut to 1e-5 radians:
               docs/theory.md */
            if (kind == CHAIN_TAUT && lengths[i] > 4096) continue;
            chain one = chain_make((chain_kind)kind, lengths[i], 77 + i);
            assembly a = assembly_make(&one, 1, IN_ORDER, 0);
            assert_solution(&a, a.v, a.f, 1);
            assembly_free(&a);
            chain_free(&one);
        }
    }
}

static void forces_agree_with_the_reference_files_when_all_chains_share_one_handle(void **state)
{
    (void)state;
    chain parts[64];
    oracle_case cases[64];
    int n = 0;
    char line[256], path[600], message[1000];
    FILE *index = fopen(ORACLE_DIR "/INDEX", "r");
    assert_non_null(index);
    while (n < 64 && fgets(line, sizeof line, index)) {
        line[strcspn(line, "\r\n")] = 0;
        snprintf(path, sizeof path, ORACLE_DIR "/%s", line);
        if (oracle_read(path, &cases[n], message, sizeof message)) fail_msg("%s", message);
        oracle_case *c = &cases[n];
        for (int64_t i = 0; i <= c->n_bonds; ++i)
            if (c->w[i] == 0) c->mass[i] = 0;
        const chain part = {c->n_bonds, c->mass, c->length, c->r, c->v, c->f};
        parts[n++] = part;
    }
    fclose(index);
    assert_int_equal(n, 26);
    assembly a = assembly_make(parts, n, SCATTERED, 5);
    forces_results s = forces_of(&a, a.v, a.f);
    for (int c = 0; c < n; ++c) {
        const long double unit = oracle_bound(cases[c].n_bonds) * DBL_EPSILON;
        for (int64_t k = 0; k < cases[c].n_bonds; ++k)
            CHECK_AT_MOST(fabsl(s.lambda[a.first_bond[c] + k] - cases[c].lambda[k]), unit * cases[c].lambda_scale[k]);
        oracle_free(&cases[c]);
    }
    forces_results_free(&s);
    assembly_free(&a);
}

static void velocities_and_forces_may_each_be_left_out(void **state)
{
    (void)state;
    assembly a = assembly_of_kind(CHAIN_HETEROGENEOUS, 30, 1, 40, SCATTERED, 3);
    assert_solution(&a, a.v, NULL, 1);
    assert_solution(&a, NULL, a.f, 1);
    forces_results s = forces_of(&a, NULL, NULL);
    for (int64_t k = 0; k < a.n_bonds; ++k) assert_true(s.lambda[k] == 0 && s.tension[k] == 0);
    for (int i = 0; i < 9; ++i) assert_true(s.virial[i] == 0);
    forces_results_free(&s);
    assembly_free(&a);
}

/** a null input gives the same bits as zeros */
static void zero_velocities_and_forces_equal_null(void **state)
{
    (void)state;
    assembly a = assembly_of_kind(CHAIN_HETEROGENEOUS, 20, 1, 40, IN_ORDER, 4);
    double *zero = calloc(assembly_size(&a), sizeof *zero);
    forces_results with = forces_of(&a, zero, a.f), without = forces_of(&a, NULL, a.f);
    for (int64_t k = 0; k < a.n_bonds; ++k) assert_true(with.lambda[k] == without.lambda[k]);
    forces_results_free(&with);
    forces_results_free(&without);
    with = forces_of(&a, a.v, zero);
    without = forces_of(&a, a.v, NULL);
    for (int64_t k = 0; k < a.n_bonds; ++k) assert_true(with.lambda[k] == without.lambda[k]);
    forces_results_free(&with);
    forces_results_free(&without);
    free(zero);
    assembly_free(&a);
}

static void forces_make_the_second_derivative_of_every_bond_vanish(void **state)
{
    (void)state;
    for (int kind = 0; kind < CHAIN_KINDS; ++kind) {
        assembly a = assembly_of_kind((chain_kind)kind, 25, 2, 50, IN_ORDER, 11);
        forces_results s = forces_of(&a, a.v, a.f);
        for (int64_t c = 0; c < a.n_chains; ++c)
            for (int64_t k = 1; k <= assembly_bonds(&a, c); ++k) {
                const int64_t i = 3 * a.atoms[a.first[c] + k - 1], j = 3 * a.atoms[a.first[c] + k];
                const double mi = a.mass[i / 3], mj = a.mass[j / 3];
                long double sum = 0, size = 0;
                for (int x = 0; x < 3; ++x) {
                    const long double d = (long double)a.r[j + x] - a.r[i + x],
                                      u = (long double)a.v[j + x] - a.v[i + x];
                    const long double wi = mi > 0 ? 1 / (long double)mi : 0, wj = mj > 0 ? 1 / (long double)mj : 0;
                    sum += d * (wj * ((long double)a.f[j + x] + s.g[j + x]) -
                                wi * ((long double)a.f[i + x] + s.g[i + x])) +
                           u * u;
                    size += fabsl(d) * (wj * (fabsl(a.f[j + x]) + fabs(s.g[j + x])) +
                                        wi * (fabsl(a.f[i + x]) + fabs(s.g[i + x]))) +
                            u * u;
                }
                /* G is a difference of two pulls, each of which may be larger than G, so its error is counted in terms
                   of the pulls of the neighbouring bonds */
                const int64_t at = a.first_bond[c] + k - 1;
                for (int64_t b = at - (k > 1); b <= at + (k < assembly_bonds(&a, c)); ++b)
                    size += fabs(s.tension[b]) * a.length[at] * ((mi > 0 ? 1 / mi : 0) + (mj > 0 ? 1 / mj : 0));
                CHECK_AT_MOST(fabsl(sum), oracle_bound(assembly_bonds(&a, c)) * DBL_EPSILON * size);
            }
        forces_results_free(&s);
        assembly_free(&a);
    }
}

static void constraint_forces_sum_to_zero_and_exert_no_torque(void **state)
{
    (void)state;
    for (int kind = 0; kind < CHAIN_KINDS; ++kind) {
        assembly a = assembly_of_kind((chain_kind)kind, 25, 2, 80, SCATTERED, 12);
        forces_results s = forces_of(&a, a.v, a.f);
        for (int64_t c = 0; c < a.n_chains; ++c) {
            long double force[3] = {0}, torque[3] = {0}, size = 0, reach = 0;
            const int64_t n = assembly_bonds(&a, c), *atoms = a.atoms + a.first[c];
            for (int64_t k = 0; k < n; ++k) {
                size += 2 * fabs(s.tension[a.first_bond[c] + k]);
                reach += a.length[a.first_bond[c] + k];
            }
            for (int64_t i = 0; i <= n; ++i) {
                long double d[3];
                for (int x = 0; x < 3; ++x) {
                    force[x] += s.g[3 * atoms[i] + x];
                    d[x] = (long double)a.r[3 * atoms[i] + x] - a.r[3 * atoms[0] + x];
                }
                for (int x = 0; x < 3; ++x) {
                    const int y = (x + 1) % 3, z = (x + 2) % 3;
                    torque[x] += d[y] * s.g[3 * atoms[i] + z] - d[z] * s.g[3 * atoms[i] + y];
                }
            }
            /* every pull acts on two atoms, oppositely: what is left are the roundings of the pulls, and of their sums
             */
            for (int x = 0; x < 3; ++x) {
                CHECK_AT_MOST(fabsl(force[x]), 2 * DBL_EPSILON * size);
                CHECK_AT_MOST(fabsl(torque[x]), 4 * DBL_EPSILON * size * reach);
            }
        }
        forces_results_free(&s);
        assembly_free(&a);
    }
}

static void virial_is_the_sum_of_positions_times_forces_and_of_tensions(void **state)
{
    (void)state;
    assembly a = assembly_of_kind(CHAIN_HETEROGENEOUS, 40, 1, 60, SCATTERED, 13);
    forces_results s = forces_of(&a, a.v, a.f);
    long double by_atoms[9] = {0}, by_bonds[9] = {0}, size = 0;
    for (int64_t c = 0; c < a.n_chains; ++c) {
        const int64_t *atoms = a.atoms + a.first[c];
        for (int64_t k = 0; k < assembly_bonds(&a, c); ++k)
            for (int x = 0; x < 3; ++x)
                for (int y = 0; y < 3; ++y) {
                    const double *p = a.r + 3 * atoms[k], *q = a.r + 3 * atoms[k + 1];
                    const long double t =
                        2 * s.lambda[a.first_bond[c] + k] * ((long double)q[x] - p[x]) * ((long double)q[y] - p[y]);
                    by_bonds[3 * x + y] -= t;
                    size += fabsl(t);
                }
        for (int64_t i = 0; i <= assembly_bonds(&a, c); ++i)
            for (int x = 0; x < 3; ++x)
                for (int y = 0; y < 3; ++y)
                    by_atoms[3 * x + y] += (long double)a.r[3 * atoms[i] + x] * s.g[3 * atoms[i] + y];
    }
    for (int i = 0; i < 9; ++i) {
        /* roundings: of each term, and of the sums over bonds, chains and lanes */
        CHECK_AT_MOST(fabsl(s.virial[i] - by_bonds[i]), 16 * DBL_EPSILON * size);
        /* r is up to 60 bond lengths from the origin, so that roundings of G count that much more */
        CHECK_AT_MOST(fabsl(s.virial[i] - by_atoms[i]), 60 * 16 * DBL_EPSILON * size);
        assert_true(s.virial[i] == s.virial[3 * (i % 3) + i / 3]);
    }
    forces_results_free(&s);
    assembly_free(&a);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(forces_agree_with_a_dense_solution_for_every_length_to_60),
        cmocka_unit_test(forces_agree_with_a_banded_solution_for_long_chains),
        cmocka_unit_test(forces_agree_with_the_reference_files_when_all_chains_share_one_handle),
        cmocka_unit_test(velocities_and_forces_may_each_be_left_out),
        cmocka_unit_test(zero_velocities_and_forces_equal_null),
        cmocka_unit_test(forces_make_the_second_derivative_of_every_bond_vanish),
        cmocka_unit_test(constraint_forces_sum_to_zero_and_exert_no_torque),
        cmocka_unit_test(virial_is_the_sum_of_positions_times_forces_and_of_tensions),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
