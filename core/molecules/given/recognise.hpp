// Brings the bonds of one molecule into their order, and says what they look like.
#pragma once

#include <cstdint>
#include <vector>

#include "core/molecules/given/find.hpp"

namespace holonomic {

// One molecule as it was found.
struct Draft {
    std::vector<std::int64_t> atoms;   // numbers in the caller's arrays, ascending
    std::vector<unsigned char> fixed;  // [n_atoms]
    std::vector<std::int64_t> bonds;   // numbers in the list
    std::vector<std::int32_t> pairs;   // [n_bonds][2] places of the two atoms
};

class Recogniser {
public:
    explicit Recogniser(const BondList &list) : list_(list) {}

    Draft &draft() { return draft_; }  // to be filled
    // Throws Error if a bond is there twice or if there are more than the atoms have freedoms.
    void add_to(FoundMolecules &found);

private:
    void sort_bonds();
    void sort_few();
    void sort_many();
    bool walk_along_chain();
    Topology topology_of_cyclic() const;

    const BondList &list_;
    Draft draft_;
    std::vector<std::int32_t> degree_, neighbours_, order_;
    std::vector<std::int64_t> sorted_;
    std::vector<std::int32_t> sorted_pairs_, start_;
};

}  // namespace holonomic
