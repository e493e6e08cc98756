/**
 * @file spoil.h
 * Chains of an assembly made bad, and what must hold of them after a call.
 */
#ifndef TESTS_SPOIL_H
#define TESTS_SPOIL_H

#include "assembly.h"

/** What spoils a chain. */
typedef enum spoiler {
    NAN_POSITION,
    INFINITE_POSITION,
    NAN_VELOCITY,
    NAN_FORCE,
    INFINITE_FORCE,
    ZERO_BOND,
    OVERFLOWING_BOND,
    SPOILERS
} spoiler;

extern const char *const spoiler_words[SPOILERS];

/** Spoils one chain at its atom `at` (1 or more). */
void spoil(assembly *a, int64_t c, int64_t at, spoiler how);

/** The status of a call whose first bad chain was spoilt so. */
int expected_status(spoiler how);

/** Compares the outputs per atom of chain c with before (bad chain) or with those of the unspoilt run. */
void assert_chain(const assembly *a, int64_t c, const double *got, const double *expected);

/** The last error names this chain as the first bad one, and how many there are. */
void assert_location(int64_t first, int64_t bad);

#endif
