// Makes the list along which a graph, or a large tree, is eliminated.
#pragma once

#include <vector>

#include "core/kernels/molecules/list/flat_list.hpp"
#include "core/kernels/molecules/schedule.hpp"
#include "core/molecules/lists.hpp"

namespace holonomic {

struct FlatArrays {
    Numbers atom_of, home, place_of, bond_of, from, to, row, row_4, column_4, mass, update, outer;
    std::vector<FlatList::Tile> tile;
    std::vector<FlatList::Branch> branch;
    std::vector<FlatList::Run> run;
    std::vector<FlatList::Late> late, late_entry;
    std::vector<FlatList::Visit> visit;
    FlatList list;
};

// Of a molecule whose bonds have been numbered: trees first, then the core in its order. Throws std::length_error where
// the factor fills up to 2^31 entries.
void make_flat_list(const Schedule &s, FlatArrays &arrays);

}  // namespace holonomic
