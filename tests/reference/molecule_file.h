/**
 * @file molecule_file.h
 * Reads a file of reference results for a molecule of any shape; tests/oracle/molecules/README.md describes the format.
 */
#ifndef REFERENCE_MOLECULE_FILE_H
#define REFERENCE_MOLECULE_FILE_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/** One reference molecule. Inputs are exactly the doubles that the results belong to; results carry 64 bits. */
typedef struct molecule_file {
    char name[128];
    int64_t n_atoms, n_bonds;
    int cyclic, degenerate;
    double *w, *mass;  /**< [n_atoms]; mass is -1 where w is 0 */
    double *r, *v, *f; /**< [n_atoms][3] */
    int64_t *pairs;    /**< [n_bonds][2] */
    double *length;    /**< [n_bonds] */
    /* results, none if the molecule is degenerate */
    long double lndet, lndetz, fixman_energy;
    long double virial[9], virial_scale;
    double condition, least_pivot;
    long double *lambda, *lambda_scale, *mu, *mu_scale;                          /**< [n_bonds] */
    long double *g, *g_scale, *fixman_force, *fixman_scale, *velocity, *v_scale; /**< [n_atoms][3] or [n_atoms] */
    int has_positions;
    double dt;
    double *drifted;                               /**< [n_atoms][3] */
    long double *position, *r_scale;               /**< [n_atoms][3] and [n_atoms] */
    long double *position_lambda, *position_scale; /**< [n_bonds] */
} molecule_file;

/**
 * Reads a whole file. Returns 0, or -1 with a message that names the file, the line and what was expected there.
 * On an error there is nothing to free.
 */
int molecule_file_read(const char *path, molecule_file *m, char *message, size_t message_size);

void molecule_file_free(molecule_file *m);

/** Whether the first line of data begins with `molecule`: this format rather than that of oracle_file.h. */
int is_molecule_file(const char *path);

#ifdef __cplusplus
}
#endif
#endif
