/** @file residue_growth.h
 * Residues put together: atoms, bonds and positions. */
#ifndef TESTS_RESIDUE_GROWTH_H
#define TESTS_RESIDUE_GROWTH_H

#include "residues.h"

/** A molecule without lengths, velocities and forces. residue [n_atoms] is to be freed. */
molecule residues_grow(const residue_recipe *recipe, int64_t n_bonds, random_stream *random, int64_t **residue);

#endif
