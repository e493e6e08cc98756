/* The same molecules in the same order, counted from 1: a set keeps the base with which it was made. */
#ifndef TESTS_FROM_ONE_H
#define TESTS_FROM_ONE_H

#include <holonomic.h>
#include <stdlib.h>

#include "check.h"

static inline hol_chains *from_one(const hol_chains *chains)
{
    const size_t n_atoms = (size_t)hol_chains_n_atoms(chains), n_bonds = (size_t)hol_chains_n_bonds(chains);
    double *mass = malloc((n_atoms + 1) * sizeof *mass), *length = malloc((n_bonds + 1) * sizeof *length);
    double *own = malloc((n_bonds + 1) * sizeof *own);
    int64_t *pairs = malloc((2 * n_bonds + 1) * sizeof *pairs), *list = malloc((2 * n_bonds + 2) * sizeof *list);
    int64_t *bonds = malloc((n_bonds + 1) * sizeof *bonds);
    hol_chains *copy;
    CHECK(hol_chains_masses(chains, mass));
    CHECK(hol_chains_pairs(chains, pairs));
    CHECK(hol_chains_lengths(chains, length));
    CHECK(hol_chains_create((int64_t)n_atoms, mass, &copy));
    CHECK(hol_chains_set_index_base(copy, 1));
    for (int64_t m = 0; m < hol_chains_n_molecules(chains); ++m) {
        int shape;
        int64_t atoms, n;
        CHECK(hol_chains_molecule(chains, m, &shape, &atoms, &n));
        CHECK(hol_chains_bonds(chains, m, bonds));
        for (int64_t k = 0; k < n; ++k) own[k] = length[bonds[k]];
        if (shape == HOL_SHAPE_CHAIN) {
            CHECK(hol_chains_atoms(chains, m, list));
            for (int64_t i = 0; i <= n; ++i) ++list[i];
            CHECK(hol_chains_add(copy, n, list, own));
        } else {
            for (int64_t e = 0; e < 2 * n; ++e) list[e] = pairs[2 * bonds[e / 2] + e % 2] + 1;
            CHECK(hol_chains_add_bonds(copy, n, list, own));
        }
    }
    free(mass), free(length), free(own), free(pairs), free(list), free(bonds);
    return copy;
}

#endif
