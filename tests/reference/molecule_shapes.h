/**
 * @file molecule_shapes.h
 * What molecule_make chooses from: each function adds atoms and bonds to an empty molecule.
 */
#ifndef REFERENCE_MOLECULE_SHAPES_H
#define REFERENCE_MOLECULE_SHAPES_H

#include "molecule.h"

/** A unit vector at right angles to u. */
void unit_normal(random_stream *s, const double u[3], double n[3]);

/** u turned by an angle, towards the normal n turned about u by the azimuth. */
void turned(const double u[3], const double n[3], double angle, double azimuth, double out[3]);

/** An atom at the origin. */
int64_t first_atom(molecule *m, double mass);

/** Up to three atoms on `at`, whose own bond points along u, in tetrahedral directions. */
void branches(molecule *m, random_stream *s, int64_t at, const double u[3], int count, double mass, double length);

void make_xhn(molecule *m, random_stream *s, int count);
void make_neopentane(molecule *m, random_stream *s);
void make_alkane(molecule *m, random_stream *s, int64_t size);
void make_comb(molecule *m, random_stream *s, int64_t size, double turn, double light);
void make_dendrimer(molecule *m, random_stream *s, int64_t generations);
void make_star(molecule *m, random_stream *s, int64_t arms);
void make_tree(molecule *m, random_stream *s, int64_t n_bonds, int valence);
void make_taut(molecule *m, random_stream *s, int64_t size, double turn);
void make_coplanar_star(molecule *m, random_stream *s);

/** Three distances: two legs with an angle in degrees between them. */
void make_triangle(molecule *m, random_stream *s, double leg, double degrees, double centre_mass, double end_mass);
void make_ring(molecule *m, random_stream *s, int64_t size, double flatness);
void make_benzene(molecule *m, random_stream *s, double pucker, int rigid_angles);

/** A path with rigid angles between low and high degrees; planar: torsions of 180 degrees. */
void make_triangles(molecule *m, random_stream *s, int64_t size, double low, double high, int planar);
void make_fused_rings(molecule *m, random_stream *s, int64_t size);
void make_cube(molecule *m, random_stream *s);

/** With hydrogens along the diagonals; hexagons in the plane z = 0. */
void make_cubane(molecule *m);
void make_naphthalene(molecule *m);
void make_lariat(molecule *m, random_stream *s, int64_t size);
void make_peptide(molecule *m, random_stream *s, int64_t residues);
void make_ten_distances(molecule *m, random_stream *s);
void make_planar_square(molecule *m);

#endif
