/**
 * Chains with bad data among good ones: a bad chain's outputs keep every bit, the good ones are complete, sums are not
 * written, and the message names the first bad chain and how many there are.
 */
#include "assembly.h"
#include "check.h"
#include "spoil.h"

enum { CHAINS = 29 };

static int is_bad(const int64_t *bad, int n_bad, int64_t c)
{
    for (int i = 0; i < n_bad; ++i)
        if (bad[i] == c) return 1;
    return 0;
}

static void forces_with(spoiler how, const int64_t *bad, int n_bad, int threads)
{
    assembly a = assembly_of_kind(CHAIN_HETEROGENEOUS, CHAINS, 2, 40, SCATTERED, 21);
    const size_t n = (size_t)a.n_bonds, size = assembly_size(&a);
    double *lambda = untouched(n), *tension = untouched(n), *g = untouched(size), *virial = untouched(9);
    double *good_lambda = untouched(n), *good_g = untouched(size), *before = untouched(size);
    CHECK(hol_chains_set_threads(a.chains, threads));
    CHECK(hol_forces(a.chains, a.r, a.v, a.f, good_lambda, NULL, good_g, HOL_WRITE, NULL));
    for (int i = 0; i < n_bad; ++i) spoil(&a, bad[i], 1 + i % (int)assembly_bonds(&a, bad[i]), how);
    CHECK_FAILS(expected_status(how), hol_forces(a.chains, a.r, a.v, a.f, lambda, tension, g, HOL_WRITE, virial));
    assert_location(bad[0], n_bad);
    assert_untouched(virial, 9);
    for (int64_t c = 0; c < CHAINS; ++c) {
        const size_t at = (size_t)a.first_bond[c], bonds = (size_t)assembly_bonds(&a, c);
        if (is_bad(bad, n_bad, c)) {
            assert_untouched(lambda + at, bonds);
            assert_untouched(tension + at, bonds);
            assert_chain(&a, c, g, before);
        } else {
            assert_same_bits(lambda + at, good_lambda + at, bonds);
            assert_chain(&a, c, g, good_g);
        }
    }
    free(lambda), free(tension), free(g), free(virial), free(good_lambda), free(good_g), free(before);
    assembly_free(&a);
}

static void forces_keep_bad_chains_and_complete_the_others(void **state)
{
    (void)state;
    static const int64_t one[] = {13}, first[] = {0}, last[] = {CHAINS - 1}, several[] = {2, 3, 4, 5, 17, 28};
    for (int how = 0; how < SPOILERS; ++how) {
        print_message("%s\n", spoiler_words[how]);
        forces_with((spoiler)how, one, 1, 1);
        if (quick_run()) continue;
        forces_with((spoiler)how, first, 1, 1);
        forces_with((spoiler)how, last, 1, 1);
        forces_with((spoiler)how, several, 6, 1);
        forces_with((spoiler)how, several, 6, 3);
    }
}

static void velocities_with(spoiler how, const int64_t *bad, int n_bad)
{
    assembly a = assembly_of_kind(CHAIN_HETEROGENEOUS, CHAINS, 2, 40, SCATTERED, 22);
    const size_t n = (size_t)a.n_bonds, size = assembly_size(&a);
    double *lambda = untouched(n), *virial = untouched(9), *good_lambda = untouched(n), *good_v = copy_of(a.v, size);
    CHECK(hol_project_velocities(a.chains, a.r, good_v, good_lambda, NULL));
    for (int i = 0; i < n_bad; ++i) spoil(&a, bad[i], 1 + i % (int)assembly_bonds(&a, bad[i]), how);
    double *v = copy_of(a.v, size);
    CHECK_FAILS(expected_status(how), hol_project_velocities(a.chains, a.r, v, lambda, virial));
    assert_location(bad[0], n_bad);
    assert_untouched(virial, 9);
    for (int64_t c = 0; c < CHAINS; ++c) {
        const size_t at = (size_t)a.first_bond[c], bonds = (size_t)assembly_bonds(&a, c);
        const int wrong = is_bad(bad, n_bad, c);
        if (wrong)
            assert_untouched(lambda + at, bonds);
        else
            assert_same_bits(lambda + at, good_lambda + at, bonds);
        assert_chain(&a, c, v, wrong ? a.v : good_v);
    }
    free(lambda), free(virial), free(good_lambda), free(good_v), free(v);
    assembly_free(&a);
}

static void velocities_keep_bad_chains_and_complete_the_others(void **state)
{
    (void)state;
    static const int64_t one[] = {7}, several[] = {0, 1, 9, 27};
    for (int how = 0; how < SPOILERS; ++how) {
        if (how == NAN_FORCE || how == INFINITE_FORCE) continue; /* not an input of this verb */
        print_message("%s\n", spoiler_words[how]);
        velocities_with((spoiler)how, one, 1);
        velocities_with((spoiler)how, several, 4);
    }
}

/** spoilt: which array has the bad number; 0 reference positions, 1 drifted positions. */
static void positions_with(spoiler how, int spoilt, const int64_t *bad, int n_bad)
{
    const double dt = 0.004;
    assembly a = assembly_of_kind(CHAIN_HETEROGENEOUS, CHAINS, 2, 40, SCATTERED, 23);
    CHECK(hol_chains_set_checks(a.chains, HOL_NEVER)); /* what the arithmetic itself finds */
    const size_t n = (size_t)a.n_bonds, size = assembly_size(&a);
    double *drifted = copy_of(a.r, size);
    for (size_t i = 0; i < size; ++i) drifted[i] += dt * a.v[i];
    double *lambda = untouched(n), *virial = untouched(9), *good_lambda = untouched(n);
    double *good_r = copy_of(drifted, size), *good_v = copy_of(a.v, size);
    CHECK(hol_project_positions(a.chains, a.r, good_r, good_v, dt, good_lambda, 0, NULL, NULL));
    assembly spoilt_copy = a; /* spoil() works on the arrays it finds */
    if (spoilt == 1) spoilt_copy.r = drifted;
    for (int i = 0; i < n_bad; ++i) spoil(&spoilt_copy, bad[i], 1 + i % (int)assembly_bonds(&a, bad[i]), how);
    double *r = copy_of(drifted, size), *v = copy_of(a.v, size);
    hol_report report;
    /* positions too far away to be corrected are finite, if the squares of their distances are not */
    const int status = spoilt == 1 && how == OVERFLOWING_BOND ? HOL_ERR_NO_CONVERGENCE : expected_status(how);
    CHECK_FAILS(status, hol_project_positions(a.chains, a.r, r, v, dt, lambda, 0, virial, &report));
    assert_location(bad[0], n_bad);
    assert_untouched(virial, 9);
    assert_int_equal(report.n_failed, n_bad);
    assert_int_equal(report.n_corrected, CHAINS - n_bad);
    CHECK_AT_MOST(report.max_error, 100 * DBL_EPSILON); /* coordinates up to 40, rounding 20 eps of the length */
    for (int64_t c = 0; c < CHAINS; ++c) {
        const size_t at = (size_t)a.first_bond[c], bonds = (size_t)assembly_bonds(&a, c);
        const int wrong = is_bad(bad, n_bad, c);
        if (wrong)
            assert_untouched(lambda + at, bonds);
        else
            assert_same_bits(lambda + at, good_lambda + at, bonds);
        assert_chain(&a, c, r, wrong ? drifted : good_r);
        assert_chain(&a, c, v, wrong ? a.v : good_v);
    }
    free(drifted), free(lambda), free(virial), free(good_lambda), free(good_r), free(good_v), free(r), free(v);
    assembly_free(&a);
}

static void positions_keep_bad_chains_and_complete_the_others(void **state)
{
    (void)state;
    static const int64_t one[] = {28}, several[] = {3, 4, 5, 6, 7};
    static const spoiler of_reference[] = {NAN_POSITION, INFINITE_POSITION, ZERO_BOND, OVERFLOWING_BOND};
    static const spoiler of_drifted[] = {NAN_POSITION, INFINITE_POSITION, OVERFLOWING_BOND};
    for (int i = 0; i < 4; ++i) {
        print_message("reference: %s\n", spoiler_words[of_reference[i]]);
        positions_with(of_reference[i], 0, one, 1);
        positions_with(of_reference[i], 0, several, 5);
    }
    for (int i = 0; i < 3; ++i) {
        print_message("drifted: %s\n", spoiler_words[of_drifted[i]]);
        positions_with(of_drifted[i], 1, one, 1);
        positions_with(of_drifted[i], 1, several, 5);
    }
}

static void velocities_that_are_not_finite_are_added_to_and_not_checked(void **state)
{
    (void)state;
    const double dt = 0.004;
    assembly a = assembly_of_kind(CHAIN_COIL, 9, 2, 30, IN_ORDER, 28);
    const size_t size = assembly_size(&a);
    double *r = copy_of(a.r, size), *expected = copy_of(a.r, size), *v = copy_of(a.v, size),
           *expected_v = copy_of(a.v, size);
    for (size_t i = 0; i < size; ++i) r[i] = expected[i] += dt * a.v[i];
    spoil(&a, 4, 2, NAN_VELOCITY);
    memcpy(v, a.v, size * sizeof *v);
    CHECK(hol_project_positions(a.chains, a.r, expected, expected_v, dt, NULL, 0, NULL, NULL));
    CHECK(hol_project_positions(a.chains, a.r, r, v, dt, NULL, 0, NULL, NULL));
    assert_same_bits(r, expected, size);
    for (size_t i = 0; i < size; ++i) {
        if (isnan(a.v[i]))
            assert_true(isnan(v[i]));
        else
            assert_same_bits(v + i, expected_v + i, 1);
    }
    free(r), free(expected), free(v), free(expected_v);
    assembly_free(&a);
}

static void a_bad_chain_keeps_applied_forces_that_it_would_overwrite(void **state)
{
    (void)state;
    assembly a = assembly_of_kind(CHAIN_COIL, 9, 20, 20, IN_ORDER, 25);
    spoil(&a, 5, 15, NAN_POSITION);
    for (int mode = HOL_WRITE; mode <= HOL_ADD; ++mode) {
        double *f = copy_of(a.f, assembly_size(&a));
        CHECK_FAILS(HOL_ERR_NOT_FINITE, hol_forces(a.chains, a.r, a.v, f, NULL, NULL, f, mode, NULL));
        assert_chain(&a, 5, f, a.f);
        free(f);
    }
    assembly_free(&a);
}

/* The last bond's pivot is infinite then, and its multiplier would be zero: no bond behind it tells. */
static void an_overflowing_bond_is_found_wherever_it_is(void **state)
{
    (void)state;
    for (int64_t n = 1; n <= 10; ++n)
        for (int at = 1; at <= (int)n; ++at)
            for (int64_t chains = 1; chains <= 20; chains += 19) {
                assembly a = assembly_of_kind(CHAIN_HETEROGENEOUS, chains, n, n, at % 2 ? IN_ORDER : SCATTERED, 26);
                const size_t size = assembly_size(&a), bonds = (size_t)a.n_bonds;
                const int64_t bad = chains / 2;
                CHECK(hol_chains_set_checks(a.chains, HOL_NEVER));
                spoil(&a, bad, at, OVERFLOWING_BOND);
                double *lambda = untouched(bonds), *g = untouched(size), *before = untouched(size);
                double *v = copy_of(a.v, size), *r = copy_of(a.r, size);
                const double *here = lambda + a.first_bond[bad];
                CHECK_FAILS(HOL_ERR_NOT_FINITE, hol_forces(a.chains, a.r, a.v, a.f, lambda, NULL, g, HOL_WRITE, NULL));
                assert_untouched(here, (size_t)n);
                assert_chain(&a, bad, g, before);
                CHECK_FAILS(HOL_ERR_NOT_FINITE, hol_project_velocities(a.chains, a.r, v, lambda, NULL));
                assert_untouched(here, (size_t)n);
                assert_chain(&a, bad, v, a.v);
                CHECK_FAILS(HOL_ERR_NOT_FINITE,
                            hol_project_positions(a.chains, a.r, r, v, 0.004, lambda, 0, NULL, NULL));
                assert_untouched(here, (size_t)n);
                assert_chain(&a, bad, r, a.r);
                free(lambda), free(g), free(before), free(v), free(r);
                assembly_free(&a);
            }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(forces_keep_bad_chains_and_complete_the_others),
        cmocka_unit_test(velocities_keep_bad_chains_and_complete_the_others),
        cmocka_unit_test(positions_keep_bad_chains_and_complete_the_others),
        cmocka_unit_test(an_overflowing_bond_is_found_wherever_it_is),
        cmocka_unit_test(velocities_that_are_not_finite_are_added_to_and_not_checked),
        cmocka_unit_test(a_bad_chain_keeps_applied_forces_that_it_would_overwrite),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
