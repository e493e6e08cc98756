// How the extended-precision solver goes through a molecule: plain arrays.
#pragma once

#include <stdint.h>

namespace holonomic {

// Atoms with one bond are stripped until none is left. They are the hanging trees, and the bonds that remain are the
// core. A molecule without cycles keeps one atom, its root.
struct ExtendedPlan {
    int32_t n_atoms, n_bonds;
    const int32_t *atom_i, *atom_j;   // [n_bonds]
    const int32_t *arm_start, *arms;  // [n_atoms+1], [2 n_bonds]: the bonds of each atom
    const int64_t *table_start;       // [n_atoms+1]: sums of table_values() of the atoms before
    int32_t most_arms;                // of one atom
    const int32_t *parent;            // [n_atoms] bond towards the core or the root; -1 there
    int32_t n_hanging;                //
    const int32_t *hanging;           // [n_hanging] the stripped atoms, children before parents
    int32_t n_core;                   //
    const int32_t *core;              // [n_core] bonds in their order of elimination
    const int32_t *column_of;         // [n_bonds] its column, -1 for hanging bonds
    const int32_t *column_start;      // [n_core+1] columns of the factor, below the diagonal
    const int32_t *rows;              // [column_start[n_core]] ascending in each column
    const int32_t *ring;              // [n_bonds] in their order round the ring; nullptr if it is no bare ring
};

// How many numbers are kept of the multipliers at an atom of n bonds; of more than so many, see many.hpp.
constexpr int most_in_table = 64;
constexpr int64_t values_of_many(int64_t n) { return 17 * n + 16; }
constexpr int64_t table_values(int64_t n) { return n > most_in_table ? values_of_many(n) : n * n; }

// Molecules of more bonds are not done again in four times the precision, which would take a kilobyte per bond.
constexpr int32_t most_quad_double = 65536;

}  // namespace holonomic
