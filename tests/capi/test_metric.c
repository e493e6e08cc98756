/**
 * ln det Z~, the Fixman potential and its force: against solutions in 113-bit arithmetic, closed forms and what must
 * hold exactly.
 */
#include "assembly.h"
#include "check.h"
#include "random.h"
#include "solution.h"

static hol_chains *handle(const chain *c)
{
    hol_chains *chains;
    CHECK(hol_chains_create(c->n_bonds + 1, c->mass, &chains));
    CHECK(hol_chains_add_block(chains, 1, c->n_bonds, 0, c->length));
    return chains;
}

/** The inverse masses as the library rounds them. */
static double *inverse_masses(const chain *c)
{
    double *w = malloc(sizeof(double) * ((size_t)c->n_bonds + 1));
    assert_non_null(w);
    for (int64_t i = 0; i <= c->n_bonds; ++i) w[i] = c->mass[i] == 0 ? 0 : 1 / c->mass[i];
    return w;
}

static void compare_chain(const chain *c)
{
    const int64_t n = c->n_bonds;
    double *w = inverse_masses(c), *force = untouched(3 * ((size_t)n + 1)), log_det, energy;
    const solution_problem p = {n, c->mass, w, c->r, NULL, NULL, NULL};
    const long double bound = oracle_bound(n) * DBL_EPSILON;
    solution_metric exact;
    assert_int_equal(solution_metric_make(&p, &exact), 0);
    hol_chains *chains = handle(c);
    CHECK(hol_metric(chains, c->r, 2, &log_det, NULL, &energy, force, HOL_WRITE));
    CHECK_AT_MOST(fabsl(log_det - exact.log_det), bound * fabsl(exact.log_det));
    assert_true(energy == log_det); /* kT / 2 = 1 */
    for (int64_t i = 0; i < 3 * (n + 1); ++i)
        CHECK_AT_MOST(fabsl(force[i] - 2 * exact.fixman_force[i]), 2 * bound * 2 * exact.fixman_scale[i / 3]);
    hol_chains_destroy(chains);
    solution_metric_free(&exact);
    free(force);
    free(w);
}

static void compare_with_solution(chain_kind kind, int64_t n, uint64_t seed)
{
    chain c = chain_make(kind, n, seed);
    compare_chain(&c);
    chain_free(&c);
}

/** Zigzags between heavy ends: what is rounded off must not be the same number at each joint. */
static void rods_of_equal_joints_lose_no_digits(void **state)
{
    (void)state;
    const double angles[] = {2e-9, 4e-10, 1e-7, 1e-11};
    for (int i = 0; i < (quick_run() ? 1 : 4); ++i) {
        const int64_t n = 980;
        chain c = chain_make(CHAIN_STRAIGHT, n, 1);
        c.mass[0] = c.mass[n] = 2e4;
        for (int64_t k = 0; k <= n; ++k) {
            c.r[3 * k] = 0.94 * (double)k + 0.3;
            c.r[3 * k + 1] = 0.282 * (double)k + (k % 2 ? angles[i] : 0);
            c.r[3 * k + 2] = -0.188 * (double)k - 0.7;
        }
        compare_chain(&c);
        chain_free(&c);
    }
}

/** ln det of a chain along x that bends little, in sums of terms of one sign, theory (24) to (28), in long double. */
static long double log_det_of_rod(const chain *c)
{
    long double e = 0, log_det = 0;
    for (int64_t k = 0; k <= c->n_bonds; ++k) {
        const long double w = c->mass[k] == 0 ? 0 : 1 / (long double)c->mass[k];
        long double cosine = 0, complement = 1; /* of the joint at this atom */
        if (k > 0 && k < c->n_bonds) {
            long double d[2][3], q[2] = {0, 0};
            for (int i = 0; i < 2; ++i)
                for (int x = 0; x < 3; ++x) {
                    d[i][x] = (long double)c->r[3 * (k + i) + x] - c->r[3 * (k + i - 1) + x];
                    q[i] += d[i][x] * d[i][x];
                }
            const long double u = d[0][1] * d[1][2] - d[0][2] * d[1][1], v = d[0][2] * d[1][0] - d[0][0] * d[1][2],
                              z = d[0][0] * d[1][1] - d[0][1] * d[1][0];
            cosine = (d[0][0] * d[1][0] + d[0][1] * d[1][1] + d[0][2] * d[1][2]) / sqrtl(q[0] * q[1]);
            complement = (u * u + v * v + z * z) / (q[0] * q[1]) / (1 + cosine);
        }
        /* the bond before this atom: e so far, and what the atom adds */
        if (k > 0) {
            const long double before = c->mass[k - 1] == 0 ? 0 : 1 / (long double)c->mass[k - 1];
            const long double row = e + w * complement, P = row + w * cosine;
            log_det += logl(P / (before + w));
            e = w * cosine > 0 ? w * cosine * (row / P) : 0;
        }
        e += w * complement;
    }
    return log_det;
}

/** Factors of the determinant whose products leave the range of doubles, and products of two inverse masses that do. */
static void masses_may_be_as_unequal_as_they_like(void **state)
{
    (void)state;
    const struct {
        double heavy, bend;
    } rod[] = {{1e20, 1e-20}, {1e40, 1e-25}, {1e45, 1e-30}, {1e70, 1e-40}};
    enum { N = 24 };
    for (int i = 0; i < 8; ++i) {
        chain c = chain_make(CHAIN_STRAIGHT, N, 1), back = chain_make(CHAIN_STRAIGHT, N, 1);
        for (int k = 0; k <= N; ++k) {
            c.mass[k] = k % 2 ? 1 : rod[i / 2].heavy;
            c.r[3 * k] = k;
            c.r[3 * k + 1] = rod[i / 2].bend * (double)(k * k % 7);
            c.r[3 * k + 2] = rod[i / 2].bend * (double)(5 * k % 11 - 4);
        }
        if (i % 2) c.mass[0] = c.mass[N] = 0;
        for (int k = 0; k <= N; ++k) {
            back.mass[k] = c.mass[N - k];
            for (int x = 0; x < 3; ++x) back.r[3 * k + x] = c.r[3 * (N - k) + x];
        }
        double log_det, *force = untouched(3 * (N + 1)), *from_behind = untouched(3 * (N + 1)), largest = 0;
        hol_chains *chains = handle(&c), *other = handle(&back);
        CHECK(hol_metric(chains, c.r, 2, &log_det, NULL, NULL, force, HOL_WRITE));
        CHECK(hol_metric(other, back.r, 2, NULL, NULL, NULL, from_behind, HOL_WRITE));
        CHECK_AT_MOST(fabsl(log_det - log_det_of_rod(&c)), oracle_bound(N) * DBL_EPSILON * fabs(log_det));
        for (int k = 0; k < 3 * (N + 1); ++k) largest = fmax(largest, fabs(force[k]));
        assert_true(largest > 0 && largest < 1e300);
        for (int k = 0; k <= N; ++k)
            for (int x = 0; x < 3; ++x)
                CHECK_AT_MOST(fabs(force[3 * k + x] - from_behind[3 * (N - k) + x]),
                              oracle_bound(N) * DBL_EPSILON * largest);
        hol_chains_destroy(chains);
        hol_chains_destroy(other);
        free(force);
        free(from_behind);
        chain_free(&c);
        chain_free(&back);
    }
    const double size[] = {1e-160, 1e160, 1e-290, 1e290};
    /* the reference needs the range of long double, which valgrind has not */
    for (int i = 0; i < (quick_run() ? 0 : 4); ++i) {
        chain c = chain_make(CHAIN_COIL, N, 2);
        for (int k = 0; k <= N; ++k) c.mass[k] = size[i] * (1 + 0.7 * k);
        compare_chain(&c);
        for (int k = 0; k <= N; ++k) c.mass[k] = 1;
        c.mass[7] = size[i];
        compare_chain(&c);
        chain_free(&c);
    }
}

static void metric_agrees_with_113_bits_for_every_kind_of_chain(void **state)
{
    (void)state;
    for (int kind = 0; kind < CHAIN_KINDS; ++kind)
        for (int64_t n = kind == CHAIN_FIXED_ENDS || kind == CHAIN_TAUT ? 2 : 1; n <= 40;
             n += n < 10 && !quick_run() ? 1 : 13)
            compare_with_solution((chain_kind)kind, n, (uint64_t)n);
}

static void metric_of_long_chains_agrees_with_113_bits(void **state)
{
    (void)state;
    const int64_t sizes[] = {256, 257, 300, 1023};
    for (int kind = 0; kind < CHAIN_KINDS; kind += quick_run() ? CHAIN_KINDS : 1)
        for (int i = quick_run() ? 1 : 0; i < (quick_run() ? 2 : 4); ++i)
            if (i != 3 || kind % 4 == 2) compare_with_solution((chain_kind)kind, sizes[i], 5);
}

static void force_is_minus_the_gradient(void **state)
{
    (void)state;
    for (int kind = 0; kind < CHAIN_KINDS; ++kind) {
        if (kind == CHAIN_STRAIGHT || kind == CHAIN_ROD_MASSES_1E9 || kind == CHAIN_TAUT || kind == CHAIN_FOLDED)
            continue; /* within the step of a singular shape, where differences know nothing */
        for (int64_t n = 2; n <= (quick_run() ? 8 : 20); n += 6) {
            chain c = chain_make((chain_kind)kind, n, (uint64_t)(100 + n));
            double *w = inverse_masses(&c), *force = untouched(3 * ((size_t)n + 1));
            long double *slope = malloc(sizeof(long double) * 3 * ((size_t)n + 1));
            const solution_problem p = {n, c.mass, w, c.r, NULL, NULL, NULL};
            solution_metric exact;
            assert_non_null(slope);
            assert_int_equal(solution_metric_make(&p, &exact), 0);
            assert_int_equal(solution_fixman_differences(&p, slope), 0);
            hol_chains *chains = handle(&c);
            CHECK(hol_metric(chains, c.r, 1, NULL, NULL, NULL, force, HOL_WRITE));
            /* beside the library's rounding that of the differences: 2^-112 over the step, 1e-8, times the condition */
            for (int64_t i = 0; i < 3 * (n + 1); ++i)
                CHECK_AT_MOST(
                    fabsl(force[i] - slope[i]),
                    (2 * oracle_bound(n) * DBL_EPSILON + 1e-20L * exact.condition) * exact.fixman_scale[i / 3] +
                        1e-24L * exact.condition / c.length[i / 3 < n ? i / 3 : n - 1]);
            hol_chains_destroy(chains);
            solution_metric_free(&exact);
            free(slope);
            free(force);
            free(w);
            chain_free(&c);
        }
    }
}

static void total_force_torque_and_virial_trace_vanish(void **state)
{
    (void)state;
    for (int kind = 0; kind < CHAIN_KINDS; ++kind) {
        const int64_t n = 50;
        if (kind == CHAIN_OFFSET_1E6) continue; /* the sums themselves lose six digits there */
        chain c = chain_make((chain_kind)kind, n, 3);
        double force[3 * 51];
        hol_chains *chains = handle(&c);
        CHECK(hol_metric(chains, c.r, 1, NULL, NULL, NULL, force, HOL_WRITE));
        long double total[3] = {0, 0, 0}, torque[3] = {0, 0, 0}, trace = 0, size = 0, moment = 0;
        for (int64_t i = 0; i <= n; ++i) {
            const double *r = c.r + 3 * i, *f = force + 3 * i;
            for (int x = 0; x < 3; ++x) {
                const int y = (x + 1) % 3, z = (x + 2) % 3;
                total[x] += f[x];
                torque[x] += (long double)r[y] * f[z] - (long double)r[z] * f[y];
                trace += (long double)r[x] * f[x];
                size += fabsl(f[x]);
                for (int j = 0; j < 3; ++j) moment += fabsl((long double)r[x] * f[j]);
            }
        }
        /* each force component is right to a few roundings of its bonds' contributions, a bond ratio of 1e6 included */
        const long double bound = 2 * oracle_bound(n) * DBL_EPSILON * (kind == CHAIN_BOND_RATIO_1E6 ? 1e6L : 1);
        for (int x = 0; x < 3; ++x) {
            CHECK_AT_MOST(fabsl(total[x]), bound * size);
            CHECK_AT_MOST(fabsl(torque[x]), bound * moment);
        }
        CHECK_AT_MOST(fabsl(trace), bound * moment);
        hol_chains_destroy(chains);
        chain_free(&c);
    }
}

static void straight_chain_has_the_closed_form_up_to_a_million_bonds(void **state)
{
    (void)state;
    for (int64_t n = 1; n <= (quick_run() ? 10000 : 1000000); n *= 10) {
        chain c = chain_make(CHAIN_STRAIGHT, n, 1);
        double log_det;
        hol_chains *chains = handle(&c);
        CHECK(hol_metric(chains, c.r, 1, &log_det, NULL, NULL, NULL, HOL_WRITE));
        const long double exact = logl((long double)(n + 1)) - (long double)n * logl(2);
        CHECK_AT_MOST(fabsl(log_det - exact), oracle_bound(n) * DBL_EPSILON * fabsl(exact));
        hol_chains_destroy(chains);
        chain_free(&c);
    }
}

static void reversing_the_labels_changes_nothing_but_rounding(void **state)
{
    (void)state;
    for (int kind = 0; kind < CHAIN_KINDS; ++kind)
        for (int64_t n = 3; n <= 1003; n += 500) {
            chain c = chain_make((chain_kind)kind, n, 17), back = chain_make((chain_kind)kind, n, 17);
            for (int64_t i = 0; i <= n; ++i) {
                back.mass[i] = c.mass[n - i];
                for (int x = 0; x < 3; ++x) back.r[3 * i + x] = c.r[3 * (n - i) + x];
                if (i < n) back.length[i] = c.length[n - 1 - i];
            }
            double there, again;
            hol_chains *chains = handle(&c), *reversed = handle(&back);
            CHECK(hol_metric(chains, c.r, 1, &there, NULL, NULL, NULL, HOL_WRITE));
            CHECK(hol_metric(reversed, back.r, 1, &again, NULL, NULL, NULL, HOL_WRITE));
            CHECK_AT_MOST(fabs(there - again), 2 * oracle_bound(n) * DBL_EPSILON * fabs(there));
            hol_chains_destroy(chains);
            hol_chains_destroy(reversed);
            chain_free(&c);
            chain_free(&back);
        }
}

static void physical_determinant_adds_the_diagonal(void **state)
{
    (void)state;
    const double units[] = {1, 0x1p-60, 0x1p200, 0x1p-200};
    const int64_t sizes[] = {1, 2, 33, 400};
    for (int u = 0; u < 4; ++u)
        for (int s = 0; s < 4; ++s) {
            const int64_t n = sizes[s];
            chain c = chain_make(CHAIN_HETEROGENEOUS, n, 4);
            long double sum = 0, size = 0;
            for (int64_t i = 0; i < 3 * (n + 1); ++i) c.r[i] *= units[u];
            for (int64_t k = 0; k < n; ++k) {
                long double square = 0;
                for (int x = 0; x < 3; ++x) {
                    const long double d = (long double)c.r[3 * k + 3 + x] - c.r[3 * k + x];
                    square += d * d;
                }
                const long double term =
                    logl(4 * (1 / (long double)c.mass[k] + 1 / (long double)c.mass[k + 1]) * square);
                sum += term;
                size += fabsl(term);
            }
            double scaled, physical;
            hol_chains *chains = handle(&c);
            CHECK(hol_metric(chains, c.r, 1, &scaled, &physical, NULL, NULL, HOL_WRITE));
            /* one rounding per term and per sum */
            CHECK_AT_MOST(fabsl(physical - scaled - sum), oracle_bound(n) * DBL_EPSILON * (size + fabs(scaled)));
            hol_chains_destroy(chains);
            chain_free(&c);
        }
}

static void a_bond_between_two_fixed_atoms_is_in_no_determinant(void **state)
{
    (void)state;
    const double masses[4] = {1, 0, 0, 1}, r[12] = {0, 0, 0, 1, 0, 0, 2, 3, 0, 3, 3, 0}, length[3] = {1, 3, 1};
    double log_det[2], log_det_z[2], *force = untouched(12);
    hol_chains *chains;
    CHECK(hol_chains_create(4, masses, &chains));
    CHECK(hol_chains_add_block(chains, 1, 3, 0, length));
    assert_int_equal(hol_chains_n_molecules(chains), 2);
    CHECK(hol_metric(chains, r, 1, log_det, log_det_z, NULL, force, HOL_WRITE));
    for (int c = 0; c < 2; ++c) {
        assert_true(log_det[c] == 0);
        CHECK_AT_MOST(fabs(log_det_z[c] - log(4)), 4 * DBL_EPSILON); /* Z = 4 w d.d, some roundings of a logarithm */
    }
    for (int i = 0; i < 12; ++i) assert_true(force[i] == 0);
    free(force);
    hol_chains_destroy(chains);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_bond_between_two_fixed_atoms_is_in_no_determinant),
        cmocka_unit_test(metric_agrees_with_113_bits_for_every_kind_of_chain),
        cmocka_unit_test(rods_of_equal_joints_lose_no_digits),
        cmocka_unit_test(masses_may_be_as_unequal_as_they_like),
        cmocka_unit_test(metric_of_long_chains_agrees_with_113_bits),
        cmocka_unit_test(force_is_minus_the_gradient),
        cmocka_unit_test(total_force_torque_and_virial_trace_vanish),
        cmocka_unit_test(straight_chain_has_the_closed_form_up_to_a_million_bonds),
        cmocka_unit_test(reversing_the_labels_changes_nothing_but_rounding),
        cmocka_unit_test(physical_determinant_adds_the_diagonal),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
