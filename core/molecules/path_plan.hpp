// The paths and knots of a large molecule (core/kernels/molecules/paths/path_plan.hpp).
#pragma once

#include <memory>
#include <vector>

#include "core/kernels/molecules/paths/path_plan.hpp"
#include "core/kernels/molecules/schedule.hpp"
#include "core/molecules/lists.hpp"

namespace holonomic {

struct PathArrays {
    std::vector<PathPlan::Path> path;
    std::vector<PathPlan::Piece> piece;
    std::vector<PathPlan::Kind> kind;
    std::vector<PathPlan::Leg> leg;
    Numbers atom, bond;
    std::vector<std::unique_ptr<const Schedule>> schedule;
    PathPlan plan;
};

// Returns whether paths pay in a molecule whose bonds and fixed atoms are known: knots are few, and of few kinds. Takes
// O(n).
bool make_path_plan(const Schedule &s, PathArrays &arrays);

}  // namespace holonomic
