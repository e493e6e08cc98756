// The order in which the bonds of a KernelKind are eliminated from the matrix of the multipliers.
#pragma once

#include <cstdint>
#include <vector>

#include "core/device/kinds.hpp"

namespace holonomic::device {

// Both put the bonds into their order and note the entries. They give the place of each bond in that order, or nothing,
// with the KernelKind as it was, where it would be too many entries.

// The order of least fill, which is none where there is no cycle.
std::vector<int> eliminate_one_by_one(KernelKind &kind, std::int64_t max_entries);

// By levels of bonds that have no entries with each other, so that work-items eliminate a level at once. Of a chain
// each takes every second bond, at the cost of an entry: 1000 bonds are ten levels.
std::vector<int> eliminate_by_levels(KernelKind &kind);
// Products per bond that its elimination takes at most: trees have some ten, lattices as many as they are large.
constexpr std::int64_t most_products_of_bond = 200;

}  // namespace holonomic::device
