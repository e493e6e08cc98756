#include "worst.h"

#include <float.h>
#include <holonomic.h>
#include <math.h>
#include <stdio.h>

void note(worst *w, long double error, long double bound)
{
    if (isnan(error)) error = HUGE_VALL;
    if (!(error / bound < w->ratio) || w->bound == 0) {
        w->error = error;
        w->ratio = error / bound;
        w->bound = bound;
    }
}

void compare(worst *w, double value, long double reference, long double scale, long double bound)
{
    long double error = fabsl(value - reference) / (DBL_EPSILON * scale);
    if (scale == 0) error = value == reference ? 0 : HUGE_VALL;
    if (isnan(value)) error = HUGE_VALL;
    note(w, error, bound);
}

void print_worst(const char *name, const char *quantity, const worst *w)
{
    printf("%-36s %-14s %10.3Lg of %7.2Lf  %s\n", name, quantity, w->error, w->bound,
           w->ratio <= 1 ? "ok" : "OUT OF BOUND");
}

long double print_failure(const char *name, const char *what, int status)
{
    printf("%-36s %s: %s: %s\n", name, what, hol_status_name(status), hol_error_message());
    return HUGE_VALL;
}

long double larger_ratio(long double ratio, const worst *w)
{
    return w->ratio > ratio || isnan(w->ratio) ? w->ratio : ratio;
}
