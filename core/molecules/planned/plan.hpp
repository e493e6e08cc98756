// How a call goes through the molecules: chunks of work of a few thousand bonds, the same for any number of threads.
#pragma once

#include <cstdint>
#include <vector>

#include "core/kernels/call.hpp"
#include "core/molecules/planned/shapes.hpp"
#include "core/molecules/planned/tree_batches.hpp"

namespace holonomic {

// Where the arrays of a molecule stand for the kernels: in the caller's memory, or apart from it
// (core/run/staging.hpp).
enum Where { in_place = 0, reordered = 1, staged = 2 };  // values per bond; atoms; both: 3
constexpr int n_wheres = 4;
// Beside it: molecules whose masses or lengths are in units far from ordinary ones (core/run/rescale.hpp).
constexpr int far_units = 4;

// Made at the first use after a change. Which molecules share a unit, or a block of lanes in it, changes no result.
struct Plan {
    struct Chunk {
        std::int64_t group;         // `count` molecules of this group from `first` on, or
        std::int64_t first, count;  // if group == -1: these of the gathered chains, or of the gathered molecules
        std::int64_t stage;         // of the first, or -1
        std::int64_t part;          // of its chains, or -1: all of them
        std::int32_t shape;         // of all its molecules; of batches of trees, of the first
        int where;
        std::int64_t first_batch = 0, n_batches = 0;  // into which its molecules are put
    };
    // A fixed atom that stands in the stage more than once.
    struct Copy {
        std::int64_t atom, place;
    };
    std::vector<Chunk> chunks;
    // The only chunk, if these are chains that fit into lanes: a call on one short chain makes nothing else of its
    // plan.
    Unit only{};
    Lane first_of_only;
    std::vector<Lane> gathered_chains;  // molecules that fill no block where they stand, in the order in which they are
    std::vector<MoleculeLane> gathered_molecules;            // worked on; the second ones are no linear chains
    TreeBatches tree_batches;                                // of gathered trees of different shapes
    std::int64_t longest = 0;                                // bonds of linear chains
    std::int64_t n_bonds = 0;                                // of active molecules
    std::vector<const EliminationPlan *> elimination_plans;  // of all shapes
    std::vector<std::int32_t> shapes;                        // those that occur, but for linear
    std::int64_t scratch_bytes = 0;                          // that the kernels need for all of them
    std::vector<std::int64_t> stage;     // atoms of the molecules that share fixed atoms, one after another
    std::vector<unsigned char> is_copy;  // of each atom of the stage
    std::vector<Copy> copies;            // by atom, then by place
    bool reordered = false;              // some molecules' bonds are,
    bool copied = false;                 // and so that no list of them will do

    // For calls that work on linear chains as on other molecules: what lies between two fixed atoms is a part.
    struct ChainPart {
        std::int64_t first;  // atom and bond of the chain
        std::int64_t n_bonds;
        std::int32_t shape;
    };
    std::vector<ChainPart> parts;
    std::vector<std::int64_t> part_start;  // [n_kinds+1], empty if chains are worked on as chains
    std::vector<std::vector<double>> w;    // [n_kinds], of kinds whose inverse masses are all alike
    Shapes part_shapes;

    std::int64_t bytes() const;
};

// Gathered molecules are worked on in chunks of so many, or of a multiple that has at least so many bonds: what is done
// once a chunk took a tenth of the time of single bonds in chunks of 64.
constexpr std::int64_t gathered_chunk = 64, gathered_chunk_bonds = 512;

}  // namespace holonomic
