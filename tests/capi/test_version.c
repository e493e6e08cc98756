/** Version, names of statuses, and what the header promises about sizes and numbers. */
#include "check.h"

static void version_is_the_one_of_the_header(void **state)
{
    (void)state;
    char expected[64];
    snprintf(expected, sizeof expected, "%d.%d.%d", HOL_VERSION_MAJOR, HOL_VERSION_MINOR, HOL_VERSION_PATCH);
    assert_string_equal(hol_version(), expected);
    assert_int_equal(hol_version_number(), HOL_VERSION);
    assert_int_equal(HOL_VERSION, 10000 * HOL_VERSION_MAJOR + 100 * HOL_VERSION_MINOR + HOL_VERSION_PATCH);
}

static void every_status_has_its_own_name(void **state)
{
    (void)state;
    static const char *const names[] = {
        "HOL_OK",
        "HOL_ERR_NULL",
        "HOL_ERR_VALUE",
        "HOL_ERR_INDEX",
        "HOL_ERR_SHARED_ATOM",
        "HOL_ERR_MEMORY",
        "HOL_ERR_NOT_FINITE",
        "HOL_ERR_DEGENERATE",
        "HOL_ERR_NO_CONVERGENCE",
        "HOL_ERR_NOT_DEFINITE",
        "HOL_ERR_INTERNAL",
        "HOL_ERR_LENGTHS",
        "HOL_ERR_UNSUPPORTED",
        "HOL_ERR_STATE",
        "HOL_ERR_CALLBACK",
    };
    for (int s = 0; s < 15; ++s) assert_string_equal(hol_status_name(s), names[s]);
    assert_string_equal(hol_status_name(15), "unknown status");
    assert_string_equal(hol_status_name(-1), "unknown status");
    assert_string_equal(hol_status_name(1 << 30), "unknown status");
}

static void numbers_of_statuses_and_options_never_change(void **state)
{
    (void)state;
    assert_int_equal(HOL_OK, 0);
    assert_int_equal(HOL_ERR_NULL, 1);
    assert_int_equal(HOL_ERR_VALUE, 2);
    assert_int_equal(HOL_ERR_INDEX, 3);
    assert_int_equal(HOL_ERR_SHARED_ATOM, 4);
    assert_int_equal(HOL_ERR_MEMORY, 5);
    assert_int_equal(HOL_ERR_NOT_FINITE, 6);
    assert_int_equal(HOL_ERR_DEGENERATE, 7);
    assert_int_equal(HOL_ERR_NO_CONVERGENCE, 8);
    assert_int_equal(HOL_ERR_NOT_DEFINITE, 9);
    assert_int_equal(HOL_ERR_INTERNAL, 10);
    assert_int_equal(HOL_DOUBLE, 0);
    assert_int_equal(HOL_FLOAT, 1);
    assert_int_equal(HOL_WRITE, 0);
    assert_int_equal(HOL_ADD, 1);
}

static void structs_have_the_layout_that_other_languages_rely_on(void **state)
{
    (void)state;
    assert_int_equal(offsetof(hol_view, stride), 3 * sizeof(void *));
    assert_int_equal(offsetof(hol_view, element), 3 * sizeof(void *) + 8);
    assert_int_equal(sizeof(hol_view), 3 * sizeof(void *) + 16);
    assert_int_equal(offsetof(hol_report, max_error), 40);
    assert_int_equal(sizeof(hol_report), 48);
    assert_int_equal(offsetof(hol_worst, rate), 24);
    assert_int_equal(sizeof(hol_worst), 48);
}

static void instruction_set_is_one_of_the_documented_names(void **state)
{
    (void)state;
    const char *name = hol_instruction_set();
    assert_true(!strcmp(name, "baseline") || !strcmp(name, "avx2") || !strcmp(name, "avx512vl") ||
                !strcmp(name, "neon") || !strcmp(name, "scalar"));
    assert_true(name == hol_instruction_set());
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(version_is_the_one_of_the_header),
        cmocka_unit_test(every_status_has_its_own_name),
        cmocka_unit_test(numbers_of_statuses_and_options_never_change),
        cmocka_unit_test(structs_have_the_layout_that_other_languages_rely_on),
        cmocka_unit_test(instruction_set_is_one_of_the_documented_names),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
