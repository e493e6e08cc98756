// Makes the arrays of a list (ldl_plan.hpp) in two steps: its tiles with their atoms and bonds, then the entries of the
// factor's columns and what they take from each other.
#pragma once

#include <vector>

#include "core/molecules/planned/ldl_plan.hpp"

namespace holonomic {

// What the second step needs to know of the first. A column is a bond in the order of elimination.
struct LdlColumns {
    Numbers start, row;          // of the factor's columns
    Numbers end;                 // [][2] atoms of a column
    Numbers tile_of;             // of a column
    std::vector<Numbers> extra;  // by tile, columns that are its extra bonds
    Numbers visiting;            // by tile, its atoms that its own bonds have
    std::int32_t end_of(std::int32_t p, int which) const { return end[at(2 * p + which)]; }
};

// `bonds` of each atom as in make_ldl_plan().
LdlColumns make_ldl_tiles(const EliminationPlan &, Lists bonds, Numbers leaves_first, LdlArrays &);
void list_ldl_entries(const LdlColumns &, LdlArrays &);

}  // namespace holonomic
