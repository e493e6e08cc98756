/**
 * Every allocation of hol_device_plan_create made to fail in turn: HOL_ERR_MEMORY, no plan, nothing leaked, and then
 * the plan is as it would have been. What a plan hands out needs no memory.
 */
#include "check.h"
#include "failing_allocations.h"

enum { ATOMS = 3 * 2 + 5 + 41 + 3, LEFT = 4 };

/** Two waters, CH4, a chain of 40 bonds, and a body, which is left to the host. */
static hol_chains *some_molecules(void)
{
    static const int64_t water[6] = {0, 1, 0, 2, 1, 2}, dioxide[6] = {52, 53, 52, 54, 53, 54};
    static const int64_t methane[8] = {6, 7, 6, 8, 6, 9, 6, 10};
    static const double sides[3] = {1, 1, 1.5}, line[3] = {1, 1, 2};
    double mass[ATOMS], ones[40];
    hol_chains *chains = NULL;
    for (int i = 0; i < ATOMS; ++i) mass[i] = 1 + i % 3;
    for (int k = 0; k < 40; ++k) ones[k] = 1;
    CHECK(hol_chains_create(ATOMS, mass, &chains));
    CHECK(hol_chains_add_molecules(chains, 2, 3, 0, 3, water, sides));
    CHECK(hol_chains_add_bonds(chains, 4, methane, ones));
    CHECK(hol_chains_add_block(chains, 1, 40, 11, ones));
    CHECK(hol_chains_add_bonds(chains, 3, dioxide, line));
    return chains;
}

static void assert_same_plans(const hol_device_plan *one, const hol_device_plan *other)
{
    assert_string_equal(hol_device_plan_source(one), hol_device_plan_source(other));
    assert_int_equal(hol_device_plan_n_launches(one), hol_device_plan_n_launches(other));
    for (int which = 0; which < 4; ++which) {
        const void *data[2];
        int64_t bytes[2];
        CHECK(hol_device_plan_array(one, (hol_device_array)which, &data[0], &bytes[0]));
        CHECK(hol_device_plan_array(other, (hol_device_array)which, &data[1], &bytes[1]));
        assert_int_equal(bytes[0], bytes[1]);
        assert_true((data[0] == NULL) == (data[1] == NULL));
        if (data[0]) assert_memory_equal(data[0], data[1], (size_t)bytes[0]);
    }
}

static void plans_are_not_made_without_memory(void **state)
{
    (void)state;
    static const int64_t max_entries[2] = {-1, 2}; /* a work-item for all; groups for CH4 and the chain */
    hol_chains *const chains = some_molecules();
    for (int i = 0; i < 2; ++i) {
        hol_device_plan *right = NULL, *plan;
        CHECK(hol_device_plan_create(chains, HOL_DEVICE_MIXED, max_entries[i], &right));
        const long in_use = blocks_in_use();
        long good = 0;
        for (;; ++good) {
            plan = (hol_device_plan *)&good;
            fail_after(good);
            const int status = hol_device_plan_create(chains, HOL_DEVICE_MIXED, max_entries[i], &plan);
            const long no = refused();
            fail_no_more();
            if (no == 0) {
                assert_int_equal(status, HOL_OK);
                break;
            }
            assert_int_equal(status, HOL_ERR_MEMORY);
            assert_null(plan);
            assert_int_equal(blocks_in_use(), in_use);
        }
        print_message("%ld allocations failed in turn\n", good);
        assert_true(good > 100);
        assert_same_plans(plan, right);
        hol_device_plan_destroy(plan);
        assert_int_equal(blocks_in_use(), in_use);
        hol_device_plan_destroy(right);
    }
    hol_chains_destroy(chains);
}

static void what_a_plan_hands_out_needs_no_memory(void **state)
{
    (void)state;
    hol_chains *const chains = some_molecules();
    hol_device_plan *plan;
    const void *data;
    const char *names[2];
    int64_t bytes, n_groups, size, left = -1;
    CHECK(hol_device_plan_create(chains, HOL_DEVICE_SINGLE, -1, &plan));
    assert_int_equal(hol_device_plan_n_left(plan), 1);
    fail_after(0);
    const int statuses[3] = {hol_device_plan_array(plan, HOL_DEVICE_NUMBERS, &data, &bytes),
                             hol_device_plan_launch(plan, 0, &names[0], &names[1], &n_groups, &size),
                             hol_device_plan_left(plan, &left)};
    const long no = refused();
    fail_no_more();
    assert_int_equal(no, 0);
    for (int k = 0; k < 3; ++k) assert_int_equal(statuses[k], HOL_OK);
    assert_int_equal(left, LEFT);
    hol_device_plan_destroy(plan);
    hol_chains_destroy(chains);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(plans_are_not_made_without_memory),
        cmocka_unit_test(what_a_plan_hands_out_needs_no_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
