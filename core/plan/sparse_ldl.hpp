// The elimination of a molecule with cycles, or of a large one: all its bonds, those of trees too, by sparse LDL^T, as
// flat arrays.
// Plain data, the same for every instruction set; core/molecules/planned/ldl_plan.hpp makes it.
#pragma once

#include <stdint.h>

namespace holonomic {

// Bonds are renumbered in the order of their elimination, in which what depends on each other stands together: a
// post-order of the elimination's tree, in which what does not wait for each other follows each other. The list is cut
// into *tiles* that fit into a cache, so that all that is to be done with a tile is done while it is there. A tile
// knows nothing of the others while it is worked on:
// - its atoms are its own, those that no tile before it has, and ghosts, which are copies of others' atoms;
// - its bonds are its own, and extra ones, which are copies of later bonds at the atoms of these;
// - what it gives to columns and entries of later tiles it gives to *contributions* of its own, from which they fetch
// it. Numbers of atoms, bonds and masses count from the tile's first one. Arrays over bonds and entries are padded with
// inert ones to multiples of four.
struct LdlPlan {
    int32_t n_atoms, n_bonds;
    int32_t n_sites;                              // atoms of all tiles, ghosts too
    int32_t n_rows;                               // bonds of all tiles, extra ones too
    int32_t n_columns;                            // bonds, then contributions
    int32_t n_entries;                            // then contributions
    int32_t most_sites, most_rows, most_columns;  // of a tile

    static constexpr int32_t columns_of_tile = 32768;
    struct Tile {
        int32_t first_site, own_end, end_site;  // ghosts from own_end on
        int32_t first_row, end_row;             // extra ones behind as many as there are columns, in fours
        int32_t first, end;                     // columns
        int32_t first_entry, end_entry;
        int32_t first_run, end_run;
        int32_t first_late, end_late;
        int32_t first_late_entry, end_late_entry;
        int32_t first_visit, end_visit;
        int32_t first_outer, end_outer;
        int64_t first_update;
    };
    const Tile *tile;
    int32_t n_tiles;
    // Tiles of a large molecule that need nothing of other subtrees, for one thread. What needs several is the
    // *separator*, the last tiles, which stand behind the subtrees as one more.
    struct Subtree {
        int32_t first, end;
    };
    const Subtree *subtree;  // [n_subtrees + 1]
    int32_t n_subtrees;      // 0: all is the separator

    const int32_t *atom_of;  // [n_sites] local atom
    const int32_t *home;     // [n_sites] where it is its tile's own
    const int32_t *site_of;  // [n_atoms] the site that is its home
    const int32_t *bond_of;  // [n_bonds] local bond of a column; inert ones have bond 0
    // Bond k points from one atom to another. Four times their numbers, which saves a shift where rows are read.
    const int32_t *from, *to;  // [n_rows]
    // Off-diagonal entries of the factor, column by column: rows ascending, all > k in column k. The columns of a run
    // have as many entries each.
    struct ColumnRun {
        int32_t columns, entries;
    };
    const ColumnRun *run;
    const int32_t *row;  // [n_entries] columns or contributions
    // What an entry starts from, before fill: w d.d' with four times the number of its row and column, and the place of
    // the inverse mass of the atom that both share among -w_0, w_0, -w_1, .. , 0, by sign.
    const int32_t *row_4, *column_4, *mass;
    // Column k takes from the entry (row[a], row[b]), a > b, its product a b / pivot: (1, 0), (2, 0), (2, 1) .. of one
    // column behind the other.
    const int32_t *update;

    // Columns and entries that tiles before have given something to, and where it is.
    struct Late {
        int32_t number, contribution;
    };
    const Late *late, *late_entry;
    // Ghosts of later tiles, with bonds of these: what pulls them pulls the tile's own atom.
    struct Visit {
        int32_t own, ghost;  // sites
    };
    const Visit *visit;
    const int32_t *outer;  // columns whose atoms are ghosts, or which are late, ascending
};

// Four times a number must fit.
constexpr int32_t largest_in_ldl = INT32_MAX / 16;

constexpr int64_t in_fours(int64_t n) { return (n + 3) / 4 * 4; }

}  // namespace holonomic
