// What the bonds of molecules look like: topologies that are no linear chains, each with its order of elimination.
#pragma once

#include <cstdint>
#include <memory>
#include <unordered_map>
#include <vector>

#include "core/molecules/schedule.hpp"

namespace holonomic {

// The values are those of hol_shape, which capi/molecules.cpp asserts.
enum class Form { chain = 0, tree = 1, ring = 2, triangle = 3, other = 4 };

struct Shape {
    Form form;
    std::int32_t n_atoms, n_bonds;
    std::vector<std::int32_t> walk;  // bonds to every atom but the first, each from one that is reached: k, or ~k if it
                                     // is gone along from its higher atom
    std::unique_ptr<const Schedule> schedule;
    // Of a bond, local atoms, the lower one first.
    std::int32_t i(std::int64_t bond) const { return schedule->atom_i[bond]; }
    std::int32_t j(std::int64_t bond) const { return schedule->atom_j[bond]; }
};

class Shapes {
public:
    // The shape with these bonds and fixed atoms; a new one if there is none yet. Looks at `likely` first. Throws
    // std::bad_alloc, or TooMuchMemory where a new one would take more than most_bytes; then nothing is changed.
    std::int32_t find(Form form, std::int32_t n_atoms, std::int32_t n_bonds, const std::int32_t *pairs,
                      const unsigned char *fixed, std::int32_t likely, std::int64_t most_bytes = no_limit);

    const Shape &operator[](std::int32_t shape) const { return shapes_[static_cast<std::size_t>(shape)]; }
    std::int32_t size() const { return static_cast<std::int32_t>(shapes_.size()); }
    std::size_t bytes() const;

private:
    std::vector<Shape> shapes_;
    std::unordered_multimap<std::uint64_t, std::int32_t> by_hash_;
};

}  // namespace holonomic
