/** Plans for kernels of an accelerator: what they hand out, what they refuse, what they leave to the host. */
#include "check.h"

static hol_device_plan *plan_of(const hol_chains *chains, hol_device_precision precision, int64_t max_entries)
{
    hol_device_plan *plan = NULL;
    CHECK(hol_device_plan_create(chains, precision, max_entries, &plan));
    assert_non_null(plan);
    return plan;
}

/* `count` waters, and then a chain of so many bonds. */
static hol_chains *waters_and_chain(int count, int n_bonds)
{
    const int n = 3 * count + n_bonds + 1;
    const double lengths[3] = {1, 1, 1.5};
    const int64_t water[6] = {0, 1, 0, 2, 1, 2};
    double *const mass = malloc((size_t)n * sizeof *mass);
    hol_chains *chains;
    for (int i = 0; i < n; ++i) mass[i] = i % 3 == 0 ? 16 : 1;
    CHECK(hol_chains_create(n, mass, &chains));
    CHECK(hol_chains_add_molecules(chains, count, 3, 0, 3, water, lengths));
    for (int i = 0; i < n; ++i) mass[i] = 1;
    if (n_bonds > 0) CHECK(hol_chains_add_block(chains, 1, n_bonds, 3 * count, mass));
    free(mass);
    return chains;
}

static int64_t bytes_of(const hol_device_plan *plan, hol_device_array which, const void **data)
{
    int64_t bytes = -1;
    CHECK(hol_device_plan_array(plan, which, data, &bytes));
    return bytes;
}

static void errors_name_what_is_wrong(void **state)
{
    (void)state;
    hol_chains *chains = waters_and_chain(1, 0);
    hol_device_plan *plan = (hol_device_plan *)1;
    const void *data;
    const char *name;
    int64_t number = 7, size = 7;
    CHECK_FAILS(HOL_ERR_NULL, hol_device_plan_create(NULL, HOL_DEVICE_MIXED, -1, &plan));
    assert_null(plan);
    CHECK_FAILS(HOL_ERR_NULL, hol_device_plan_create(chains, HOL_DEVICE_MIXED, -1, NULL));
    plan = (hol_device_plan *)1;
    CHECK_FAILS(HOL_ERR_VALUE, hol_device_plan_create(chains, (hol_device_precision)3, -1, &plan));
    assert_null(plan);
    assert_non_null(strstr(hol_error_message(), "precision is 3"));
    CHECK_FAILS(HOL_ERR_VALUE, hol_device_plan_create(chains, HOL_DEVICE_MIXED, 1001, &plan));
    assert_non_null(strstr(hol_error_message(), "max_entries is 1001"));

    plan = plan_of(chains, HOL_DEVICE_MIXED, 0);
    CHECK_FAILS(HOL_ERR_NULL, hol_device_plan_array(NULL, HOL_DEVICE_NUMBERS, &data, &size));
    CHECK_FAILS(HOL_ERR_NULL, hol_device_plan_array(plan, HOL_DEVICE_NUMBERS, NULL, &size));
    CHECK_FAILS(HOL_ERR_NULL, hol_device_plan_array(plan, HOL_DEVICE_NUMBERS, &data, NULL));
    CHECK_FAILS(HOL_ERR_VALUE, hol_device_plan_array(plan, (hol_device_array)4, &data, &size));
    assert_non_null(strstr(hol_error_message(), "which is 4"));
    CHECK_FAILS(HOL_ERR_NULL, hol_device_plan_launch(NULL, 0, &name, &name, &number, &size));
    CHECK_FAILS(HOL_ERR_VALUE, hol_device_plan_launch(plan, 1, &name, &name, &number, &size));
    CHECK_FAILS(HOL_ERR_VALUE, hol_device_plan_launch(plan, -1, &name, &name, &number, &size));
    assert_true(number == 7 && size == 7);
    CHECK(hol_device_plan_launch(plan, 0, NULL, NULL, NULL, NULL));
    CHECK_FAILS(HOL_ERR_NULL, hol_device_plan_left(NULL, &number));
    CHECK(hol_device_plan_left(plan, NULL)); /* there is none */
    assert_null(hol_device_plan_source(NULL));
    assert_int_equal(hol_device_plan_n_launches(NULL), 0);
    assert_int_equal(hol_device_plan_n_left(NULL), 0);
    hol_device_plan_destroy(NULL);
    hol_device_plan_destroy(plan);
    hol_chains_destroy(chains);
}

/* Water; 20 bonds for a work-item; 100 for a group in local memory; 5000 for one in scratch. */
static void sizes_and_launches_follow_the_molecules(void **state)
{
    (void)state;
    const int n_bonds[4] = {0, 20, 100, 5000}, size[4] = {64, 64, 64, 256};
    for (int precision = 0; precision < 3; ++precision)
        for (int k = 0; k < 4; ++k) {
            hol_chains *const chains = waters_and_chain(k == 0 ? 130 : 1, n_bonds[k]);
            hol_device_plan *const plan = plan_of(chains, (hol_device_precision)precision, -1);
            const int64_t bytes = precision == HOL_DEVICE_SINGLE ? 4 : 8, n_molecules = hol_chains_n_molecules(chains);
            const void *data[4];
            int64_t n_groups, group_size;
            const char *names[2];
            hol_chains_destroy(chains); /* it is not needed any more */
            assert_int_equal(hol_device_plan_n_launches(plan), k == 0 ? 1 : 2);
            for (int launch = 0; launch < (k == 0 ? 1 : 2); ++launch) {
                CHECK(hol_device_plan_launch(plan, launch, &names[0], &names[1], &n_groups, &group_size));
                for (int name = 0; name < 2; ++name) {
                    char kernel[64];
                    snprintf(kernel, sizeof kernel, "KERNEL void %s(", names[name]);
                    assert_non_null(strstr(hol_device_plan_source(plan), kernel));
                }
                if (k == 0) assert_int_equal(n_groups, 3); /* of 64 each, the last of 2 */
                if (launch == (k == 0 || k == 1 ? 0 : 1)) assert_int_equal(group_size, size[k]);
            }
            assert_int_equal(bytes_of(plan, HOL_DEVICE_FAILURES, &data[3]), 4 * (1 + n_molecules));
            for (int64_t m = 0; m <= n_molecules; ++m) assert_int_equal(((const int32_t *)data[3])[m], 0);
            /* All waters share theirs: three atoms, three bonds. */
            const int64_t numbers = bytes_of(plan, HOL_DEVICE_NUMBERS, &data[1]) / bytes;
            assert_int_equal(numbers, 6 + (k == 0 ? 0 : 2 * n_bonds[k] + 1));
            if (k == 0 && bytes == 4) assert_true(fabs(((const float *)data[1])[5] - 1 / 2.25) < 1e-7);
            if (k == 0 && bytes == 8) assert_true(((const double *)data[1])[5] == 1 / 2.25);
            const int64_t scratch = bytes_of(plan, HOL_DEVICE_SCRATCH, &data[2]);
            assert_null(data[2]);
            assert_true(k == 3 ? scratch > 5000 * (6 * bytes + 5 * 4) : scratch == bytes);
            assert_true(bytes_of(plan, HOL_DEVICE_INTEGERS, &data[0]) >= 4 * 3 * 130 || k > 0);
            assert_int_equal(hol_device_plan_n_left(plan), 0);
            hol_device_plan_destroy(plan);
        }
}

static void the_text_does_not_depend_on_how_many_there_are(void **state)
{
    (void)state;
    hol_chains *const few = waters_and_chain(1, 8), *const many = waters_and_chain(500, 8);
    hol_device_plan *const one = plan_of(few, HOL_DEVICE_SINGLE, -1), *const two = plan_of(many, HOL_DEVICE_SINGLE, -1);
    assert_string_equal(hol_device_plan_source(one), hol_device_plan_source(two));
    hol_device_plan_destroy(one);
    hol_device_plan_destroy(two);
    hol_chains_destroy(few);
    hol_chains_destroy(many);
}

/* Small molecules have kernels of their own, so that they keep their registers. */
static void what_a_work_item_solves_is_chosen(void **state)
{
    (void)state;
    hol_chains *const chains = waters_and_chain(1, 20);
    const int64_t max_entries[3] = {-1, 19, 18};
    for (int k = 0; k < 3; ++k) {
        hol_device_plan *const plan = plan_of(chains, HOL_DEVICE_MIXED, max_entries[k]);
        int64_t n_groups;
        assert_int_equal(hol_device_plan_n_launches(plan), 2);
        CHECK(hol_device_plan_launch(plan, 1, NULL, NULL, &n_groups, NULL));
        assert_int_equal(n_groups, 1);
        /* The cases of work-items, each in the kernels for positions and for velocities. */
        const char *text = hol_device_plan_source(plan);
        int cases = 0;
        while ((text = strstr(text, "case ")) != NULL) ++cases, ++text;
        assert_int_equal(cases, k < 2 ? 4 : 2);
        hol_device_plan_destroy(plan);
    }
    hol_chains_destroy(chains);
}

/* Carbon dioxide is a body, a hub and a lattice take too many products; all numbers from 1. */
static void molecules_that_kernels_cannot_solve_are_left(void **state)
{
    (void)state;
    enum { HUB = 4000, SIDE = 12, N = 3 + 3 + 1 + HUB + SIDE * SIDE * SIDE };
    static double mass[N], length[3 * N];
    static int64_t pairs[6 * N];
    hol_chains *chains;
    int64_t image[3] = {0, 0, 0}, n = 0;
    for (int i = 0; i < N; ++i) mass[i] = 1;
    for (int k = 0; k < 3 * N; ++k) length[k] = 1;
    CHECK(hol_chains_create(N, mass, &chains));
    CHECK(hol_chains_set_index_base(chains, 1));
    const int64_t dioxide[6] = {1, 2, 1, 3, 2, 3}, told[4] = {4, 5, 5, 6};
    CHECK(hol_chains_add_bonds(chains, 3, dioxide, (double[3]){1, 1, 2}));
    CHECK(hol_chains_add_bonds_with_images(chains, 1, told, length, image));
    for (int k = 0; k < HUB; ++k, ++n) pairs[2 * n] = 7, pairs[2 * n + 1] = 8 + k;
    CHECK(hol_chains_add_bonds(chains, n, pairs, length));
    n = 0;
    for (int x = 0; x < SIDE; ++x)
        for (int y = 0; y < SIDE; ++y)
            for (int z = 0; z < SIDE; ++z) {
                const int64_t atom = 8 + HUB + (x * SIDE + y) * SIDE + z;
                if (z + 1 < SIDE) pairs[2 * n] = atom, pairs[2 * n++ + 1] = atom + 1;
                if (y + 1 < SIDE) pairs[2 * n] = atom, pairs[2 * n++ + 1] = atom + SIDE;
                if (x + 1 < SIDE && (y + z) % 3 == 0) pairs[2 * n] = atom, pairs[2 * n++ + 1] = atom + SIDE * SIDE;
            }
    CHECK(hol_chains_add_bonds(chains, n, pairs, length));
    hol_device_plan *const plan = plan_of(chains, HOL_DEVICE_DOUBLE, -1);
    assert_int_equal(hol_chains_n_molecules(chains), 4);
    assert_int_equal(hol_device_plan_n_left(plan), 4);
    assert_int_equal(hol_device_plan_n_launches(plan), 0);
    int64_t all[4];
    CHECK(hol_device_plan_left(plan, all));
    for (int k = 0; k < 4; ++k) assert_int_equal(all[k], k + 1);
    CHECK_FAILS(HOL_ERR_NULL, hol_device_plan_left(plan, NULL));
    hol_device_plan_destroy(plan);
    hol_chains_destroy(chains);
}

static void without_molecules_there_is_nothing_to_launch(void **state)
{
    (void)state;
    hol_chains *chains;
    CHECK(hol_chains_create(0, NULL, &chains));
    hol_device_plan *const plan = plan_of(chains, HOL_DEVICE_SINGLE, -1);
    const void *data;
    assert_int_equal(hol_device_plan_n_launches(plan), 0);
    for (int which = 0; which < 4; ++which) assert_int_equal(bytes_of(plan, (hol_device_array)which, &data), 4);
    hol_device_plan_destroy(plan);
    hol_chains_destroy(chains);
}

/* In kilograms and metres floats would not hold products of inverse masses. */
static void inverse_masses_are_relative(void **state)
{
    (void)state;
    hol_chains *chains;
    const void *data;
    const double mass[3] = {0, 1e-26, 3e-26}, length[2] = {1e-10, 1e-10};
    CHECK(hol_chains_create(3, mass, &chains));
    CHECK(hol_chains_add_block(chains, 1, 2, 0, length));
    hol_device_plan *const plan = plan_of(chains, HOL_DEVICE_SINGLE, -1);
    bytes_of(plan, HOL_DEVICE_NUMBERS, &data);
    const float *const numbers = data; /* of the inner atom first, with most bonds; then by their numbers */
    assert_true(numbers[0] >= 1 && numbers[0] < 2);
    assert_true(numbers[1] == 0);
    assert_true(fabs(numbers[2] / numbers[0] - 1.0 / 3) < 1e-7);
    assert_true(fabs(numbers[3] / 1e20 - 1) < 1e-6);
    hol_device_plan_destroy(plan);
    hol_chains_destroy(chains);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(errors_name_what_is_wrong),
        cmocka_unit_test(sizes_and_launches_follow_the_molecules),
        cmocka_unit_test(the_text_does_not_depend_on_how_many_there_are),
        cmocka_unit_test(what_a_work_item_solves_is_chosen),
        cmocka_unit_test(molecules_that_kernels_cannot_solve_are_left),
        cmocka_unit_test(without_molecules_there_is_nothing_to_launch),
        cmocka_unit_test(inverse_masses_are_relative),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
