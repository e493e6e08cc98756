// Which units are ordinary: those in which no product of a kernel overflows or underflows, unless the numbers of one
// molecule differ by very much.
#pragma once

#include <cmath>

namespace holonomic {

// Powers of two.
struct Powers {
    int length, mass;
};

// Metres and kilograms are (2^-33, 2^-86).
constexpr int most_ordinary_length = 48, most_ordinary_mass = 92;

// Of the longest bond and the largest inverse mass, both positive and finite. Even, as there are roots of masses.
inline Powers powers_of(double longest, double most_w) {
    return {std::ilogb(longest) / 2 * 2, most_w > 0 ? -std::ilogb(most_w) / 2 * 2 : 0};
}

inline bool are_ordinary(const Powers &units) {
    return std::abs(units.length) <= most_ordinary_length && std::abs(units.mass) <= most_ordinary_mass;
}

}  // namespace holonomic
