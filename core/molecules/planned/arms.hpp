// The arms of a large molecule's trees (core/plan/elimination.hpp).
#pragma once

#include <cstdint>
#include <vector>

#include "core/plan/elimination.hpp"

namespace holonomic {

struct TreeArms {
    std::vector<EliminationPlan::Arm> arm;
    std::vector<EliminationPlan::Stretch> stretch;
    std::vector<std::int32_t> share_start;
};

// From the parents, the children and the numbers of an elimination plan; none, if they have little of
// it. Takes O(n).
TreeArms arms_of(const EliminationPlan &s);

}  // namespace holonomic
