/**
 * Chains with bad data among good ones: a bad chain's outputs keep every bit, the good ones are complete, sums are not
 * written, and the message names the first bad chain and how many there are.
 */
#include "assembly.h"
#include "check.h"

enum { CHAINS = 29, VERBS = 3 };

/** What spoils a chain. */
typedef enum spoiler {
    NAN_POSITION,
    INFINITE_POSITION,
    NAN_VELOCITY,
    NAN_FORCE,
    INFINITE_FORCE,
    ZERO_BOND,
    OVERFLOWING_BOND,
    SPOILERS
} spoiler;

static const char *const words[SPOILERS] = {"nan position", "infinite position", "nan velocity",    "nan force",
                                            "infinite force", "zero bond",       "overflowing bond"};

/** Spoils one chain at its atom `at` (1 or more). */
static void spoil(assembly *a, int64_t c, int64_t at, spoiler how)
{
    const int64_t atom = a->atoms[a->first[c] + at], before = a->atoms[a->first[c] + at - 1];
    switch (how) {
    case NAN_POSITION: a->r[3 * atom + 1] = NAN; break;
    case INFINITE_POSITION: a->r[3 * atom + 2] = INFINITY; break;
    case NAN_VELOCITY: a->v[3 * atom] = NAN; break;
    case NAN_FORCE: a->f[3 * atom + 2] = NAN; break;
    case INFINITE_FORCE: a->f[3 * atom + 1] = -INFINITY; break;
    case ZERO_BOND: memcpy(a->r + 3 * atom, a->r + 3 * before, 3 * sizeof(double)); break;
    case OVERFLOWING_BOND: a->r[3 * atom] = 1e300; break;
    default: break;
    }
}

static int expected_status(spoiler how)
{
    return how == ZERO_BOND ? HOL_ERR_DEGENERATE : HOL_ERR_NOT_FINITE;
}

/** Compares the outputs per atom of chain c with before (bad chain) or with those of the unspoilt run. */
static void assert_chain(const assembly *a, int64_t c, const double *got, const double *expected)
{
    const size_t size = 3 * ((size_t)assembly_bonds(a, c) + 1);
    double *x = untouched(size), *y = untouched(size);
    assembly_take(a, c, got, x);
    assembly_take(a, c, expected, y);
    assert_same_bits(x, y, size);
    free(x);
    free(y);
}

static void assert_location(int64_t first, int64_t bad)
{
    int64_t where = -9, count = -9;
    char name[64];
    hol_error_location(&where, NULL, NULL, &count);
    assert_int_equal(where, first);
    assert_int_equal(count, bad);
    snprintf(name, sizeof name, "%lld", (long long)first);
    assert_message_names(name);
    snprintf(name, sizeof name, "%lld", (long long)bad);
    if (bad > 1) assert_message_names(name);
}

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
        print_message("%s\n", words[how]);
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
        print_message("%s\n", words[how]);
        velocities_with((spoiler)how, one, 1);
        velocities_with((spoiler)how, several, 4);
    }
}

/** spoilt: which array has the bad number; 0 reference positions, 1 drifted positions. */
static void positions_with(spoiler how, int spoilt, const int64_t *bad, int n_bad)
{
    const double dt = 0.004;
    assembly a = assembly_of_kind(CHAIN_HETEROGENEOUS, CHAINS, 2, 40, SCATTERED, 23);
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
        print_message("reference: %s\n", words[of_reference[i]]);
        positions_with(of_reference[i], 0, one, 1);
        positions_with(of_reference[i], 0, several, 5);
    }
    for (int i = 0; i < 3; ++i) {
        print_message("drifted: %s\n", words[of_drifted[i]]);
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
    double *r = copy_of(a.r, size), *expected = copy_of(a.r, size), *v = copy_of(a.v, size), *expected_v = copy_of(a.v, size);
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

static void the_first_bad_chain_decides_status_and_message(void **state)
{
    (void)state;
    assembly a = assembly_of_kind(CHAIN_COIL, 12, 5, 5, IN_ORDER, 24);
    spoil(&a, 9, 2, NAN_POSITION);
    spoil(&a, 4, 3, ZERO_BOND);
    double *g = untouched(assembly_size(&a));
    int64_t where, bond;
    CHECK_FAILS(HOL_ERR_DEGENERATE, hol_forces(a.chains, a.r, NULL, a.f, NULL, NULL, g, HOL_WRITE, NULL));
    assert_location(4, 2);
    hol_error_location(&where, &bond, NULL, NULL);
    assert_int_equal(where, 4);
    assert_int_equal(bond, 2); /* the bond between atoms 2 and 3 of the chain, counted from 0 */
    spoil(&a, 1, 1, NAN_FORCE);
    CHECK_FAILS(HOL_ERR_NOT_FINITE, hol_forces(a.chains, a.r, NULL, a.f, NULL, NULL, g, HOL_WRITE, NULL));
    assert_location(1, 3);
    CHECK(hol_chains_set_index_base(a.chains, 1));
    CHECK_FAILS(HOL_ERR_NOT_FINITE, hol_forces(a.chains, a.r, NULL, a.f, NULL, NULL, g, HOL_WRITE, NULL));
    assert_location(2, 3);
    free(g);
    assembly_free(&a);
}

static void a_bad_long_chain_keeps_its_outputs(void **state)
{
    (void)state;
    /* long chains are worked on in pieces; the bad number stands near the end, when most of it is done */
    static const int64_t lengths[] = {1000, 9000, 60000};
    for (int i = 0; i < 3; ++i) {
        const int64_t n = lengths[i];
        chain one = chain_make(CHAIN_COIL, n, 6);
        assembly a = assembly_make(&one, 1, IN_ORDER, 0);
        a.f[3 * (n - 2)] = NAN;
        double *lambda = untouched((size_t)n), *g = untouched(assembly_size(&a)), *virial = untouched(9);
        CHECK_FAILS(HOL_ERR_NOT_FINITE, hol_forces(a.chains, a.r, a.v, a.f, lambda, NULL, g, HOL_WRITE, virial));
        assert_untouched(lambda, (size_t)n);
        assert_untouched(g, assembly_size(&a));
        assert_untouched(virial, 9);
        a.f[3 * (n - 2)] = 1;
        CHECK(hol_forces(a.chains, a.r, a.v, a.f, lambda, NULL, g, HOL_WRITE, virial));
        a.r[3 * (n - 1) + 1] = INFINITY;
        double *v = copy_of(a.v, assembly_size(&a));
        CHECK_FAILS(HOL_ERR_NOT_FINITE, hol_project_velocities(a.chains, a.r, v, NULL, NULL));
        assert_same_bits(v, a.v, assembly_size(&a));
        free(v), free(lambda), free(g), free(virial);
        assembly_free(&a);
        chain_free(&one);
    }
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

static void a_chain_taut_between_fixed_atoms_is_degenerate(void **state)
{
    (void)state;
    for (int64_t n = 1; n <= 40; n += 3) {
        chain parts[3] = {chain_make(CHAIN_COIL, n, 1), chain_make(CHAIN_STRAIGHT, n, 2), chain_make(CHAIN_COIL, n, 3)};
        parts[1].mass[0] = parts[1].mass[n] = 0;
        assembly a = assembly_make(parts, 3, IN_ORDER, 0);
        double *lambda = untouched((size_t)a.n_bonds), *v = copy_of(a.v, assembly_size(&a));
        CHECK_FAILS(HOL_ERR_DEGENERATE, hol_forces(a.chains, a.r, a.v, a.f, lambda, NULL, NULL, HOL_WRITE, NULL));
        assert_location(1, 1);
        assert_untouched(lambda + n, (size_t)n);
        assert_true(isfinite(lambda[0]) && isfinite(lambda[2 * n]));
        CHECK_FAILS(HOL_ERR_DEGENERATE, hol_project_velocities(a.chains, a.r, v, NULL, NULL));
        assert_chain(&a, 1, v, a.v);
        free(lambda), free(v);
        assembly_free(&a);
        for (int c = 0; c < 3; ++c) chain_free(parts + c);
    }
}

static void a_bond_between_two_fixed_atoms_is_degenerate(void **state)
{
    (void)state;
    chain one = chain_make(CHAIN_COIL, 9, 1);
    one.mass[4] = one.mass[5] = 0;
    assembly a = assembly_make(&one, 1, IN_ORDER, 0);
    double *g = untouched(30);
    CHECK_FAILS(HOL_ERR_DEGENERATE, hol_forces(a.chains, a.r, a.v, a.f, NULL, NULL, g, HOL_WRITE, NULL));
    assert_untouched(g, 30);
    free(g);
    assembly_free(&a);
    chain_free(&one);
}

static void forces_that_overflow_are_not_finite(void **state)
{
    (void)state;
    assembly a = assembly_of_kind(CHAIN_COIL, 5, 6, 6, IN_ORDER, 26);
    for (int i = 0; i < 3; ++i) a.f[3 * a.atoms[a.first[2] + 3] + i] = 1.7e308;
    a.f[3 * a.atoms[a.first[2] + 2]] = -1.7e308;
    double *lambda = untouched((size_t)a.n_bonds);
    const int status = hol_forces(a.chains, a.r, NULL, a.f, lambda, NULL, NULL, HOL_WRITE, NULL);
    /* either the result is representable and written, or the chain is refused: nothing in between */
    if (status == HOL_OK)
        for (int64_t k = 0; k < a.n_bonds; ++k) assert_true(isfinite(lambda[k]));
    else {
        assert_int_equal(status, HOL_ERR_NOT_FINITE);
        assert_untouched(lambda + 12, 6);
    }
    free(lambda);
    assembly_free(&a);
}

static void assert_names(int64_t first, int64_t bond, int64_t atom, const char *name)
{
    int64_t c, b, a;
    hol_error_location(&c, &b, &a, NULL);
    assert_int_equal(c, first);
    assert_int_equal(b, bond);
    assert_int_equal(a, atom);
    assert_message_names(name);
}

static void the_message_names_the_atom_or_bond_at_fault(void **state)
{
    (void)state;
    assembly a = assembly_of_kind(CHAIN_COIL, 7, 5, 5, SCATTERED, 27);
    double *v = copy_of(a.v, assembly_size(&a)), lambda[35];
    hol_worst worst;
    for (int base = 0; base < 2; ++base) {
        const int64_t atom = a.atoms[a.first[3] + 2];
        char name[40];
        CHECK(hol_chains_set_index_base(a.chains, base));
        snprintf(name, sizeof name, "atom %lld", (long long)atom + base);
        double *const places[3] = {a.r + 3 * atom + 1, v + 3 * atom, a.f + 3 * atom + 2};
        for (int k = 0; k < 3; ++k) {
            const double kept = *places[k];
            *places[k] = k == 1 ? INFINITY : NAN;
            CHECK_FAILS(HOL_ERR_NOT_FINITE, hol_forces(a.chains, a.r, v, a.f, lambda, NULL, NULL, HOL_WRITE, NULL));
            assert_names(3 + base, -1, atom + base, name);
            if (k < 2) {
                CHECK_FAILS(HOL_ERR_NOT_FINITE, hol_project_velocities(a.chains, a.r, v, NULL, NULL));
                assert_names(3 + base, -1, atom + base, name);
                CHECK_FAILS(HOL_ERR_NOT_FINITE, hol_violation(a.chains, a.r, v, &worst));
                assert_names(3 + base, -1, atom + base, name);
            }
            *places[k] = kept;
        }
        memcpy(a.r + 3 * a.atoms[a.first[6] + 4], a.r + 3 * a.atoms[a.first[6] + 5], 3 * sizeof(double));
        CHECK_FAILS(HOL_ERR_DEGENERATE, hol_project_velocities(a.chains, a.r, v, NULL, NULL));
        snprintf(name, sizeof name, "bond %d", 4 + base);
        assert_names(6 + base, 4 + base, -1, name);
    }
    free(v);
    assembly_free(&a);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(forces_keep_bad_chains_and_complete_the_others),
        cmocka_unit_test(velocities_keep_bad_chains_and_complete_the_others),
        cmocka_unit_test(positions_keep_bad_chains_and_complete_the_others),
        cmocka_unit_test(velocities_that_are_not_finite_are_added_to_and_not_checked),
        cmocka_unit_test(the_first_bad_chain_decides_status_and_message),
        cmocka_unit_test(a_bad_long_chain_keeps_its_outputs),
        cmocka_unit_test(a_bad_chain_keeps_applied_forces_that_it_would_overwrite),
        cmocka_unit_test(a_chain_taut_between_fixed_atoms_is_degenerate),
        cmocka_unit_test(a_bond_between_two_fixed_atoms_is_degenerate),
        cmocka_unit_test(forces_that_overflow_are_not_finite),
        cmocka_unit_test(the_message_names_the_atom_or_bond_at_fault),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
