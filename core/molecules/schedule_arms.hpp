// The arms of a large molecule's trees (core/kernels/molecules/schedule.hpp).
#pragma once

#include <cstdint>
#include <vector>

#include "core/kernels/molecules/schedule.hpp"

namespace holonomic {

struct ScheduleArms {
    std::vector<Schedule::Arm> arm;
    std::vector<Schedule::Stretch> stretch;
    std::vector<std::int32_t> share_start;
};

// From the parents, the children and the numbers of a schedule; none, if they have little of
// it. Takes O(n).
ScheduleArms arms_of(const Schedule &s);

}  // namespace holonomic
