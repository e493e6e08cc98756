/**
 * @file check.h
 * What every test of the C interface includes: CMocka, the library, and comparisons of arrays bit for bit.
 */
#ifndef TESTS_CHECK_H
#define TESTS_CHECK_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

/* which needs the four above */
#include <cmocka.h>

#include <float.h>
#include <holonomic.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/** Calls a function that must succeed. */
#define CHECK(call)                                                                                                    \
    do {                                                                                                               \
        const int check_status = (call);                                                                               \
        if (check_status != HOL_OK) fail_msg("%s: %s: %s", #call, hol_status_name(check_status), hol_error_message()); \
    } while (0)

/** Calls a function that must fail in this way, with a message. */
#define CHECK_FAILS(status, call)                                                                            \
    do {                                                                                                     \
        const int check_status = (call);                                                                     \
        if (check_status != (status))                                                                        \
            fail_msg("%s: %s instead of %s", #call, hol_status_name(check_status), hol_status_name(status)); \
        assert_true(hol_error_message()[0] != 0);                                                            \
    } while (0)

/** Fails unless value is at most bound; says by how much. Not a number fails. */
#define CHECK_AT_MOST(value, bound)                                                           \
    do {                                                                                      \
        const long double check_value = (value), check_bound = (bound);                       \
        if (!(check_value <= check_bound))                                                    \
            fail_msg("%s = %Lg is above %s = %Lg", #value, check_value, #bound, check_bound); \
    } while (0)

/** Allocates n doubles that hold a pattern which no calculation writes; the program ends if there is no memory. */
double *untouched(size_t n);

/** Fails unless all n doubles still hold the pattern. */
void assert_untouched(const double *a, size_t n);

/** Fails unless both hold the same bits. */
void assert_same_bits(const double *a, const double *b, size_t n);

/** A copy, to be freed. */
double *copy_of(const double *a, size_t n);

/** Fails unless the message of the last failing call contains the words. */
void assert_message_names(const char *words);

/**
 * Relative rounding of long double arithmetic as it runs: that of double under valgrind, which has no wider one,
 * whatever LDBL_EPSILON says.
 */
long double long_double_rounding(void);

/** Whether HOLONOMIC_TESTS_QUICK is set: a test then takes fewer examples, for runs under slow tools. */
int quick_run(void);

/** Bound of tests/oracle/README.md in units of eps times the scale, for a chain of n bonds. */
long double oracle_bound(int64_t n_bonds);

#endif
