// Makes the order of elimination of a molecule that is not a chain, once per shape.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include "core/molecules/planned/elimination_order.hpp"
#include "core/plan/elimination.hpp"

namespace holonomic {

struct EliminationWork;  // memory that many may be made in (plan_memory.hpp)

// The molecule's bonds are pairs[n_bonds][2] of local atoms 0 .. n_atoms - 1; no pair twice, all atoms connected, fixed
// atoms with one bond each. At least one bond. Takes O(n log n), and what the fill of the core costs.
// Throws std::bad_alloc, std::length_error where the core fills up to 2^31 entries, and TooMuchMemory where what it
// fills takes more than most_bytes, before that has been taken.
std::unique_ptr<const EliminationPlan> make_elimination_plan(std::int32_t n_atoms, std::int32_t n_bonds,
                                                             const std::int32_t *pairs, const unsigned char *fixed,
                                                             std::int64_t most_bytes = no_limit,
                                                             EliminationWork *work = nullptr);

// Of a junction of paths: with indices of its bonds, and without what large molecules need.
std::unique_ptr<const EliminationPlan> make_junction_plan(std::int32_t n_atoms, std::int32_t n_bonds,
                                                          const std::int32_t *pairs, const unsigned char *fixed);

// Of the same molecule, for the extended-precision solver alone: also where it is a network, if it fills no more than
// most_bytes.
std::unique_ptr<const EliminationPlan> make_extended_plan(const EliminationPlan &s, std::int64_t most_bytes = no_limit);

// Makes the order of a network that the extended-precision solver needs, once, for metrics. Throws TooMuchMemory.
// Thread-safe.
const EliminationPlan &make_extended(const EliminationPlan &s, std::int64_t most_bytes);

// Makes the list of a large tree that keeps factors by one (list_of_kept()), once. Thread-safe.
void make_list_of_kept(const EliminationPlan &s);

// Memory that it occupies, in bytes.
std::size_t bytes_of(const EliminationPlan &s);

}  // namespace holonomic
