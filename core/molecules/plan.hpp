// How a call goes through the molecules: pieces of work of a few thousand bonds, the same for any number of threads.
#ifndef HOLONOMIC_PLAN_HPP
#define HOLONOMIC_PLAN_HPP

#include <cstdint>
#include <vector>

#include "core/kernels/call.hpp"

namespace holonomic {

// Where the arrays of a molecule stand for the kernels: in the caller's memory, or apart from it (core/run/apart.hpp).
enum Where { in_place = 0, reordered = 1, staged = 2 };  // values per bond; atoms; both: 3
constexpr int n_wheres = 4;

// Made at the first use after a change. Which molecules share a unit, or a block of lanes in it, changes no result.
struct Plan {
    struct Reference {
        std::int64_t group, index;
        std::int64_t stage;  // its first atom in the stage, or -1
    };
    struct Piece {
        std::int64_t group;         // `count` molecules of this group from `first` on, or
        std::int64_t first, count;  // if group == -1: loose[first] .. loose[first+count-1]
        std::int64_t stage;         // of the first, or -1
        std::int32_t shape;         // of all its molecules
        int where;
    };
    // A fixed atom that stands in the stage more than once.
    struct Copy {
        std::int64_t atom, place;
    };
    std::vector<Piece> pieces;
    std::vector<Reference> loose;                   // molecules that fill no block of their own kind
    std::int64_t longest_in_lane = 0, longest = 0;  // bonds of linear chains
    std::int64_t n_bonds = 0;                       // of active molecules
    std::vector<std::int32_t> shapes;               // those that occur, but for linear
    std::vector<std::int64_t> stage;                // atoms of the molecules that share fixed atoms, one after another
    std::vector<unsigned char> is_copy;             // of each atom of the stage
    std::vector<Copy> copies;                       // by atom, then by place
    bool reordered = false;                         // some molecules' bonds are

    std::int64_t bytes() const;
};

// At most so many loose molecules are worked on as one piece.
constexpr std::int64_t loose_piece = 64;

}  // namespace holonomic
#endif
