/**
 * The part of CMocka that the tests use, for machines that it is not installed for (cross compilation): the first
 * failure ends the program with status 1.
 */
#ifndef COMPILERS_CMOCKA_H
#define COMPILERS_CMOCKA_H

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct CMUnitTest {
    const char *name;
    void (*run)(void **state);
};

#define cmocka_unit_test(function) \
    {                              \
#function, function        \
    }
#define cmocka_run_group_tests(tests, setup, teardown) run_group((tests), sizeof(tests) / sizeof *(tests))
#define cmocka_run_group_tests_name(name, tests, setup, teardown) cmocka_run_group_tests(tests, setup, teardown)

#define print_message(...) ((void)printf(__VA_ARGS__))
#define fail_msg(...) \
    ((void)printf("%s:%d: ", __FILE__, __LINE__), (void)printf(__VA_ARGS__), (void)printf("\n"), exit(1))
#define fail() fail_msg("failed")
#define skip()                 \
    do {                       \
        (void)puts("skipped"); \
        return;                \
    } while (0)
#define assert_true(c) ((c) ? (void)0 : fail_msg("%s", #c))
#define assert_null(p) assert_true(!(p))
#define assert_non_null(p) assert_true(p)
#define assert_int_equal(a, b) same_integers((long long)(a), (long long)(b), #a " == " #b, __FILE__, __LINE__)
#define assert_int_not_equal(a, b) assert_true((long long)(a) != (long long)(b))
#define assert_in_range(x, low, high) assert_true((x) >= (low) && (x) <= (high))
#define assert_string_equal(a, b) assert_true(strcmp((a), (b)) == 0)
#define assert_memory_equal(a, b, size) assert_true(memcmp((a), (b), (size)) == 0)

static inline void same_integers(long long a, long long b, const char *what, const char *file, int line)
{
    if (a == b) return;
    printf("%s:%d: %s: %lld and %lld\n", file, line, what, a, b);
    exit(1);
}

static inline int run_group(const struct CMUnitTest *tests, size_t n)
{
    for (size_t i = 0; i < n; ++i) {
        void *state = NULL;
        printf("%s\n", tests[i].name);
        fflush(stdout);
        tests[i].run(&state);
    }
    printf("%zu tests passed\n", n);
    return 0;
}

#endif
