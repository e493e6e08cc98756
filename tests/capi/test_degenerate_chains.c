/**
 * Chains without a solution, or with one that no number can hold: stretched taut between fixed atoms, two fixed atoms
 * in one bond, forces that overflow; and long chains, where the fault is met when most of the work is done.
 */
#include "assembly.h"
#include "check.h"
#include "spoil.h"

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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_chain_taut_between_fixed_atoms_is_degenerate),
        cmocka_unit_test(a_bond_between_two_fixed_atoms_is_degenerate),
        cmocka_unit_test(forces_that_overflow_are_not_finite),
        cmocka_unit_test(a_bad_long_chain_keeps_its_outputs),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
