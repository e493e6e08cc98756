// What the bonds of molecules look like: topologies that are no linear chains, each with its order of elimination.
#pragma once

#include <cstdint>
#include <memory>
#include <unordered_map>
#include <vector>

#include "core/molecules/planned/elimination_plan.hpp"

namespace holonomic {

// The values are those of hol_shape, which capi/molecules.cpp asserts.
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

class Shapes {
public:
    // The shape with these bonds and fixed atoms; a new one if there is none yet. Looks at `likely` first. Throws
    // std::bad_alloc, or TooMuchMemory where a new one would take more than most_bytes; then nothing is changed.
    std::int32_t find(Topology topology, std::int32_t n_atoms, std::int32_t n_bonds, const std::int32_t *pairs,
                      const unsigned char *fixed, std::int32_t likely, std::int64_t most_bytes = no_limit,
                      EliminationWork *work = nullptr);

    const Shape &operator[](std::int32_t shape) const { return shapes_[static_cast<std::size_t>(shape)]; }
    std::int32_t size() const { return static_cast<std::int32_t>(shapes_.size()); }
    void shrink() { shapes_.shrink_to_fit(); }
    std::size_t bytes() const;

private:
    std::vector<Shape> shapes_;
    std::unordered_multimap<std::uint64_t, std::int32_t> by_hash_;
};

}  // namespace holonomic
