// The ways that a molecule that is no chain may take, and their limits. core/molecules/planned/way.cpp decides, once
// per shape; all others switch over what it has said.
#pragma once

#include <stdint.h>

namespace holonomic {

enum class Way : int32_t {
    triangle,    // triangle/: three atoms with three distances, in closed form
    star,        // star/: three or four bonds at one atom, in closed form
    ring,        // ring/: a ring without side atoms, along the ring
    tree,        // tree/: W molecules in lanes, leaves first; ring/ for the ring of a ring with trees
    sparse_ldl,  // sparse_ldl/: L D L^T of all bonds; W molecules in lanes, or a large one by itself
    large_tree,  // tree_batch/: one large tree, W of its atoms at a time
    armed_tree,  // armed_tree/: one large tree of long linear parts, these as chains; else sparse LDL^T
    paths,       // paths/: one large molecule of long linear parts, joined at junctions; else sparse LDL^T
    network,     // network/: one large molecule of strands that meet at nodes
    extended,    // extended/: in twice the precision, one by one
};

// By what is asked. Velocities take the way of forces.
struct Ways {
    Way forces, given, positions, metric;  // given: for right-hand sides of the caller's
    Way without_paths;                     // of positions where paths won't do
};
// Positions of what is in a batch of trees for its forces: the largest trees have another way.
static inline bool moves_in_batch(Way positions) { return positions == Way::tree || positions == Way::large_tree; }

// Molecules of more bonds are worked on one by one, trees in tiles.
constexpr int32_t largest_in_lanes = 2048;
// Those with cycles gain nothing by lanes from fewer on: sparse LDL^T serves one of them as fast as lanes serve each of
// four, and most are the only one of their kind.
constexpr int32_t largest_graph_in_lanes = 256;
// The most children of an atom of a ring with trees: chemical ones have no more. With others it is a graph.
constexpr int32_t most_on_ring = 2;
constexpr int32_t indices_of_tile = 2048;  // so many bonds at work fill a second-level cache

// Bonds of an arm: what is done once an arm is little beside what is done for its bonds, and these stay in cache. All
// but one are a multiple of arm_step, so that segments in as many lanes are equally long.
constexpr int32_t arm_step = 8, shortest_arm = 5 * arm_step + 1, longest_arm = 128 * arm_step + 1;

// An atom of a tree with more children is eliminated by a matrix of three rows (tree/many.hpp).
constexpr int32_t most_decomposed = 7;

}  // namespace holonomic
