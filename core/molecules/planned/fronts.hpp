// The order in which the unknowns of a network are eliminated directly.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/molecules/given/lists.hpp"
#include "core/plan/network.hpp"

namespace holonomic {

struct FrontArrays {
    std::vector<FrontPlan::Front> front;
    std::vector<FrontPlan::Subtree> subtree;
    std::vector<FrontPlan::Spoke> spoke;
    Numbers row, to_parent, node, own_row, foreign_row, partner_row, hub, hub_of;
};

// Of a network whose plan has all but the fronts; none where they would take more than most_bytes. fixed: by local
// atom.
FrontPlan make_fronts(const NetworkPlan &s, const unsigned char *fixed, std::int64_t most_bytes, FrontArrays &arrays);

std::size_t bytes_of(const FrontArrays &arrays);

}  // namespace holonomic
