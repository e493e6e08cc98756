// One large molecule of strands that meet at nodes: a gel, a lattice. Plain data, the same for every instruction set;
// core/molecules/planned/network.hpp makes it.
#pragma once

#include <stdint.h>

#include "core/plan/fronts.hpp"

namespace holonomic {

// A *node* is an atom of the core with trees, or with other than two bonds of the core; a *strand* the bonds between
// two nodes. The first and the last bond of a strand are its *ends*, and the *unknowns* of what is left when strands
// and trees have been eliminated; a strand of one bond is one, of its first node, and *foreign* at its second one.
// Nodes of a share with as many own unknowns stand together: unknown i of the j-th of them is first_unknown + i count +
// j.
//
// Up to most_in_bundle strands of one length are a *bundle*: bond k of strand j stands at bond index first_index + k
// width + j, the atom between bonds k - 1 and k at site first_site + (k - 1) width + j. Indices of trees' bonds follow,
// each after those of the bonds below it; sites of the nodes follow, then, as the bond indices are, those of the trees'
// atoms.
struct NetworkPlan {
    static constexpr int32_t most_in_bundle = 8;
    static constexpr int32_t fetched_ahead = 48;  // what stands so many sites ahead
    int32_t n_atoms, n_bonds, n_strands, n_nodes, n_unknowns, n_tree;
    int32_t first_node, first_tree;  // sites
    int32_t first_tree_bond;
    bool has_foreign;

    struct Bundle {
        int32_t width, length, first_index, first_site, first_strand;
    };
    const Bundle *bundle;
    const int32_t *bundle_start;  // [n_shares + 1] those that a thread works on at a time
    int32_t n_shares;

    struct Nodes {
        int32_t count, n_own, first_node, first_unknown;
    };
    const Nodes *nodes;
    const int32_t *nodes_start;    // [n_node_shares + 1] those that a thread works on at a time
    const int32_t *unknown_start;  // [n_node_shares + 1] and their unknowns
    int32_t n_node_shares;

    const int32_t *atom_of;         // [n_atoms + fetched_ahead] local atom of a site
    const int32_t *bond_of;         // [n_bonds] local bond of an index
    const int32_t *from, *to;       // [n_bonds] sites; of a tree's bond `to` is the atom away from the core
    const int32_t *strand_node;     // [2 n_strands] nodes of the first and the last end
    const int32_t *strand_unknown;  // [2 n_strands] and their unknowns
    const int32_t *nodes_of;        // [n_nodes] in `nodes`
    const int32_t *bond_index_of;   // [n_unknowns]
    const int32_t *node_of;         // [n_unknowns]
    const int32_t *partner;         // [n_unknowns] the other end of its strand, or itself if the strand is one bond
    const double *sign;             // [n_unknowns] 1 where it points away from its node, else -1
    const int32_t *foreign_start;   // [n_nodes + 1]
    const int32_t *foreign;         // unknowns
    const int32_t *other_node;      // [n_unknowns] where it is foreign, or -1
    const int32_t *child_start;     // [n_nodes + n_tree + 1] bonds of trees below a node, then below a tree's atom
    const int32_t *child;           // bond indices, counted from the first of a tree

    FrontPlan fronts;
};

}  // namespace holonomic
