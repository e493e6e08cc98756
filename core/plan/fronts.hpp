// How the unknowns of a network are eliminated directly. Plain data; core/molecules/planned/fronts.hpp makes it.
#pragma once

#include <stdint.h>

namespace holonomic {

// The nodes are halved again and again, where few strands go from one half to the other. A *front* belongs to a part: a
// dense matrix of the unknowns that it eliminates, its *own* ones, and of those that then are coupled, of strands that
// leave the part. A *leaf*, which is not halved any more, has the terms of its nodes; any other one has what its two
// halves leave. Its own unknowns are, of each strand between the halves, the one at the strand's first node.
//
// A *hub*, a node with many ends, belongs to no part. With its inverse mass w = L U its terms D w b^T, D and b of all
// its ends, are what three more unknowns leave:
//
//     [ A   D L ]
//     [ U b^T -1 ]
//
// They follow those of A in number, and are eliminated where all ends meet. The leaves of the other ends have the
// terms.
struct FrontPlan {
    struct Front {
        int32_t n_own, n_rows;         // the own ones first, then all others, in the order of elimination
        int32_t first_row;             // in row, to_parent
        int32_t first_node, end_node;  // in node; none of what is halved
        int32_t first_spoke, end_spoke;
        int32_t half[2];  // fronts, or -1
        int32_t subtree;  // -1: of the separator
    };
    // A front with all that it is made of, for one thread. What has several subtrees below it is the *separator*, whose
    // fronts come one after the other.
    struct Subtree {
        int32_t first, end;  // in front
    };
    // An end at a hub. Of two that are a strand's, the second one has what couples them.
    struct Spoke {
        int32_t unknown, hub;
        int32_t row, hub_row;  // in the leaf: its own, and the first of three
        int32_t partner_row;   // or -1
        int32_t sign;          // -1 where it is foreign
        bool is_first;         // of the hub
    };
    int32_t n_fronts;  // 0: there are none
    int32_t n_subtrees;
    const Front *front;  // the halves before the whole
    const Subtree *subtree;
    const int32_t *row;          // unknowns
    const int32_t *to_parent;    // their rows in the front of which this one is a half
    const int32_t *node;         // of leaves
    const int32_t *own_row;      // [n_unknowns] the row of an unknown in the leaf of its node
    const int32_t *foreign_row;  // of the entries of NetworkPlan::foreign, likewise
    const int32_t *partner_row;  // [n_unknowns] in the leaf of the unknown's node, where that couples the two; or -1
    int32_t n_hubs;
    const int32_t *hub;     // nodes
    const int32_t *hub_of;  // [n_nodes] or -1
    const Spoke *spoke;     // those of a leaf together
    double rounds;          // of the iteration that take as long as the fronts
    bool at_once;           // whether it would take more
};

}  // namespace holonomic
