// How much memory a set of molecules may take: what would take more is refused before it is begun.
#pragma once

#include <cstdint>

#include "core/error.hpp"

namespace holonomic {

class Chains;

// What adding a bond takes at the most while it is done and afterwards, but for its shape (planned/shapes.hpp).
constexpr std::int64_t bytes_of_chain_bond = 40, bytes_of_listed_bond = 120;
// The same of an atom of a body; what a kind of body takes is counted once it is there.
constexpr std::int64_t bytes_of_body_atom = 100;

// A quarter of the machine's memory; where that is not known, no limit.
std::int64_t default_memory_limit();

// Memory that may still be taken.
std::int64_t memory_left(const Chains &chains);

// Throws Error if n bonds of so many bytes are more than that.
void check_memory(const Chains &chains, std::int64_t n_bonds, std::int64_t bytes_per_bond);

// The error of `what`, which would take at least so many bytes more.
Error too_much_memory(const Chains &chains, const char *what, std::int64_t bytes);

}  // namespace holonomic
