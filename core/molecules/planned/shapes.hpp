// The shapes of a set: each is there once, and its order of elimination is made when it is new.
#pragma once

#include <cstdint>
#include <unordered_map>
#include <vector>

#include "core/molecules/given/shape.hpp"
#include "core/molecules/planned/elimination_plan.hpp"

namespace holonomic {

// What a bond of a new shape takes at the most while it is added and afterwards, but for what cycles fill.
constexpr std::int64_t bytes_of_shape_bond = 400;

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
