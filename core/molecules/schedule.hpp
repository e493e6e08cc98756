// Makes the order of elimination of a molecule that is not a chain, once per shape.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include "core/kernels/molecules/schedule.hpp"
#include "core/molecules/elimination_order.hpp"

namespace holonomic {

struct ScheduleWork;  // memory that many may be made in (schedule_memory.hpp)

// The molecule's bonds are pairs[n_bonds][2] of local atoms 0 .. n_atoms - 1; no pair twice, all atoms connected, fixed
// atoms with one bond each. At least one bond. Takes O(n log n), and what the fill of the core costs.
// Throws std::bad_alloc, std::length_error where the core fills up to 2^31 entries, and TooMuchMemory where what it
// fills takes more than most_bytes, before that has been taken.
std::unique_ptr<const Schedule> make_schedule(std::int32_t n_atoms, std::int32_t n_bonds, const std::int32_t *pairs,
                                              const unsigned char *fixed, std::int64_t most_bytes = no_limit,
                                              ScheduleWork *work = nullptr);

// Of a knot of paths: with places of its bonds, and without what large molecules need.
std::unique_ptr<const Schedule> make_knot_schedule(std::int32_t n_atoms, std::int32_t n_bonds,
                                                   const std::int32_t *pairs, const unsigned char *fixed);

// Of the same molecule, for the careful solver alone: also where it is a network, if it fills no more than most_bytes.
std::unique_ptr<const Schedule> make_careful_schedule(const Schedule &s, std::int64_t most_bytes = no_limit);

// Makes the order of a network that the careful solver needs, once, for metrics. Throws TooMuchMemory. Thread-safe.
const Schedule &make_careful(const Schedule &s, std::int64_t most_bytes);

// Memory that it occupies, in bytes.
std::size_t bytes_of(const Schedule &s);

}  // namespace holonomic
