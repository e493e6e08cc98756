// Which way a molecule that is no chain takes (core/plan/way.hpp): each question, in the order in which
// a shape is planned. The shape alone answers them.
#pragma once

#include <cstdint>

#include "core/molecules/given/lists.hpp"
#include "core/plan/elimination.hpp"

namespace holonomic {

// Whether a core of as many bonds as atoms goes round as a ring: `most_trees` hang from one of its atoms.
bool is_ring(const EliminationPlan &s, std::int32_t most_trees);

// Whether the list of a graph, or of a large tree, is not much longer than the molecule. `bonds` of each atom.
bool has_short_ldl(const EliminationPlan &s, const Lists &bonds);

// Whether a graph may be a network: `ends` of strands meet at its nodes.
bool is_mostly_strands(const EliminationPlan &s, std::int64_t ends);
// A graph whose elimination fills more is a network, too.
std::int64_t most_bytes_of_ldl(const EliminationPlan &s);

// What the order for the extended-precision solver may fill, which a network has besides; 0: it has none.
std::int64_t most_bytes_of_extended(const EliminationPlan &s);

// A tree that comes alone; whether it is mostly arms, and else whether its atoms fill lanes, of which they take so many
// elements.
bool is_large_tree(const EliminationPlan &s);
bool is_mostly_arms(const EliminationPlan &s, std::int64_t bonds_in_arms);
bool fills_lanes(const EliminationPlan &s, std::int64_t elements);

// Whether a molecule needs a list, and whether paths are looked for.
bool takes_ldl(const EliminationPlan &s, const Lists &bonds);
bool may_have_paths(const EliminationPlan &s);

// Says which way it takes, once all is made that the ways need.
void choose_ways(EliminationPlan &s);

// Whether different trees may share lanes with this one.
bool mixes(const EliminationPlan &s);
// Whether threads can share one molecule beyond the tiles of a tree; `paths`: positions.
bool has_shares(const EliminationPlan &s, bool paths);

}  // namespace holonomic
