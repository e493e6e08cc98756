// Where the arrays of an elimination plan are.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/molecules/given/lists.hpp"
#include "core/molecules/planned/arms.hpp"
#include "core/molecules/planned/ldl_plan.hpp"
#include "core/molecules/planned/network.hpp"
#include "core/molecules/planned/path_plan.hpp"
#include "core/molecules/planned/runs.hpp"

namespace holonomic {

// What an elimination plan is made in, one after the other: its arrays, and what these are found with.
struct EliminationWork {
    Numbers atom_i, atom_j, atom_of, index_of, bond_of, bond_index_of, parent, child_start, child, pair_start, from, to,
        meet_start, meet, column_start, row;
    std::vector<std::uint8_t> fixed;

    Lists bonds;  // of each atom
    Numbers upper_bond, leaves, stack, next;
    Numbers degree;        // of an atom, without the bonds to those that were taken away before it
    Numbers leaves_first;  // bonds of a graph that has a list, as this eliminates them
};

struct EliminationPlan::Memory {
    std::vector<std::int64_t> block;  // all of these, one behind the other
    std::unique_ptr<const EliminationPlan> extended;

    // What small molecules, which may be many, have no need of.
    struct Large {
        TreeRuns runs;
        LdlArrays ldl;
        TreeArms arms;
        PathArrays paths;
        NetworkArrays network;
    };
    std::unique_ptr<Large> large;
    Large &of_large() {
        if (!large) large = std::make_unique<Large>();
        return *large;
    }
};

// Lets an elimination plan point to its arrays, all but those of large molecules.
void point_into(EliminationPlan &s, const EliminationWork &work);
// Moves them into the block of its memory. Keeps what a list is made from.
void pack(EliminationPlan &s, EliminationWork &work);
void clear(EliminationWork &work);

}  // namespace holonomic
