/**
 * Forces of an all-atom n-alkane alone in space: OPLS-AA (Jorgensen, Maxwell and Tirado-Rives 1996,
 * DOI 10.1021/ja9621760) without its bond terms, since bonds are rigid. Nothing here knows of the library.
 *
 * Units: length A, time ps, mass g/mol, so that energies are in g/mol A^2/ps^2 = 0.01 kJ/mol.
 */
#ifndef ALKANE_FORCES_H
#define ALKANE_FORCES_H

#include <stdint.h>

#define KJ_PER_MOL 100.0                        /* one kJ/mol in energy units */
#define BOLTZMANN (8.314462618e-3 * KJ_PER_MOL) /* energy/K */
#define PICONEWTON (60.2214076)                 /* one pN in force units */

/** Atoms of the n-alkane with n_carbons carbons: the carbons first, along the chain, then their hydrogens. */
typedef struct alkane {
    int n_carbons, n_atoms, n_bonds;
    int64_t *bonds;             /* [n_bonds][2] */
    double *lengths, *mass, *r; /* [n_bonds], [n_atoms], [n_atoms][3]: all trans */
    double *charge;             /* [n_atoms] */
    unsigned char *separation;  /* [n_atoms][n_atoms]: bonds between two atoms, 4 for more */
} alkane;

/** Returns 0, or 1 if there is not enough memory. */
int alkane_make(int n_carbons, alkane *molecule);

void alkane_free(alkane *molecule);

/** Potential energy; the forces are written to f [n_atoms][3]. */
double alkane_forces(const alkane *molecule, const double *r, double *f);

#endif
