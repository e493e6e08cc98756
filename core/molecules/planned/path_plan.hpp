// The paths and junctions of a large molecule (core/plan/paths.hpp).
#pragma once

#include <memory>
#include <vector>

#include "core/molecules/given/lists.hpp"
#include "core/plan/elimination.hpp"
#include "core/plan/paths.hpp"

namespace holonomic {

struct PathArrays {
    std::vector<PathPlan::Path> path;
    std::vector<PathPlan::Section> section;
    std::vector<PathPlan::JunctionKind> kind;
    std::vector<PathPlan::Overlap> overlap;
    Numbers atom, bond;
    std::vector<std::unique_ptr<const EliminationPlan>> elimination;
    PathPlan plan;
};

// Returns whether paths pay in a molecule whose bonds and fixed atoms are known: junctions are few, and of few kinds.
// Takes O(n).
bool make_path_plan(const EliminationPlan &s, PathArrays &arrays);

}  // namespace holonomic
