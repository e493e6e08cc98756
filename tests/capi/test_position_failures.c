/** Position projection when it cannot succeed: nothing of the chain changes, the others are done, and the report says
 * so. */
#include "assembly.h"
#include "check.h"

static const double time_step = 0.004;

typedef struct arrays {
    double *r, *v, *lambda, *virial;
} arrays;

static arrays begin(const assembly *a)
{
    arrays s = {copy_of(a->r, assembly_size(a)), copy_of(a->v, assembly_size(a)), untouched((size_t)a->n_bonds),
                untouched(9)};
    for (size_t i = 0; i < assembly_size(a); ++i) s.r[i] += time_step * a->v[i];
    return s;
}

static void end(arrays *s)
{
    free(s->r), free(s->v), free(s->lambda), free(s->virial);
}

static void assert_chain(const assembly *a, int64_t c, const double *got, const double *expected)
{
    for (int64_t i = 0; i <= assembly_bonds(a, c); ++i) {
        const int64_t at = 3 * a->atoms[a->first[c] + i];
        assert_same_bits(got + at, expected + at, 3);
    }
}

/** Spoils the drifted positions of the chains listed so that the lengths can't be reached. */
typedef void (*spoiler)(const assembly *a, int64_t c, double *r);

/** Turns a bond by a right angle and pulls it long: no correction along the old bond can shorten it enough. */
static void out_of_reach(const assembly *a, int64_t c, double *r)
{
    const int64_t i = 3 * a->atoms[a->first[c]], j = 3 * a->atoms[a->first[c] + 1];
    double d[3], e[3] = {0, 0, 0};
    for (int x = 0; x < 3; ++x) d[x] = a->r[j + x] - a->r[i + x];
    e[fabs(d[0]) < 0.5 ? 0 : 1] = 1;
    for (int x = 0; x < 3; ++x)
        r[i + x] = r[j + x] - 9 * (d[(x + 1) % 3] * e[(x + 2) % 3] - d[(x + 2) % 3] * e[(x + 1) % 3]);
}

/** Throws the whole chain about. */
static void torn_apart(const assembly *a, int64_t c, double *r)
{
    for (int64_t i = 0; i <= assembly_bonds(a, c); ++i)
        for (int x = 0; x < 3; ++x) r[3 * a->atoms[a->first[c] + i] + x] += 1e3 * sin((double)(7 * i + 3 * x + c));
}

static void fail_with(spoiler spoil, const int64_t *bad, int n_bad, int threads, int with_v)
{
    assembly a = assembly_of_kind(CHAIN_COIL, 27, 1, 50, SCATTERED, 91);
    CHECK(hol_chains_set_checks(a.chains, HOL_NEVER)); /* what Newton's method makes of these */
    CHECK(hol_chains_set_threads(a.chains, threads));
    CHECK(hol_project_velocities(a.chains, a.r, a.v, NULL, NULL));
    arrays good = begin(&a), got = begin(&a);
    CHECK(hol_project_positions(a.chains, a.r, good.r, good.v, time_step, good.lambda, 0, NULL, NULL));
    for (int i = 0; i < n_bad; ++i) spoil(&a, bad[i], got.r);
    arrays before = {copy_of(got.r, assembly_size(&a)), 0, 0, 0};
    hol_report report;
    CHECK_FAILS(HOL_ERR_NO_CONVERGENCE, hol_project_positions(a.chains, a.r, got.r, with_v ? got.v : NULL, time_step,
                                                              got.lambda, 0, got.virial, &report));
    int64_t where, count;
    hol_error_location(&where, NULL, NULL, &count);
    assert_int_equal(where, bad[0]);
    assert_int_equal(count, n_bad);
    assert_untouched(got.virial, 9);
    assert_int_equal(report.n_failed, n_bad);
    assert_int_equal(report.n_corrected, 27 - n_bad);
    CHECK_AT_MOST(report.max_error, 200 * DBL_EPSILON);
    int next = 0;
    for (int64_t c = 0; c < 27; ++c) {
        const size_t at = (size_t)a.first_bond[c], n = (size_t)assembly_bonds(&a, c);
        const int wrong = next < n_bad && bad[next] == c;
        next += wrong;
        assert_chain(&a, c, got.r, wrong ? before.r : good.r);
        assert_chain(&a, c, got.v, wrong || !with_v ? a.v : good.v);
        if (wrong)
            assert_untouched(got.lambda + at, n);
        else
            assert_same_bits(got.lambda + at, good.lambda + at, n);
    }
    end(&good), end(&got), free(before.r);
    assembly_free(&a);
}

static void chains_that_cannot_reach_their_lengths_keep_every_bit(void **state)
{
    (void)state;
    static const int64_t one[] = {5}, several[] = {0, 1, 2, 3, 13, 26};
    for (int with_v = 0; with_v < 2; ++with_v) {
        fail_with(out_of_reach, one, 1, 1, with_v);
        fail_with(out_of_reach, several, 6, 1, with_v);
        fail_with(out_of_reach, several, 6, 3, with_v);
        fail_with(torn_apart, one, 1, 1, with_v);
        fail_with(torn_apart, several, 6, 2, with_v);
    }
}

static void a_hard_bound_on_iterations_ends_in_a_status(void **state)
{
    (void)state;
    assembly a = assembly_of_kind(CHAIN_COIL, 9, 20, 40, IN_ORDER, 92);
    arrays s = begin(&a), before = begin(&a);
    hol_report report;
    CHECK(hol_chains_set_max_iterations(a.chains, 1));
    CHECK_FAILS(HOL_ERR_NO_CONVERGENCE,
                hol_project_positions(a.chains, a.r, s.r, s.v, time_step, s.lambda, 0, s.virial, &report));
    assert_same_bits(s.r, before.r, assembly_size(&a));
    assert_same_bits(s.v, before.v, assembly_size(&a));
    assert_untouched(s.lambda, (size_t)a.n_bonds);
    assert_untouched(s.virial, 9);
    assert_int_equal(report.n_failed, 9);
    assert_int_equal(report.n_corrected, 0);
    assert_int_equal(report.iterations, 1);
    assert_int_equal(report.molecule, -1);
    assert_int_equal(report.bond, -1);
    CHECK(hol_chains_set_max_iterations(a.chains, 50));
    CHECK(hol_project_positions(a.chains, a.r, s.r, s.v, time_step, s.lambda, 0, s.virial, &report));
    end(&s), end(&before);
    assembly_free(&a);
}

static void wrong_arguments_are_refused_and_nothing_is_written(void **state)
{
    (void)state;
    assembly a = assembly_of_kind(CHAIN_COIL, 3, 5, 9, IN_ORDER, 93);
    arrays s = begin(&a), before = begin(&a);
    hol_report report, same;
    memset(&report, 0x5a, sizeof report);
    memset(&same, 0x5a, sizeof same);
    CHECK_FAILS(HOL_ERR_NULL, hol_project_positions(NULL, a.r, s.r, s.v, 1, s.lambda, 0, s.virial, &report));
    CHECK_FAILS(HOL_ERR_NULL, hol_project_positions(a.chains, NULL, s.r, s.v, 1, s.lambda, 0, s.virial, &report));
    CHECK_FAILS(HOL_ERR_NULL, hol_project_positions(a.chains, a.r, NULL, s.v, 1, s.lambda, 0, s.virial, &report));
    CHECK_FAILS(HOL_ERR_NULL, hol_project_positions(a.chains, a.r, s.r, s.v, 1, NULL, 1, s.virial, &report));
    static const double wrong[] = {0, -1, -0.0, NAN, INFINITY, -INFINITY};
    for (int i = 0; i < 6; ++i)
        CHECK_FAILS(HOL_ERR_VALUE,
                    hol_project_positions(a.chains, a.r, s.r, s.v, wrong[i], s.lambda, 0, s.virial, &report));
    CHECK_FAILS(HOL_ERR_VALUE, hol_project_positions(a.chains, a.r, s.r, s.v, 1, s.lambda, 2, s.virial, &report));
    CHECK_FAILS(HOL_ERR_VALUE, hol_project_positions(a.chains, a.r, s.r, s.v, 1, s.lambda, -1, s.virial, &report));
    assert_same_bits(s.r, before.r, assembly_size(&a));
    assert_same_bits(s.v, before.v, assembly_size(&a));
    assert_untouched(s.lambda, (size_t)a.n_bonds);
    assert_untouched(s.virial, 9);
    assert_memory_equal(&report, &same, sizeof report);
    end(&s), end(&before);
    assembly_free(&a);
}

static void a_wild_guess_ends_on_the_lengths_or_in_a_status(void **state)
{
    (void)state;
    assembly a = assembly_of_kind(CHAIN_COIL, 40, 1, 40, IN_ORDER, 94);
    static const double guesses[] = {1e3, -1e5, 1e12, -1e300, INFINITY, NAN};
    for (size_t g = 0; g < sizeof guesses / sizeof *guesses; ++g) {
        arrays s = begin(&a), before = begin(&a);
        for (int64_t k = 0; k < a.n_bonds; ++k) s.lambda[k] = k % 3 ? guesses[g] : 0;
        const int status = hol_project_positions(a.chains, a.r, s.r, s.v, time_step, s.lambda, 1, NULL, NULL);
        assert_true(status == HOL_OK || status == HOL_ERR_NO_CONVERGENCE || status == HOL_ERR_NOT_FINITE ||
                    status == HOL_ERR_DEGENERATE);
        for (int64_t c = 0; c < a.n_chains; ++c) {
            const int64_t *atoms = a.atoms + a.first[c];
            int moved = 0;
            for (int64_t i = 0; i <= assembly_bonds(&a, c); ++i)
                moved |= memcmp(s.r + 3 * atoms[i], before.r + 3 * atoms[i], 3 * sizeof(double)) != 0;
            for (int64_t k = 0; moved && k < assembly_bonds(&a, c); ++k) {
                double square = 0;
                for (int x = 0; x < 3; ++x)
                    square += (s.r[3 * atoms[k + 1] + x] - s.r[3 * atoms[k] + x]) *
                              (s.r[3 * atoms[k + 1] + x] - s.r[3 * atoms[k] + x]);
                /* a solution far away has larger coordinates, but unit bonds keep a chain of 40 within 60 */
                CHECK_AT_MOST(fabs(square - 1), 4 * 60 * DBL_EPSILON);
            }
            if (!moved) assert_chain(&a, c, s.v, before.v);
        }
        end(&s), end(&before);
    }
    assembly_free(&a);
}

static void an_ill_posed_step_fails_cleanly_or_succeeds(void **state)
{
    (void)state;
    static const int64_t lengths[] = {100, 200, 1000, 5000};
    int failed = 0, solved = 0;
    for (int i = 0; i < (quick_run() ? 2 : 4); ++i)
        for (uint64_t seed = 0; seed < 10; ++seed) {
            chain one = chain_make(CHAIN_NEARLY_STRAIGHT, lengths[i], seed);
            assembly a = assembly_make(&one, 1, IN_ORDER, 0);
            CHECK(hol_project_velocities(a.chains, a.r, a.v, NULL, NULL));
            double *q = copy_of(a.r, assembly_size(&a)), *v = copy_of(a.v, assembly_size(&a));
            for (size_t x = 0; x < assembly_size(&a); ++x) q[x] += 0.02 * a.v[x];
            double *before = copy_of(q, assembly_size(&a));
            hol_worst worst;
            const int status = hol_project_positions(a.chains, a.r, q, v, 0.02, NULL, 0, NULL, NULL);
            if (status == HOL_OK) {
                ++solved;
                CHECK(hol_violation(a.chains, q, NULL, &worst));
                CHECK_AT_MOST(worst.length, 4 * DBL_EPSILON * (double)lengths[i]);
            } else {
                ++failed;
                assert_true(status == HOL_ERR_NO_CONVERGENCE || status == HOL_ERR_NOT_FINITE);
                assert_same_bits(q, before, assembly_size(&a));
                assert_same_bits(v, a.v, assembly_size(&a));
            }
            free(q), free(v), free(before);
            assembly_free(&a);
            chain_free(&one);
        }
    print_message("nearly straight, dt 0.02: %d solved, %d refused\n", solved, failed);
}

/** Bonds of length 1 along z, all alike, of old positions `before` apart and of new ones `now` apart at an angle. */
static void project_single_bonds(int n, double before, double now)
{
    const double mass[8] = {1, 1, 1, 1, 1, 1, 1, 1}, length = 1;
    double ref[24] = {0}, r[24] = {0}, old[24];
    hol_chains *chains;
    CHECK(hol_chains_create(2 * n, mass, &chains));
    CHECK(hol_chains_add_block(chains, n, 1, 0, &length));
    CHECK(hol_chains_set_checks(chains, HOL_NEVER));
    for (int c = 0; c < n; ++c) {
        ref[6 * c + 5] = before;
        r[6 * c + 4] = 0.3 * now;
        r[6 * c + 5] = now;
    }
    memcpy(old, r, sizeof r);
    hol_report report;
    const int status = hol_project_positions(chains, ref, r, NULL, 1, NULL, 0, NULL, &report);
    if (status == HOL_OK) {
        hol_worst worst;
        CHECK(hol_violation(chains, r, NULL, &worst));
        CHECK_AT_MOST(worst.length, 16 * DBL_EPSILON * (1 + now));  // of a, in units of the coordinates' rounding
        CHECK_AT_MOST(report.max_error, 32 * DBL_EPSILON * (1 + now));
    } else {
        assert_true(status == HOL_ERR_NO_CONVERGENCE || status == HOL_ERR_NOT_FINITE || status == HOL_ERR_DEGENERATE);
        assert_same_bits(r, old, 24);
    }
    if (fabs(log10(before)) < 100 && now < 3) assert_int_equal(status, HOL_OK);
    hol_chains_destroy(chains);
}

static void single_bonds_end_on_their_length_or_in_a_status(void **state)
{
    (void)state;
    const double now[] = {1e-3, 0.9, 1, 1.5, 10, 1e3, 1e6};
    for (int e = -300; e <= 300; e += 12)
        for (size_t i = 0; i < sizeof now / sizeof *now; ++i)
            for (int n = 1; n <= 4; n += 3) project_single_bonds(n, pow(10, e), now[i]);
}

static void a_reference_that_is_no_number_is_an_error_although_the_bonds_are_satisfied(void **state)
{
    (void)state;
    const int64_t lengths[] = {1, 2, 5, 50, 257, 1500};
    for (int i = 0; i < 6; ++i) {
        chain one = chain_make(CHAIN_COIL, lengths[i], 3);
        assembly a = assembly_make(&one, 1, IN_ORDER, 0);
        const size_t size = assembly_size(&a);
        double *ref = copy_of(a.r, size), *r = copy_of(a.r, size);
        CHECK(hol_project_positions(a.chains, ref, r, NULL, 1, NULL, 0, NULL, NULL));
        assert_same_bits(r, a.r, size);
        for (int spoiled = 0; spoiled < 6; ++spoiled) {
            const size_t x = (size_t)spoiled * (size - 1) / 5;
            ref[x] = spoiled % 2 ? HUGE_VAL : NAN;
            CHECK_FAILS(HOL_ERR_NOT_FINITE, hol_project_positions(a.chains, ref, r, NULL, 1, NULL, 0, NULL, NULL));
            assert_same_bits(r, a.r, size);
            ref[x] = a.r[x];
        }
        free(ref), free(r);
        assembly_free(&a);
        chain_free(&one);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(single_bonds_end_on_their_length_or_in_a_status),
        cmocka_unit_test(a_reference_that_is_no_number_is_an_error_although_the_bonds_are_satisfied),
        cmocka_unit_test(chains_that_cannot_reach_their_lengths_keep_every_bit),
        cmocka_unit_test(a_hard_bound_on_iterations_ends_in_a_status),
        cmocka_unit_test(wrong_arguments_are_refused_and_nothing_is_written),
        cmocka_unit_test(a_wild_guess_ends_on_the_lengths_or_in_a_status),
        cmocka_unit_test(an_ill_posed_step_fails_cleanly_or_succeeds),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
