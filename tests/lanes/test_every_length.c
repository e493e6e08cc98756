/**
 * All calls on chains of every length to 1400 and of the lengths near every limit in the code: the longest chain of a
 * lane, segments, blocks, windows of the positions and groups of bonds that are read at a time; in every place where
 * callers keep their atoms, with equal and with unequal masses and lengths. It asserts what physics demands
 * (physics.h).
 *
 *   test_every_length [SHARD SHARDS]        each SHARDS-th length from SHARD on
 *
 * With HOLONOMIC_ISA naming kernels that can't run here it ends with 77.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "physics.h"

enum { EVERY_LENGTH_TO = 1400, NEAR = 40, LONGEST_OF_A_LANE = 256 };

/** Limits above EVERY_LENGTH_TO: blocks of 1024 bonds; windows of 256 and of 512 bonds in each of 2 .. 16 lanes. */
static const int64_t limits[] = {2048, 3072, 4096, 8192, 12288, 16384};

/** The lanes of the set, no fewer than two blocks of the installed ones have; and behind its third block no limit is
 * new. */
static int64_t lanes = 8, last_limit = 8192;

/** So many bonds in a call that the library takes the caller's arrays to be out of cache. */
static const int64_t bonds_out_of_cache = 16600;

/**
 * Roundings that each deviation may have: about four times the largest that any lane count has shown. They are
 * not much above 1, but where a chain's condition enters (rates and second derivatives relative to the largest terms of
 * the bond alone; the unscaled ln det).
 */
static const double allowed[DEVIATIONS] = {
    [SECOND_DERIVATIVE] = 64, [PULLS] = 8,       [TENSIONS] = 8, [RATES] = 64,
    [CHANGES] = 128,          [LENGTHS] = 16,    [MOVES] = 16,   [PUSHES] = 64,
    [VIRIALS] = 16,           [LOGARITHMS] = 16, [ENERGY] = 64,  [FIXMAN_FORCE] = 1,
    [FIXMAN_SUM] = 16};

static deviations worst_of_all;
static int n_failed;

static void check(int64_t n_chains, int64_t n_bonds, place where, int unequal, int plain)
{
    scene s = scene_make(n_chains, n_bonds, where, unequal);
    deviations x = {{0}};
    answers a = plain ? scene_plain_answers(&s) : scene_answers(&s);
    char name[200];
    snprintf(name, sizeof name, "%lld chains of %lld bonds, %s, %s masses%s", (long long)n_chains, (long long)n_bonds,
             place_names[where], unequal ? "unequal" : "equal", plain ? ", no tensions and sums" : "");
    if (a.failed) {
        printf("%s: %s: %s\n", name, a.failed, hol_error_message());
        ++n_failed;
    } else {
        deviations_add(&x, &s, &a, plain);
    }
    for (int i = 0; i < DEVIATIONS; ++i) {
        if (!(x.worst[i] <= worst_of_all.worst[i])) worst_of_all.worst[i] = x.worst[i];
        if (x.worst[i] <= allowed[i]) continue;
        printf("%s: %s: %.3g times the rounding, %.3g allowed\n", name, deviation_names[i], x.worst[i], allowed[i]);
        ++n_failed;
    }
    answers_free(&a);
    scene_free(&s);
}

/**
 * Short chains: full blocks of lanes and three chains more; small molecules need a few behind them. Longer ones are
 * read, eliminated and written by functions that know neither lengths nor places: with or without sums by turns.
 */
static void check_short(int64_t n_bonds)
{
    for (int unequal = 0; unequal < 2; ++unequal)
        for (int where = 0; where < PLACES; ++where)
            for (int plain = 0; plain < 2; ++plain) {
                if (n_bonds > 48 && (n_bonds / 16 + where + unequal) % 2 != plain) continue;
                check(n_bonds <= 48 ? 35 : lanes + 3, n_bonds, (place)where, unequal, plain);
            }
    check(1, n_bonds, PACKED, (int)(n_bonds % 2), 1);
    if (n_bonds % 16 != 3) return;
    for (int where = PACKED; where <= LISTED; ++where)
        check(bonds_out_of_cache / n_bonds, n_bonds, (place)where, (int)(n_bonds / 16 % 2), 1);
}

static void check_length(int64_t n_bonds)
{
    if (n_bonds <= LONGEST_OF_A_LANE) {
        check_short(n_bonds);
        return;
    }
    const int64_t turn = n_bonds / 32; /* groups are read of as many: all that is left of one comes with either turn */
    for (int where = 0; where < PLACES; ++where)
        for (int unequal = 0; unequal < 2; ++unequal) {
            /* Of the longest, which take their time, each length in one place with either masses. */
            if (n_bonds > EVERY_LENGTH_TO ? n_bonds % PLACES != where : (turn + where) % 2 != unequal) continue;
            check(where == MIXED ? 2 : 1, n_bonds, (place)where, unequal, (turn / 2 + where + unequal) % 2 != 0);
        }
}

/** The lengths, in ascending order; -1 behind the last. */
static int64_t next_length(int64_t n)
{
    if (n < EVERY_LENGTH_TO) return n + 1;
    for (size_t i = 0; i < sizeof limits / sizeof *limits && limits[i] <= last_limit; ++i) {
        if (n < limits[i] - NEAR) return limits[i] - NEAR;
        if (n < limits[i] + NEAR) return n + 1;
    }
    return -1;
}

int main(int argc, char **argv)
{
    const int64_t shard = argc > 2 ? atoi(argv[1]) : 0, shards = argc > 2 ? atoi(argv[2]) : 1;
    const char *const wanted = getenv("HOLONOMIC_ISA");
    if (wanted && strcmp(wanted, hol_instruction_set()) != 0) {
        printf("skipped: the kernels '%s' can't run here\n", wanted);
        return 77;
    }
    if (strncmp(hol_instruction_set(), "lanes", 5) == 0 && atoi(hol_instruction_set() + 5) > 4) {
        lanes = atoi(hol_instruction_set() + 5);
        last_limit = limits[sizeof limits / sizeof *limits - 1];
    }
    int64_t i = 0, n_lengths = 0;
    for (int64_t n = 1; n > 0 && n_failed < 20; n = next_length(n), ++i) {
        if (i % shards != shard) continue;
        check_length(n);
        ++n_lengths;
    }
    printf("%lld lengths with the kernels '%s'; largest deviations in roundings:\n", (long long)n_lengths,
           hol_instruction_set());
    for (int k = 0; k < DEVIATIONS; ++k)
        printf("  %-32s %10.3g of %g\n", deviation_names[k], worst_of_all.worst[k], allowed[k]);
    return n_failed > 0;
}
