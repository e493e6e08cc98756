// The order in which the bonds of a molecule that is no chain are eliminated, as flat arrays that a kernel runs
// through. Plain data, the same for every instruction set; core/molecules/planned/elimination_plan.hpp makes it.
#pragma once

#include <stdint.h>

#include "core/plan/way.hpp"

namespace holonomic {

// How many values are kept of k children: multipliers of their decomposition; or of the matrix of three rows
// (tree/many.hpp), and with k products for positions.
static constexpr int32_t values_of_joint(int32_t k) { return k > most_decomposed ? 9 + 3 * k : k * (k - 1) / 2; }

struct LdlPlan;      // core/plan/sparse_ldl.hpp
struct PathPlan;     // core/plan/paths.hpp
struct NetworkPlan;  // core/plan/network.hpp

// Atoms and bonds are renumbered. The *index* of an atom: first the atoms of the trees, each after its children, then
// the root of a tree, or the atoms of the core. In molecules that may go in lanes the indices of the children of all
// atoms of trees follow each other: child[i] = i. In larger ones those of all that hangs from an atom do. The index of
// a bond: a bond of a tree has the index of its lower atom, the one away from the root; the bonds of the core follow in
// the order of their elimination. The bond from atom s < n_tree to its parent has index s, and there are no bonds but
// n_tree + n_core.
//
// A core is what is left when atoms with one bond are stripped until there are none; a tree has none. All its atoms are
// movable, because fixed atoms are leaves; only a network keeps these, too.
struct EliminationPlan {
    enum CoreType : int32_t {
        tree,
        triangle,
        ring,   // one ring, and the trees that hang from it; with trees only up to largest_graph_in_lanes and
                // most_on_ring
        graph,  // any other core
    };
    CoreType type;
    Ways way;    // how it is solved; what follows is there where its ways need it
    bool alone;  // not beside others of its kind in lanes
    int32_t n_atoms, n_bonds;
    int32_t n_tree;        // bonds of trees
    int32_t n_core;        // bonds of the core
    int32_t n_core_atoms;  // 0 for a tree, whose root has index n_tree
    int32_t max_children;
    int32_t max_joint;  // children of an atom that are eliminated as one matrix of as many rows

    // As they were given: bond k joins the local atoms atom_i[k] and atom_j[k].
    const int32_t *atom_i, *atom_j;
    const uint8_t *fixed;  // [n_atoms] by local atom
    int32_t star_centre;   // the local atom at which all bonds of a star meet; or -1

    const int32_t *atom_of;        // [n_atoms] local atom of an index
    const int32_t *index_of;       // [n_atoms] and back
    const int32_t *bond_of;        // [n_bonds] local bond of an index
    const int32_t *bond_index_of;  // [n_bonds] and back, of junctions of paths alone

    // Trees: the bond vector at bond index s points from index parent[s] to index s, away from the root or the core.
    const int32_t *parent;       // [n_tree] index
    const int32_t *child_start;  // [n_atoms + 1] those of index s begin at child[child_start[s]], ascending
    const int32_t *child;        // [n_tree]
    const int32_t *pair_start;   // [n_atoms + 1] sums of values_of_joint(): where a joint's multipliers stand
    int32_t n_pairs;

    // The core: bond p, at bond index n_tree + p, points from index from[p] to index to[p]. In a ring or triangle bond
    // p joins the core's atoms p and p + 1, the last one to atom 0, and all point that way round.
    const int32_t *from, *to;  // [n_core]
    // The bonds that meet at core atom c, at index n_tree + c.
    const int32_t *meet_start;  // [n_core_atoms + 1]
    const int32_t *meet;        // [2 n_core]

    // The factor of the core's matrix, for the extended-precision solver: off-diagonal entries e of column p are
    // column_start[p]
    // .. column_start[p + 1], with rows row[e] > p, ascending.
    const int32_t *column_start;  // [n_core + 1]
    const int32_t *row;

    // Atoms of a large tree with children, where most can be worked on W at a time: within a run none depends on
    // another, and all have the same number of children, 4 standing for more. Indices [p indices_of_tile, (p + 1)
    // indices_of_tile) are tile p; atoms whose children, and theirs, are all in the same tile stand in its runs, the
    // others in those of tile n_tiles, the top, which comes last. No tiles: the tree is small, or its atoms don't
    // fill lanes.
    struct AtomRun {
        int32_t first, count, children;  // indices index[first] ..
        int32_t level;                   // how many atoms of the tile or the top must come before
    };
    struct Runs {
        const AtomRun *run;
        const int32_t *index;
        const int32_t *tile_start;  // [n_tiles + 2] runs of each tile, then of the top
    };
    Runs runs;
    int32_t n_tiles;

    // Of a graph, or of a large tree without tiles, unless the list would be long: all its bonds by sparse LDL^T; else
    // nullptr.
    const LdlPlan *ldl;
    // Of a large molecule of few junctions and long paths; else nullptr.
    const PathPlan *paths;

    // Of a large graph whose elimination would fill too much: its strands and nodes; then nothing is known of the
    // core's elimination, and there is no list and no path, and `extended` only if it is not too large.
    const NetworkPlan *network;

    // An arm: a path between two atoms of a large tree of which most is such paths, whose inner atoms have one child
    // each. Its atoms and its bonds have consecutive numbers, so that it can be worked on as a chain is, without
    // looking at the other arms. Indices of its atoms and bonds are consecutive in any case.
    struct Arm {
        int32_t bottom;  // index of its lowest atom: the indices of its bonds are bottom, bottom + 1 .., upwards
        int32_t n_bonds;
        int32_t first_atom, first_bond;                       // the first of its local atoms and bonds
        bool ascending;                                       // upwards
        int32_t inner_before;                                 // bonds but one of all arms before it
        int32_t top() const { return bottom + n_bonds - 1; }  // the index of its highest bond
    };
    // What is between arms: atoms that are no arm's inner ones, and bonds that are not in an arm's segments - those of
    // the chain that the arm is without its last bond.
    struct Stretch {
        int32_t first, end;              // indices
        int32_t first_index, end_index;  // and bond indices
        int32_t arm;                     // that goes on behind these indices; the last stretch has none
    };
    const Arm *arm;
    int32_t n_arms;              // 0: they are not worth it
    const Stretch *stretch;      // [n_arms + 1] in the order of their indices
    const int32_t *share_start;  // [n_shares + 1] arms that one thread works on at a time
    int32_t n_shares;

    int64_t extended_bytes;  // scratch memory of the extended-precision solver and its plan; not of networks
    int64_t more_of_metric;  // and what a metric takes beside that, where atoms have many bonds
    // Of a network: an order of elimination for the extended-precision solver, if it fills little; and one that is made
    // once a metric has been asked for, which no other call uses.
    const EliminationPlan *extended;
    mutable const EliminationPlan *late_extended = nullptr;
    // Of a large tree that is a batch of trees: a list that is made once factors are kept, which no other call uses.
    mutable const LdlPlan *late_ldl = nullptr;

    EliminationPlan() = default;
    EliminationPlan(const EliminationPlan &) = delete;
    EliminationPlan &operator=(const EliminationPlan &) = delete;
    ~EliminationPlan();
    struct Memory;
    Memory *memory = nullptr;  // where the arrays are
};

// No members: each set of kernels must have its own.
// The order of elimination for the extended-precision solver; or nullptr.
static inline const EliminationPlan *extended_order(const EliminationPlan &s) {
    return !s.network ? &s : s.extended ? s.extended : s.late_extended;
}
// The list along which factors are kept for right-hand sides that are given; or nullptr.
static inline const LdlPlan *list_of_kept(const EliminationPlan &s) {
    if (s.way.given != Way::sparse_ldl && s.way.given != Way::large_tree) return nullptr;
    return s.ldl ? s.ldl : s.late_ldl;
}

}  // namespace holonomic
