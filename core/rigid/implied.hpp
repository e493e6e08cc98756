// Distances that others imply wherever the atoms are: the tenth of five atoms with all of theirs, and so on in graphs
// of them, as all bonds and angles of an alkane are. Where such groups share atoms they are no bodies: a distance that
// is implied is left out of the equations.
#pragma once

#include <cstdint>
#include <vector>

#include "core/rigid/cliques.hpp"

namespace holonomic::rigid {

// Of each bond of the list, whether the shorter ones of its molecule imply it: the rank at random coordinates, exact,
// modulo a prime of 61 bits. Looked at are molecules with bodies and those with more bonds than freedoms. Nothing is
// left out where bodies that share no atoms hold all that depends.
std::vector<unsigned char> implied_bonds(const Masses &masses, const BondList &list, const double *lengths,
                                         std::int64_t n_lengths, const Cliques &cliques);

// The same in molecules with linear groups, of those that are in the equations so far. Throws Error where one is
// implied by more than the lengths of its group, which have been compared.
std::vector<std::int64_t> implied_beside(const LinearParts &linear, const Masses &masses, const BondList &list,
                                         const double *lengths, std::int64_t n_lengths, const Cliques &cliques);

}  // namespace holonomic::rigid
