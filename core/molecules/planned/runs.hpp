// Which atoms of a large molecule's trees can be worked on at once (core/plan/elimination.hpp).
#pragma once

#include <cstdint>
#include <vector>

#include "core/plan/elimination.hpp"

namespace holonomic {

struct TreeRuns {
    std::vector<EliminationPlan::AtomRun> run;
    std::vector<std::int32_t> index, tile_start;
    EliminationPlan::Runs runs() const { return {run.data(), index.data(), tile_start.data()}; }
};

// From the parents and the children of an elimination plan. Takes O(n).
TreeRuns runs_of(const EliminationPlan &s);

// How many elements the atoms of a large tree take in lanes, empty ones included (core/plan/tree_batch.hpp).
std::int64_t elements_in_lanes(const TreeRuns &runs);

}  // namespace holonomic
