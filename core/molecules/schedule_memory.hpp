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

// What a schedule is made in, one after the other: its arrays, and what these are found with.
struct ScheduleWork {
    Numbers atom_i, atom_j, atom_of, slot_of, bond_of, place_of, parent, child_start, child, pair_start, from, to,
        meet_start, meet, column_start, row;
    std::vector<std::uint8_t> fixed;

    Lists bonds;  // of each atom
    Numbers upper_bond, degree, stack, next;
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
void point_into(Schedule &s, const ScheduleWork &work);
// Moves them into the block of its memory.
void pack(Schedule &s, ScheduleWork &work);
void clear(ScheduleWork &work);

}  // namespace holonomic
