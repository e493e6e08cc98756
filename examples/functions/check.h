/* What the examples share: a call that must succeed, and a result that is known. */
#ifndef EXAMPLE_CHECK_H
#define EXAMPLE_CHECK_H

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "holonomic.h"

/* Ends the program with the library's message if a call fails. */
static void ok(int status)
{
    if (status == HOL_OK) return;
    fprintf(stderr, "%s: %s\n", hol_status_name(status), hol_error_message());
    exit(1);
}

/* Prints a result, and ends the program if it is not what it must be. */
static void shows(const char *name, double value, double expected)
{
    printf("%-24s %.12g\n", name, value);
    if (!(fabs(value - expected) <= 1e-12 * (1 + fabs(expected)))) {
        fprintf(stderr, "%s must be %.17g\n", name, expected);
        exit(1);
    }
}

#endif
