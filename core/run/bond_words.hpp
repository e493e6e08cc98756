// Bonds and their lengths in words, for messages.
#pragma once

#include <cstdint>

#include "core/molecules/chains.hpp"

namespace holonomic {

struct Words {
    char text[384];
};

// "bond 3 (53 of the arrays per bond, atoms 12 and 13)", as the caller counts.
Words name_of_bond(const Chains &chains, const Molecule &molecule, std::int64_t bond);

// Length of the minimum image.
double length_of_bond(const Molecule &molecule, std::int64_t bond, const AtomArray &r, const Box &box);

// What has most likely gone wrong where positions to be projected are far from any that have the lengths.
constexpr const char *too_long_a_step = "forces or time step too large";

// "a box is set", or that none is.
const char *box_in_words(const Box &box);

}  // namespace holonomic
