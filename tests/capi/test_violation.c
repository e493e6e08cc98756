/** Largest violation of the constraints, and where it is. */
#include "assembly.h"
#include "check.h"
#include "from_one.h"

static void violation_finds_the_worst_bond_of_all_chains(void **state)
{
    (void)state;
    for (int threads = 1; threads <= 3; ++threads) {
        assembly a = assembly_of_kind(CHAIN_HETEROGENEOUS, 61, 1, 70, SCATTERED, 101);
        CHECK(hol_chains_set_threads(a.chains, threads));
        for (size_t i = 0; i < assembly_size(&a); ++i) a.r[i] += 1e-4 * a.v[i];
        long double length = -1, rate = -1;
        int64_t where[4] = {0};
        for (int64_t c = 0; c < a.n_chains; ++c)
            for (int64_t k = 0; k < assembly_bonds(&a, c); ++k) {
                const int64_t i = 3 * a.atoms[a.first[c] + k], j = 3 * a.atoms[a.first[c] + k + 1];
                const long double l = a.length[a.first_bond[c] + k];
                long double square = 0, product = 0;
                for (int x = 0; x < 3; ++x) {
                    const long double d = (long double)a.r[j + x] - a.r[i + x];
                    square += d * d;
                    product += d * ((long double)a.v[j + x] - a.v[i + x]);
                }
                if (fabsl(square - l * l) / (l * l) > length)
                    length = fabsl(square - l * l) / (l * l), where[0] = c, where[1] = k;
                if (fabsl(product) > rate) rate = fabsl(product), where[2] = c, where[3] = k;
            }
        hol_worst worst;
        CHECK(hol_violation(a.chains, a.r, a.v, &worst));
        CHECK_AT_MOST(fabsl(worst.length - length), 16 * DBL_EPSILON);
        CHECK_AT_MOST(fabsl(worst.rate - rate), 16 * DBL_EPSILON * rate);
        assert_int_equal(worst.length_molecule, where[0]);
        assert_int_equal(worst.length_bond, where[1]);
        assert_int_equal(worst.rate_molecule, where[2]);
        assert_int_equal(worst.rate_bond, where[3]);
        CHECK(hol_violation(a.chains, a.r, NULL, &worst));
        assert_true(worst.rate == 0);
        assert_int_equal(worst.length_molecule, where[0]);
        hol_chains *const counted = from_one(a.chains);
        CHECK(hol_violation(counted, a.r, a.v, &worst));
        assert_int_equal(worst.length_molecule, where[0] + 1);
        assert_int_equal(worst.length_bond, where[1] + 1);
        hol_chains_destroy(counted);
        assembly_free(&a);
    }
}

static void a_long_chain_is_searched_to_its_end(void **state)
{
    (void)state;
    chain one = chain_make(CHAIN_COIL, 20000, 1);
    one.r[3 * 20000] += 0.01 * (one.r[3 * 20000] - one.r[3 * 19999] > 0 ? 1 : -1);
    assembly a = assembly_make(&one, 1, IN_ORDER, 0);
    hol_worst worst;
    CHECK(hol_violation(a.chains, a.r, NULL, &worst));
    assert_int_equal(worst.length_bond, 19999);
    assembly_free(&a);
    chain_free(&one);
}

static void an_empty_set_has_no_violation(void **state)
{
    (void)state;
    const double mass = 1, r[3] = {0};
    hol_chains *c;
    hol_worst worst;
    CHECK(hol_chains_create(1, &mass, &c));
    CHECK(hol_violation(c, r, r, &worst));
    assert_true(worst.length == 0 && worst.rate == 0);
    assert_int_equal(worst.length_molecule, -1);
    hol_chains_destroy(c);
}

static void not_finite_data_are_an_error_and_nothing_is_written(void **state)
{
    (void)state;
    assembly a = assembly_of_kind(CHAIN_COIL, 9, 3, 30, IN_ORDER, 102);
    hol_worst worst, same;
    memset(&worst, 0x5a, sizeof worst);
    memset(&same, 0x5a, sizeof same);
    a.v[3 * a.atoms[a.first[4] + 2]] = NAN;
    CHECK_FAILS(HOL_ERR_NOT_FINITE, hol_violation(a.chains, a.r, a.v, &worst));
    assert_memory_equal(&worst, &same, sizeof worst);
    int64_t where;
    hol_error_location(&where, NULL, NULL, NULL);
    assert_int_equal(where, 4);
    CHECK(hol_violation(a.chains, a.r, NULL, &worst));
    memset(&worst, 0x5a, sizeof worst);
    a.r[3 * a.atoms[a.first[7]]] = INFINITY;
    CHECK_FAILS(HOL_ERR_NOT_FINITE, hol_violation(a.chains, a.r, NULL, &worst));
    CHECK_FAILS(HOL_ERR_NULL, hol_violation(NULL, a.r, NULL, &worst));
    CHECK_FAILS(HOL_ERR_NULL, hol_violation(a.chains, NULL, NULL, &worst));
    CHECK_FAILS(HOL_ERR_NULL, hol_violation(a.chains, a.r, NULL, NULL));
    assert_memory_equal(&worst, &same, sizeof worst);
    assembly_free(&a);
}

static void a_bond_of_length_zero_is_a_violation_of_one(void **state)
{
    (void)state;
    const double mass[2] = {1, 1}, length = 3, r[6] = {1, 2, 3, 1, 2, 3};
    hol_chains *c;
    hol_worst worst;
    CHECK(hol_chains_create(2, mass, &c));
    CHECK(hol_chains_add_block(c, 1, 1, 0, &length));
    CHECK(hol_violation(c, r, NULL, &worst));
    assert_true(worst.length == 1);
    hol_chains_destroy(c);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(violation_finds_the_worst_bond_of_all_chains),
        cmocka_unit_test(a_long_chain_is_searched_to_its_end),
        cmocka_unit_test(an_empty_set_has_no_violation),
        cmocka_unit_test(not_finite_data_are_an_error_and_nothing_is_written),
        cmocka_unit_test(a_bond_of_length_zero_is_a_violation_of_one),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
