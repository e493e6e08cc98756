/*
 * Sizes, alignments, offsets and enum values that programs have compiled into them: none may ever change under one
 * SOVERSION. Compiled as C and, through layout.cpp, as C++.
 */
#include <holonomic.h>
#include <stddef.h>
#include <stdio.h>

static int failures = 0;

static void expect(const char *what, unsigned long long is, unsigned long long should_be)
{
    if (is != should_be) {
        printf("%s is %llu and must be %llu\n", what, is, should_be);
        ++failures;
    }
}

#define IS(what, should_be) expect(#what, (unsigned long long)(what), (unsigned long long)(should_be))

static void enum_values_are_frozen(void)
{
    IS(HOL_OK, 0);
    IS(HOL_ERR_NULL, 1);
    IS(HOL_ERR_VALUE, 2);
    IS(HOL_ERR_INDEX, 3);
    IS(HOL_ERR_SHARED_ATOM, 4);
    IS(HOL_ERR_MEMORY, 5);
    IS(HOL_ERR_NOT_FINITE, 6);
    IS(HOL_ERR_DEGENERATE, 7);
    IS(HOL_ERR_NO_CONVERGENCE, 8);
    IS(HOL_ERR_NOT_DEFINITE, 9);
    IS(HOL_ERR_INTERNAL, 10);
    IS(HOL_ERR_LENGTHS, 11);
    IS(HOL_ERR_UNSUPPORTED, 12);
    IS(HOL_ERR_STATE, 13);
    IS(HOL_ERR_CALLBACK, 14);
    IS(HOL_BODIES_FOUND, 0);
    IS(HOL_BODIES_GIVEN, 1);
    IS(HOL_ROLE_OWN, 0);
    IS(HOL_ROLE_BODY, 1);
    IS(HOL_ROLE_IMPLIED, 2);
    IS(HOL_ROLE_FIXED, 3);
    IS(HOL_NEVER, 0);
    IS(HOL_AT_START, 1);
    IS(HOL_ALWAYS, 2);
    IS(HOL_DOUBLE, 0);
    IS(HOL_FLOAT, 1);
    IS(HOL_DEVICE_SINGLE, 0);
    IS(HOL_DEVICE_MIXED, 1);
    IS(HOL_DEVICE_DOUBLE, 2);
    IS(HOL_DEVICE_INTEGERS, 0);
    IS(HOL_DEVICE_NUMBERS, 1);
    IS(HOL_DEVICE_SCRATCH, 2);
    IS(HOL_DEVICE_FAILURES, 3);
    IS(HOL_WRITE, 0);
    IS(HOL_ADD, 1);
    IS(HOL_BOX, 0);
    IS(HOL_REFERENCE_BOX, 1);
    IS(HOL_UNIT_DIAGONAL, 0);
    IS(HOL_PHYSICAL, 1);
    IS(HOL_SHAPE_CHAIN, 0);
    IS(HOL_SHAPE_TREE, 1);
    IS(HOL_SHAPE_RING, 2);
    IS(HOL_SHAPE_TRIANGLE, 3);
    IS(HOL_SHAPE_OTHER, 4);
    IS(sizeof(hol_status), sizeof(int));
    IS(sizeof(hol_element), sizeof(int));
    IS(sizeof(hol_mode), sizeof(int));
    IS(sizeof(hol_scaling), sizeof(int));
    IS(sizeof(hol_shape), sizeof(int));
}

static void hol_view_is_frozen(void)
{
    IS(offsetof(hol_view, x), 0);
    IS(offsetof(hol_view, y), sizeof(void *));
    IS(offsetof(hol_view, z), 2 * sizeof(void *));
    IS(sizeof(((hol_view *)0)->stride), 8);
    IS(sizeof(((hol_view *)0)->element), 4);
    IS(sizeof(((hol_view *)0)->reserved), 4);
    if (sizeof(void *) == 8) {
        IS(offsetof(hol_view, stride), 24);
        IS(offsetof(hol_view, element), 32);
        IS(offsetof(hol_view, reserved), 36);
        IS(sizeof(hol_view), 40);
    }
}

static void hol_report_is_frozen(void)
{
    IS(offsetof(hol_report, iterations), 0);
    IS(offsetof(hol_report, n_corrected), 8);
    IS(offsetof(hol_report, n_failed), 16);
    IS(offsetof(hol_report, molecule), 24);
    IS(offsetof(hol_report, bond), 32);
    IS(offsetof(hol_report, max_error), 40);
    IS(sizeof(hol_report), 48);
}

static void hol_worst_is_frozen(void)
{
    IS(offsetof(hol_worst, length), 0);
    IS(offsetof(hol_worst, length_molecule), 8);
    IS(offsetof(hol_worst, length_bond), 16);
    IS(offsetof(hol_worst, rate), 24);
    IS(offsetof(hol_worst, rate_molecule), 32);
    IS(offsetof(hol_worst, rate_bond), 40);
    IS(sizeof(hol_worst), 48);
}

/* The alignment of a type is the offset at which it comes after a char. */
static void alignments_are_natural(void)
{
    struct view_after_char {
        char c;
        hol_view object;
    };
    struct report_after_char {
        char c;
        hol_report object;
    };
    struct worst_after_char {
        char c;
        hol_worst object;
    };
    struct int64_after_char {
        char c;
        int64_t object;
    };
    const size_t natural = offsetof(struct int64_after_char, object);
    IS(offsetof(struct view_after_char, object), natural);
    IS(offsetof(struct report_after_char, object), natural);
    IS(offsetof(struct worst_after_char, object), natural);
}

int main(void)
{
    enum_values_are_frozen();
    hol_view_is_frozen();
    hol_report_is_frozen();
    hol_worst_is_frozen();
    alignments_are_natural();
    if (failures == 0) printf("as frozen\n");
    return failures != 0;
}
