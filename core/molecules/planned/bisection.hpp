// Cuts a graph into two halves with few edges between them.
#pragma once

#include <cstdint>
#include <vector>

#include "core/molecules/given/lists.hpp"

namespace holonomic {

// An undirected graph: each edge stands in the lists of both its vertices.
struct WeightedGraph {
    struct Edge {
        std::int32_t to, weight;
    };
    Numbers start, weight;  // [n + 1], [n] of vertices
    std::vector<Edge> edge;
    std::int32_t size() const { return static_cast<std::int32_t>(weight.size()); }
};

// 0 or 1 for each vertex: halves by weight, but for some tenths of it where that cuts less. The graph alone decides.
std::vector<unsigned char> bisect(const WeightedGraph &graph);

}  // namespace holonomic
