/**
 * @file nve.h
 * Molecules with rigid bonds at constant energy, by RATTLE with the library, or with textbook sweeps beside it. Units:
 * angstrom, atomic mass, kJ/mol, so that time is in 0.1 ps.
 */
#ifndef TESTS_NVE_H
#define TESTS_NVE_H

#include <holonomic.h>
#include <stdint.h>

/** Adds to f and returns the potential energy. */
typedef double (*field)(const void *of_what, int64_t n_atoms, const double *r, double *f);

typedef struct nve {
    const hol_chains *chains;
    int64_t n_atoms, n_bonds;
    const double *mass, *length;
    const int64_t *pairs;
    field forces;
    const void *of_what;
    double *r, *v, *f, *before; /**< [n_atoms][3] */
    double potential;
    double sweeps;       /**< 0: the library; otherwise SHAKE and RATTLE to this relative tolerance */
    double worst_length; /**< largest |d.d - a^2| / a^2 over eps (1 + X / a_min) */
} nve;

/** Copies positions and velocities, projects the latter and finds the forces. */
nve nve_make(const hol_chains *chains, int64_t n_atoms, const double *mass, const int64_t *pairs, const double *length,
             const double *r, const double *v, field forces, const void *of_what);

/** One step. */
void nve_step(nve *s, double dt);

double nve_kinetic(const nve *s);

/** Mean total energies over the first and the last tenth of a run, and the largest distance of a step's from the first.
 */
typedef struct energy_record {
    double first, last, spread;
} energy_record;

energy_record nve_run(nve *s, double dt, int steps);

/** The same state, to be run by sweeps to this tolerance. */
nve nve_with_sweeps(const nve *s, double tolerance);

void nve_free(nve *s);

#endif
