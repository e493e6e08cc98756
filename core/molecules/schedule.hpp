// Makes the order of elimination of a molecule that is not a chain, once per shape.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include "core/kernels/molecules/schedule.hpp"
#include "core/molecules/elimination_order.hpp"

namespace holonomic {

// The molecule's bonds are pairs[n_bonds][2] of local atoms 0 .. n_atoms - 1; no pair twice, all atoms connected, fixed
// atoms with one bond each. At least one bond. Takes O(n log n), and what the fill of the core costs.
// Throws std::bad_alloc, std::length_error where the core fills up to 2^31 entries, and TooMuchMemory where what it
// fills takes more than most_bytes, before that has been taken.
std::unique_ptr<const Schedule> make_schedule(std::int32_t n_atoms, std::int32_t n_bonds, const std::int32_t *pairs,
                                              const bool *fixed, std::int64_t most_bytes = no_limit);

// The same without what large molecules and careful solvers need.
std::unique_ptr<const Schedule> make_bare_schedule(std::int32_t n_atoms, std::int32_t n_bonds,
                                                   const std::int32_t *pairs, const bool *fixed);

// Makes what the careful solver needs of a network, once, for metrics. Throws TooMuchMemory. Thread-safe.
void make_careful(const Schedule &s, std::int64_t most_bytes);

// Memory that it occupies, in bytes.
std::size_t bytes_of(const Schedule &s);

}  // namespace holonomic
