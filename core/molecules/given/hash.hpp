// Mixing of numbers into a hash.
#pragma once

#include <cstdint>
#include <cstring>

namespace holonomic {

inline std::uint64_t mix(std::uint64_t hash, std::uint64_t bits) {
    hash = (hash ^ bits) * 0x9e3779b97f4a7c15u;
    return hash ^ (hash >> 29);
}

inline std::uint64_t mix(std::uint64_t hash, double value) {
    std::uint64_t bits;
    std::memcpy(&bits, &value, sizeof bits);
    return mix(hash, bits);
}

}  // namespace holonomic
