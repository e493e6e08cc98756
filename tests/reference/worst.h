/**
 * @file worst.h
 * The largest error of a quantity in units of its bound, and what check_oracle prints of it.
 */
#ifndef REFERENCE_WORST_H
#define REFERENCE_WORST_H

/** Largest error of one quantity of one case. */
typedef struct worst {
    long double error; /**< in units of eps times its scale */
    long double ratio; /**< error over bound */
    long double bound; /**< in the same units */
} worst;

/**
 * Takes in one number, judged by its scale, also where the reference is zero: what is zero by symmetry comes out as
 * what rounding leaves of its parts. Where the scale is zero the reference must be met exactly.
 */
void compare(worst *w, double value, long double reference, long double scale, long double bound);

/** Takes in an error in units of eps times its scale. */
void note(worst *w, long double error, long double bound);

/** Prints a line of the table. */
void print_worst(const char *name, const char *quantity, const worst *w);

/** Prints why a call failed, and returns an infinite ratio. */
long double print_failure(const char *name, const char *what, int status);

/** The larger of the two ratios; not a number counts as larger. */
long double larger_ratio(long double ratio, const worst *w);

#endif
