// Where the arrays of a schedule are.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/molecules/flat_list.hpp"
#include "core/molecules/lists.hpp"
#include "core/molecules/network.hpp"
#include "core/molecules/path_plan.hpp"
#include "core/molecules/schedule_arms.hpp"
#include "core/molecules/schedule_runs.hpp"

namespace holonomic {

// While they are made.
struct ScheduleArrays {
    Numbers atom_i, atom_j, atom_of, slot_of, bond_of, place_of, parent, child_start, child, pair_start, from, to,
        meet_start, meet, meet_pair, meet_pair_start, column_start, row, update;
    std::vector<std::int64_t> update_start;
    std::vector<std::uint8_t> fixed;
};

struct Schedule::Memory {
    std::vector<std::int64_t> block;  // all of these, one behind the other
    std::unique_ptr<const Schedule> careful;

    // What small molecules, which may be many, have no need of.
    struct Large {
        ScheduleRuns runs;
        FlatArrays flat;
        ScheduleArms arms;
        PathArrays paths;
        NetworkArrays network;
    };
    std::unique_ptr<Large> large;
    Large &of_large() {
        if (!large) large = std::make_unique<Large>();
        return *large;
    }
};

// Lets a schedule point to its arrays, all but those of large molecules.
void point_into(Schedule &s, const ScheduleArrays &arrays);
// Moves them into the block of its memory.
void pack(Schedule &s, ScheduleArrays &arrays);

}  // namespace holonomic
