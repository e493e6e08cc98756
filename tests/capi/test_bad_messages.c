/**
 * Which bad chain decides the status of a call, and which chain, bond or atom its message names.
 */
#include "assembly.h"
#include "check.h"
#include "from_one.h"
#include "spoil.h"

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
    hol_chains *const counted = from_one(a.chains);
    CHECK_FAILS(HOL_ERR_NOT_FINITE, hol_forces(counted, a.r, NULL, a.f, NULL, NULL, g, HOL_WRITE, NULL));
    assert_location(2, 3);
    hol_chains_destroy(counted);
    free(g);
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
    hol_chains *const counted[2] = {a.chains, from_one(a.chains)};
    for (int base = 0; base < 2; ++base) {
        const int64_t atom = a.atoms[a.first[3] + 2];
        char name[40];
        a.chains = counted[base];
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
    a.chains = counted[0];
    hol_chains_destroy(counted[1]);
    free(v);
    assembly_free(&a);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_first_bad_chain_decides_status_and_message),
        cmocka_unit_test(the_message_names_the_atom_or_bond_at_fault),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
