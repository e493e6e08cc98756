/**
 * @file rigid_file.h
 * Reads a file of reference results for a molecule with rigid bodies; tests/oracle/rigid/README.md describes the
 * format.
 */
#ifndef REFERENCE_RIGID_FILE_H
#define REFERENCE_RIGID_FILE_H

#include <stddef.h>
#include <stdint.h>

/** One reference molecule. Inputs are exactly the doubles that the results belong to; results carry 64 bits. */
typedef struct rigid_file {
    char name[128];
    int64_t n_atoms, n_bodies, n_bonds, n_held;
    double *mass;        /**< [n_atoms], 0: a massless site, -1: held fixed */
    double *place;       /**< [n_atoms][3] reference coordinates */
    double *r, *v, *f;   /**< [n_atoms][3] */
    int64_t *sizes;      /**< [n_bodies] */
    int64_t *body_atoms; /**< [n_held], one body after the other */
    int64_t *pairs;      /**< [n_bonds][2] */
    double *length;      /**< [n_bonds] */
    long double virial[9], virial_scale;
    long double *lambda, *lambda_scale, *mu, *mu_scale;                     /**< [n_bonds] */
    long double *g, *g_scale, *acceleration, *a_scale, *velocity, *v_scale; /**< [n_atoms][3] or [n_atoms] */
    double dt;
    double *drifted;                               /**< [n_atoms][3] */
    long double *position, *r_scale;               /**< [n_atoms][3] and [n_atoms] */
    long double *position_lambda, *position_scale; /**< [n_bonds] */
} rigid_file;

/** As molecule_file_read. */
int rigid_file_read(const char *path, rigid_file *m, char *message, size_t message_size);

void rigid_file_free(rigid_file *m);

/** Whether the first line of data begins with `rigid`. */
int is_rigid_file(const char *path);

#endif
