/**
 * @file layout.h
 * The same numbers laid out in memory in the ways that callers' programs do.
 */
#ifndef TESTS_LAYOUT_H
#define TESTS_LAYOUT_H

#include <holonomic.h>
#include <stddef.h>

typedef struct layout {
    const char *name;
    int element;   /**< HOL_DOUBLE or HOL_FLOAT */
    int step;      /**< elements from an atom to the next; 0: three separate arrays */
    int order[3];  /**< where x, y and z stand in a record */
    int backwards; /**< the last atom comes first */
} layout;

/** All layouts: those of doubles first. */
extern const layout layouts[];
extern const int n_layouts, n_double_layouts;

/** An array per atom in a layout, in memory of its own. */
typedef struct laid_out {
    hol_view view;
    int64_t n_atoms;
    void *memory;
    size_t bytes;
} laid_out;

/** Lays out [n_atoms][3] numbers; in two dimensions z is left out. What lies between is filled with a pattern. */
laid_out lay_out(const layout *how, int64_t n_atoms, const double *numbers, int dimensions);

/** Reads them back into [n_atoms][3]; z is left alone in two dimensions. */
void collect(const laid_out *a, double *numbers);

/** 1 if everything between the elements still holds the pattern. */
int gaps_untouched(const laid_out *a);

/** Fails unless it holds these numbers [n_atoms][3], as doubles or rounded to floats, and nothing between them. */
void assert_laid_out(const laid_out *got, const double *expected, const char *what);

void laid_out_free(laid_out *a);

#endif
