/**
 * @file large.h
 * Molecules of thousands of bonds.
 */
#ifndef TESTS_LARGE_H
#define TESTS_LARGE_H

#include <holonomic.h>
#include <stddef.h>
#include <stdint.h>

#include "molecule.h"

/** Arms of the lengths first .. last, each with its numbers outwards and inwards. Each bond is turned by `bend` at the
 * most; above 1: anywhere. */
molecule large_arms(int64_t first, int64_t last, double bend);

/** Coils of these lengths, every other one with its numbers inwards; every third end is a fixed atom, if `fixed`. */
molecule large_coils(const int64_t *length, int64_t count, int fixed);

/** Straight arms beside coils, at least n atoms; some end at fixed atoms. */
molecule large_mixed_arms(int64_t n);

/** Segments of so many atoms, joined at random, at most four bonds at an atom; every `ring`th atom closes a ring of
 * four, if `ring` is not 0. */
molecule large_segments(int64_t n_atoms, int64_t segment, int64_t ring, uint64_t seed);

/** A chain with up to three atoms at each of its own: few of them can be worked on at once. */
molecule large_comb(int64_t n_atoms);

/** A tree: the first atom has so many bonds, which begin branches that fork at random. */
molecule large_hub(int64_t n_atoms, int64_t bonds);

/** A chain that closes rings of six, with atoms on its sides. */
molecule large_rings(int64_t n_atoms);

/** Two rails and rungs between them, as bent as may be: multipliers of single bonds cancel. */
molecule large_ladder(int64_t n_rungs);

/** Puts the bonds backwards, and turns them round. */
void large_turn_bonds(molecule *m);

/** Chains that hold it, as a tree or as a molecule with cycles. */
hol_chains *large_chains(const molecule *m);

/** Numbers that are none, at so many places, one at a time: each verb names the reason, and writes nothing. In the end
 * a bond has no length. */
void check_bad_data_change_nothing(const molecule *m, const hol_chains *chains, size_t places);

#endif
