// Atoms of a network with many strands, its *hubs*: where their bonds are eliminated, and with which others.
#pragma once

#include <cstdint>
#include <vector>

#include "core/molecules/given/lists.hpp"
#include "core/molecules/planned/bisection.hpp"
#include "core/plan/network.hpp"

namespace holonomic {

// The ends at a node are all coupled to each other. Of more than these, three numbers of its acceleration stand
// for that: they are unknowns, too, and couple to each end alone.
constexpr std::int32_t most_at_node = 64;

// What is divided among fronts: *cells*, which are all other nodes, and strands of several bonds between two hubs.
struct Cells {
    // Of an unknown, where its own terms are, and where it is coupled to what else than hubs.
    struct Places {
        std::int32_t own, other;
    };
    WeightedGraph graph;             // cells and the strands between them, each of weight 1
    Numbers node;                    // [cells] or -1
    Numbers cell_of;                 // [n_nodes] -1 of hubs
    Numbers hub, hub_of;             // nodes; [n_nodes] which hub a node is, or -1
    Numbers unknowns;                // [cells] how many
    std::vector<Places> of_unknown;  // [n_unknowns]
    // [n_unknowns] What follows hubs: bonds from a hub to another, or to a fixed atom, of which nothing is left without
    // hubs; and three ends at each hub, as many as bonds that may depend on others while the hub cannot move.
    std::vector<unsigned char> late;
    std::int32_t size() const { return static_cast<std::int32_t>(node.size()); }
};

// fixed: by local atom.
Cells cells_of(const NetworkPlan &s, const unsigned char *fixed);

}  // namespace holonomic
