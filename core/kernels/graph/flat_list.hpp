// The elimination of one large molecule: all its bonds, those of trees too, along one list, as flat arrays.
// Plain data, the same for every instruction set; core/molecules/flat_list.hpp makes it.
#ifndef HOLONOMIC_KERNELS_GRAPH_FLAT_LIST_HPP
#define HOLONOMIC_KERNELS_GRAPH_FLAT_LIST_HPP

#include <stdint.h>

namespace holonomic {

// Bonds are renumbered in the order of their elimination, in which what depends on each other stands together: a
// post-order of the elimination's tree, in which what does not wait for each other follows each other; atoms as these
// bonds come to them. Arrays over bonds and entries are padded with inert ones to multiples of four.
struct FlatList {
    int32_t n_atoms, n_bonds, n_entries;
    const int32_t *atom_of;   // [n_atoms] local atom
    const int32_t *place_of;  // [n_atoms] and back
    const int32_t *bond_of;   // [n_bonds] local bond; inert ones have bond 0
    // Bond k points from one atom to another. Four times their numbers, which saves a shift where rows are read.
    const int32_t *from, *to;
    // Off-diagonal entries of the factor, column by column: rows ascending, all > k in column k. The columns of a run
    // have as many entries each.
    struct Run {
        int32_t columns, entries;
    };
    const Run *run;  // [n_runs]
    int32_t n_runs;
    const int32_t *row;  // [n_entries]
    // What an entry starts from, before fill: w d.d' with four times the number of its row and column, and the place of
    // the inverse mass of the atom that both share among -w_0, w_0, -w_1, .. , 0, by sign.
    const int32_t *row_4, *column_4, *mass;
    // Column k takes from the entry (row[a], row[b]), a > b, its product a b / pivot: (1, 0), (2, 0), (2, 1) .. of one
    // column behind the other.
    const int32_t *update;
};

// Four times a number must fit.
constexpr int32_t largest_in_list = INT32_MAX / 8;

constexpr int64_t in_fours(int64_t n) { return (n + 3) / 4 * 4; }

}  // namespace holonomic
#endif
