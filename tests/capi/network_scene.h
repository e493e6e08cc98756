/** One large molecule of nodes and bonds, open or in a periodic box that its cycles go round, and what is tested of it.
 */
#ifndef NETWORK_SCENE_H
#define NETWORK_SCENE_H

#include "check.h"
#include "molecule.h"
#include "molecule_solution.h"

typedef struct {
    molecule m;
    hol_chains *chains;
    double box[9], side; /**< 0: there is no box */
} network_scene;

/** A molecule without atoms in a cubic box. */
network_scene network_scene_empty(double side);
/** Square of the distance of two atoms of r, by the nearest image; d [3] gets the vector. */
double network_nearest(const network_scene *s, const double *r, int64_t i, int64_t j, double *d);
/** Lengths as the molecule stands, and a handle without its bonds. */
void network_begin(network_scene *s);
void network_add(network_scene *s);
void network_free(network_scene s);

/** Images round: each component of a bond by eps of a cell, in units of a bond of 1. */
long double network_unit(const network_scene *s);
molecule_problem network_problem(const network_scene *s);
/** Projected velocities and their multipliers beside many digits. */
void check_network_velocities(const network_scene *s);
/** |d.d - a^2| / a^2 of the worst bond. */
double network_worst_length(const network_scene *s, const double *r);

#endif
