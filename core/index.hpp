// Numbers of atoms, bonds and molecules: they are signed here, indices of the standard library are not, and callers
// count from a base of their own.
#pragma once

#include <cstddef>
#include <cstdint>

namespace holonomic {

inline std::size_t at(std::int64_t i) { return static_cast<std::size_t>(i); }

// As the caller counts, for messages.
inline long long number(std::int64_t i, int base) { return static_cast<long long>(i + base); }

}  // namespace holonomic
