// What the bonds of a molecule look like: a topology that is no linear chain, with its order of elimination.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/plan/elimination.hpp"

namespace holonomic {

// The values are those of hol_shape, which capi/queries.cpp asserts.
enum class Topology { chain = 0, tree = 1, ring = 2, triangle = 3, other = 4 };

struct Shape {
    Topology topology;
    std::int32_t n_atoms, n_bonds;
    bool has_triangles;                                  // three atoms that are bonded to each other, or more
    std::vector<std::int32_t> round_cycles;              // with cycles, the steps of walk(): k, or ~k if it goes back
    std::shared_ptr<const EliminationPlan> elimination;  // copies of the set share it
    // Of a bond, local atoms, the lower one first.
    std::int32_t i(std::int64_t bond) const { return elimination->atom_i[bond]; }
    std::int32_t j(std::int64_t bond) const { return elimination->atom_j[bond]; }
    // Calls each(bond, back) for bonds to every atom but start(), each from one that is reached; back: it goes along
    // from its higher atom.
    std::int32_t start() const { return elimination->n_core > 0 ? 0 : elimination->atom_of[elimination->n_tree]; }
    template <class Each>
    void walk(const Each &each) const {
        for (std::int32_t index = elimination->n_core > 0 ? 0 : elimination->n_tree; index-- > 0;)
            each(elimination->bond_of[index], i(elimination->bond_of[index]) == elimination->atom_of[index]);
        for (const std::int32_t step : round_cycles) each(step < 0 ? ~step : step, step < 0);
    }
};

}  // namespace holonomic
