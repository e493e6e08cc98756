/* What the recipes share: calls that must succeed, results that theory knows, and means with their errors. */
#ifndef RECIPE_H
#define RECIPE_H

#include <holonomic.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* Ends the program with the library's message if a call fails. */
static inline void ok(int status)
{
    if (status == HOL_OK) return;
    fprintf(stderr, "%s: %s\n", hol_status_name(status), hol_error_message());
    exit(1);
}

/* Prints a result beside what theory says, and ends the program if they differ by more than `error`. */
static inline void agrees(const char *what, double value, double theory, double error)
{
    printf("%-44s %14.9g   theory %14.9g   allowed %.2g\n", what, value, theory, error);
    if (fabs(value - theory) <= error) return;
    fprintf(stderr, "%s does not agree with theory\n", what);
    exit(1);
}

/* Mean of n independent numbers and its standard error. */
typedef struct mean {
    double value, error;
} mean;

static inline mean mean_of(const double *x, long n)
{
    mean m = {0, 0};
    for (long i = 0; i < n; ++i) m.value += x[i] / (double)n;
    for (long i = 0; i < n; ++i) m.error += (x[i] - m.value) * (x[i] - m.value);
    m.error = sqrt(m.error / ((double)n * (double)(n - 1)));
    return m;
}

static inline double *numbers(long n)
{
    double *const a = calloc((size_t)n, sizeof *a);
    if (!a) exit(1);
    return a;
}

#endif
