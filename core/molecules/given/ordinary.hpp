// Whether the units of a molecule are ordinary ones.
#pragma once

#include <cmath>

#include "core/kernels/call.hpp"

namespace holonomic {

// Powers of two. Multipliers, and what they are linear in, are over one more: forces and squares of velocities, or the
// velocities that are projected, or right-hand sides.
struct Powers {
    int length, mass, multiplier = 0;
};

// Of the longest bond and the largest inverse mass, both positive and finite. Even, as there are roots of masses.
inline Powers powers_of(double longest, double most_w) {
    return {std::ilogb(longest) / 2 * 2, most_w > 0 ? -std::ilogb(most_w) / 2 * 2 : 0};
}

inline bool are_ordinary(const Powers &units) {
    return std::abs(units.length) <= most_ordinary_length && std::abs(units.mass) <= most_ordinary_mass &&
           std::abs(2 * units.length - units.mass) <= most_ordinary_mass;  // of pivots
}

}  // namespace holonomic
