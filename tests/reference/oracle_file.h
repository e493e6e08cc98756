/**
 * @file oracle_file.h
 * Reads a file of reference results; tests/oracle/README.md describes the format.
 */
#ifndef REFERENCE_ORACLE_FILE_H
#define REFERENCE_ORACLE_FILE_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct oracle_entry {
    int64_t i, j; /**< bond numbers from 1, as in the file */
    long double value;
} oracle_entry;

/** One reference case. Inputs are exactly the doubles that the results belong to; results carry 64 bits or more. */
typedef struct oracle_case {
    char name[128];
    int64_t n_bonds;
    double *w, *mass;  /**< [n_bonds+1]; mass is -1 where w is 0 */
    double *r, *v, *f; /**< [n_bonds+1][3] */
    double *length;    /**< [n_bonds] */
    long double lndet, fixman_energy;
    long double virial[9];
    double condition;
    long double *lambda, *lambda_scale;  /**< [n_bonds] */
    long double *g, *fixman_force;       /**< [n_bonds+1][3] */
    long double *g_scale, *fixman_scale; /**< [n_bonds+1] */
    int64_t n_zinv;
    oracle_entry *zinv;
} oracle_case;

/**
 * Reads a whole case. Returns 0, or -1 with a message that names the file, the line and what was expected there.
 * On an error there is nothing to free.
 */
int oracle_read(const char *path, oracle_case *c, char *message, size_t message_size);

void oracle_free(oracle_case *c);

#ifdef __cplusplus
}
#endif
#endif
