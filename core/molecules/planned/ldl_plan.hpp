// Makes the list along which a graph, or a large tree, is eliminated.
#pragma once

#include <vector>

#include "core/molecules/given/lists.hpp"
#include "core/plan/elimination.hpp"
#include "core/plan/sparse_ldl.hpp"

namespace holonomic {

struct LdlArrays {
    Numbers atom_of, home, site_of, bond_of, from, to, row, row_4, column_4, mass, update, outer;
    std::vector<LdlPlan::Tile> tile;
    std::vector<LdlPlan::Subtree> subtree;
    std::vector<LdlPlan::ColumnRun> run;
    std::vector<LdlPlan::Late> late, late_entry;
    std::vector<LdlPlan::Visit> visit;
    LdlPlan list;
};

// `bonds` of each atom, and all bonds in an order of elimination that fills little: those of trees come first, so that
// none waits for more others than it must. Throws std::length_error where the factor fills up to 2^31 entries.
void make_ldl_plan(const EliminationPlan &s, Lists bonds, Numbers leaves_first, LdlArrays &arrays);
// Of a tree.
void make_ldl_plan(const EliminationPlan &s, Lists bonds, LdlArrays &arrays);

}  // namespace holonomic
