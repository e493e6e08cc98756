// Trees of any shapes side by side, one in each lane, or atoms of one large tree in all of them, as flat arrays that a
// kernel runs through. Plain data, the same for every instruction set of as many lanes;
// core/molecules/planned/tree_batches.hpp makes it.
#pragma once

#include <stdint.h>

#include "core/plan/elimination.hpp"

namespace holonomic {

// A step deals with one atom of each tree and with the bonds to its children, which have been dealt with before. The
// bonds of a step have consecutive *rows*, the same in all lanes. Where an atom has fewer children, or a tree has
// nothing to do, rows are empty: what is eliminated there is a bond of length 0 with E = 1, which leaves every digit
// as it is. An atom of at most three children may share a step with others of at most three, one of up to
// most_decomposed with others of as many, and so on. The last step has the roots.
//
// Of one large tree a step has atoms that do not depend on each other, each with the bonds to its children in a lane of
// its own; the bond above may be in any lane. Its steps are cut into the tiles of the elimination plan, and then come
// those of the top.
//
// Numbers per step or row are [..][lanes]. An *element* is a row's number times that of lanes, plus the lane.
struct TreeBatch {
    struct Step {
        int32_t first, children;  // its rows; the most that an atom of it has
        int32_t pairs;            // sum of values_of_joint() over the steps before
    };
    int32_t n_trees;  // in the first lanes; the others are empty
    int32_t n_steps, n_bond_rows;
    int32_t n_pairs;        // sum of values_of_joint() over the steps
    int32_t most_children;  // of a step
    int64_t most_atoms;     // of a tree
    const Step *step;
    const int32_t *atom;   // per step: its atom; 0 in lanes that have none
    const int32_t *above;  // per step: the element of the bond above; of a root in row n_bond_rows, without an atom in
                           // the row behind, of which each tile has its own
    const int32_t *lower;  // per row: the child; of an empty row the step's atom
    const int32_t *bond;   // per row, or 0
    const uint16_t *held;  // [n_bond_rows] bits: the lanes that have a bond here
    int32_t n_tiles;       // of one large tree, else 0
    const int32_t *tile_start;  // [n_tiles + 2] steps of each tile, then of the top with the root
    const int32_t *element;     // by index: of the bond above
    int32_t n_rows() const { return n_bond_rows + 2 + n_tiles; }
    const EliminationPlan *const *elimination;  // [n_trees]

    // Steps and what there is per step and row are one block of numbers: point_into() says in which order. Of
    // different trees, which are many, it is stored in half the memory, and opened when it is worked on
    // (open_batch.hpp).
    const uint16_t *stored;  // or nullptr
    int64_t n_numbers(int64_t lanes) const {
        return 3 * n_steps + 2 * lanes * (static_cast<int64_t>(n_steps) + n_bond_rows);
    }
    void point_into(const int32_t *number, int64_t lanes) {
        step = reinterpret_cast<const Step *>(number);
        atom = number + 3 * static_cast<int64_t>(n_steps);
        above = atom + lanes * n_steps;
        lower = above + lanes * n_steps;
        bond = lower + lanes * n_bond_rows;
        element = bond + lanes * n_bond_rows;
    }
};

}  // namespace holonomic
