/**
 * Chains without a solution, or with one that no number can hold: stretched taut between fixed atoms, forces that
 * overflow; two fixed atoms in one bond, which is no constraint; and long chains, where the fault is met when most of
 * the work is done.
 */
#include "assembly.h"
#include "check.h"
#include "spoil.h"

static void a_chain_taut_between_fixed_atoms_is_degenerate(void **state)
{
    (void)state;
    for (int64_t n = 2; n <= 40; n += 3) { /* of one bond, it would be no constraint */
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

static void a_bond_between_two_fixed_atoms_is_no_constraint(void **state)
{
    (void)state;
    /* what is left are two chains, which give what they give by themselves */
    static const int64_t lengths[] = {9, 2000};
    for (int i = 0; i < 2; ++i) {
        const int64_t n = lengths[i], cut = n / 2, size = 3 * (n + 1);
        chain one = chain_make(CHAIN_COIL, n, 1);
        one.mass[cut] = one.mass[cut + 1] = 0;
        assembly a = assembly_make(&one, 1, IN_ORDER, 0);
        assert_int_equal(hol_chains_n_molecules(a.chains), 2);
        assert_int_equal(hol_chains_n_bonds(a.chains), n);
        assert_int_equal(hol_chains_degrees_of_freedom(a.chains, 3), 3 * (n - 1) - (n - 1));
        double *g = untouched((size_t)size), *lambda = untouched((size_t)n), *tension = untouched((size_t)n),
               *alone = untouched((size_t)n), *g_alone = untouched((size_t)size), virial[9];
        CHECK(hol_forces(a.chains, a.r, a.v, a.f, lambda, tension, g, HOL_WRITE, virial));
        assert_true(lambda[cut] == 0 && tension[cut] == 0);
        hol_chains *parts;
        CHECK(hol_chains_create(n + 1, one.mass, &parts));
        CHECK(hol_chains_add_block(parts, 1, cut, 0, one.length));
        CHECK(hol_chains_add_block(parts, 1, n - 1 - cut, cut + 1, one.length + cut + 1));
        CHECK(hol_forces(parts, a.r, a.v, a.f, alone, NULL, g_alone, HOL_WRITE, NULL));
        assert_same_bits(lambda, alone, (size_t)cut);
        assert_same_bits(lambda + cut + 1, alone + cut, (size_t)(n - 1 - cut));
        assert_same_bits(g, g_alone, (size_t)size);
        double *r = copy_of(a.r, (size_t)size), *v = copy_of(a.v, (size_t)size);
        CHECK(hol_project_velocities(a.chains, r, v, lambda, NULL));
        assert_true(lambda[cut] == 0);
        lambda[cut] = NAN;
        CHECK(hol_project_positions(a.chains, a.r, r, v, 1e-3, lambda, 0, NULL, NULL));
        assert_true(lambda[cut] == 0);
        hol_chains_destroy(parts);
        free(g), free(lambda), free(tension), free(alone), free(g_alone), free(r), free(v);
        assembly_free(&a);
        chain_free(&one);
    }
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
        cmocka_unit_test(a_bond_between_two_fixed_atoms_is_no_constraint),
        cmocka_unit_test(forces_that_overflow_are_not_finite),
        cmocka_unit_test(a_bad_long_chain_keeps_its_outputs),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
