// Which atoms of a large molecule's trees can be worked on at once (core/kernels/molecules/schedule.hpp).
#pragma once

#include <cstdint>
#include <vector>

#include "core/kernels/molecules/schedule.hpp"

namespace holonomic {

struct ScheduleRuns {
    std::vector<Schedule::Run> run;
    std::vector<std::int32_t> slot, piece_start;
    Schedule::Runs runs() const { return {run.data(), slot.data(), piece_start.data()}; }
};

// From the parents and the children of a schedule. Takes O(n).
ScheduleRuns runs_of(const Schedule &s);

// In how many places of lanes the atoms of a large tree stand, empty ones included.
std::int64_t places_in_lanes(const ScheduleRuns &runs);

}  // namespace holonomic
