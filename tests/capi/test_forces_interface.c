/** hol_forces: outputs that are left out, added to or written over an input, and wrong arguments. */
#include "check.h"
#include "forces.h"

static void each_output_may_be_left_out_and_the_others_do_not_change(void **state)
{
    (void)state;
    assembly a = assembly_of_kind(CHAIN_HETEROGENEOUS, 20, 1, 40, IN_ORDER, 14);
    forces_results all = forces_of(&a, a.v, a.f);
    for (unsigned mask = 0; mask < 16; ++mask) {
        forces_results some = {
            untouched((size_t)a.n_bonds), untouched((size_t)a.n_bonds), untouched(assembly_size(&a)), {0}};
        double *virial = untouched(9);
        CHECK(hol_forces(a.chains, a.r, a.v, a.f, mask & 1 ? some.lambda : NULL, mask & 2 ? some.tension : NULL,
                         mask & 4 ? some.g : NULL, HOL_WRITE, mask & 8 ? virial : NULL));
        if (mask & 1) assert_same_bits(some.lambda, all.lambda, (size_t)a.n_bonds);
        if (mask & 2) assert_same_bits(some.tension, all.tension, (size_t)a.n_bonds);
        if (mask & 4) assert_same_bits(some.g, all.g, assembly_size(&a));
        if (mask & 8) assert_same_bits(virial, all.virial, 9);
        if (!(mask & 1)) assert_untouched(some.lambda, (size_t)a.n_bonds);
        if (!(mask & 2)) assert_untouched(some.tension, (size_t)a.n_bonds);
        if (!(mask & 4)) assert_untouched(some.g, assembly_size(&a));
        if (!(mask & 8)) assert_untouched(virial, 9);
        free(virial);
        forces_results_free(&some);
    }
    forces_results_free(&all);
    assembly_free(&a);
}

static void adding_mode_adds_and_atoms_of_no_chain_are_left_alone(void **state)
{
    (void)state;
    assembly a = assembly_of_kind(CHAIN_HETEROGENEOUS, 20, 1, 40, SCATTERED, 15);
    forces_results s = forces_of(&a, a.v, a.f);
    double *sum = copy_of(a.v, assembly_size(&a)), *in_place = copy_of(a.f, assembly_size(&a)),
           *bare = untouched(assembly_size(&a));
    unsigned char *used = calloc((size_t)a.n_atoms, 1);
    for (int64_t i = 0; i < a.n_bonds + a.n_chains; ++i) used[a.atoms[i]] = 1;
    CHECK(hol_forces(a.chains, a.r, a.v, a.f, NULL, NULL, sum, HOL_ADD, NULL));
    CHECK(hol_forces(a.chains, a.r, a.v, in_place, NULL, NULL, in_place, HOL_ADD, NULL));
    CHECK(hol_forces(a.chains, a.r, a.v, a.f, NULL, NULL, bare, HOL_WRITE, NULL));
    for (int64_t i = 0; i < 3 * a.n_atoms; ++i) {
        if (used[i / 3]) {
            assert_true(sum[i] == a.v[i] + s.g[i]);
            assert_true(in_place[i] == a.f[i] + s.g[i]);
        } else {
            assert_true(memcmp(sum + i, a.v + i, sizeof *sum) == 0);
            assert_true(memcmp(in_place + i, a.f + i, sizeof *sum) == 0);
            assert_untouched(bare + i, 1);
        }
    }
    free(used);
    free(sum);
    free(in_place);
    free(bare);
    forces_results_free(&s);
    assembly_free(&a);
}

static void forces_may_be_written_over_the_applied_forces(void **state)
{
    (void)state;
    static const int64_t longest[3] = {3, 40, 5000};
    for (int i = 0; i < 3; ++i) {
        assembly a = assembly_of_kind(CHAIN_HETEROGENEOUS, 12, longest[i], longest[i], IN_ORDER, 16);
        forces_results s = forces_of(&a, a.v, a.f);
        double *f = copy_of(a.f, assembly_size(&a));
        CHECK(hol_forces(a.chains, a.r, a.v, f, NULL, NULL, f, HOL_WRITE, NULL));
        assert_same_bits(f, s.g, assembly_size(&a));
        free(f);
        forces_results_free(&s);
        assembly_free(&a);
    }
}

static void forces_refuse_wrong_arguments_and_write_nothing(void **state)
{
    (void)state;
    assembly a = assembly_of_kind(CHAIN_COIL, 3, 4, 4, IN_ORDER, 17);
    double *lambda = untouched(12), *tension = untouched(12), *g = untouched(45), *virial = untouched(9);
    CHECK_FAILS(HOL_ERR_NULL, hol_forces(NULL, a.r, a.v, a.f, lambda, tension, g, HOL_WRITE, virial));
    CHECK_FAILS(HOL_ERR_NULL, hol_forces(a.chains, NULL, a.v, a.f, lambda, tension, g, HOL_WRITE, virial));
    CHECK_FAILS(HOL_ERR_VALUE, hol_forces(a.chains, a.r, a.v, a.f, lambda, tension, g, 2, virial));
    CHECK_FAILS(HOL_ERR_VALUE, hol_forces(a.chains, a.r, a.v, a.f, lambda, tension, g, -1, virial));
    assert_untouched(lambda, 12);
    assert_untouched(tension, 12);
    assert_untouched(g, 45);
    assert_untouched(virial, 9);
    free(lambda);
    free(tension);
    free(g);
    free(virial);
    assembly_free(&a);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_output_may_be_left_out_and_the_others_do_not_change),
        cmocka_unit_test(adding_mode_adds_and_atoms_of_no_chain_are_left_alone),
        cmocka_unit_test(forces_may_be_written_over_the_applied_forces),
        cmocka_unit_test(forces_refuse_wrong_arguments_and_write_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
