// Divides one large molecule into strands and nodes.
#pragma once

#include <cstddef>
#include <vector>

#include "core/molecules/given/lists.hpp"
#include "core/molecules/planned/fronts.hpp"
#include "core/plan/elimination.hpp"
#include "core/plan/network.hpp"

namespace holonomic {

// Calls each(unknown) for the own ones of a node.
template <class Each>
void for_own(const NetworkPlan &s, std::int32_t node, const Each &each) {
    const NetworkPlan::Nodes &n = s.nodes[s.nodes_of[node]];
    for (std::int32_t i = 0; i < n.n_own; ++i) each(n.first_unknown + i * n.count + node - n.first_node);
}

struct NetworkArrays {
    std::vector<NetworkPlan::Bundle> bundle;
    std::vector<NetworkPlan::Nodes> nodes;
    Numbers bundle_start, nodes_start, unknown_start, nodes_of, atom_of, bond_of, from, to, strand_node, strand_unknown,
        bond_index_of, node_of, partner, foreign_start, foreign, other_node, child_start, child;
    std::vector<double> sign;
    FrontArrays fronts;
    NetworkPlan plan{};
};

// Of a molecule whose trees have been numbered, with all bonds between atoms of the core behind them.
// Its unknowns can be eliminated directly if that takes no more than most_bytes.
void make_network(const EliminationPlan &s, std::int64_t most_bytes, NetworkArrays &arrays);

std::size_t bytes_of(const NetworkArrays &arrays);

}  // namespace holonomic
