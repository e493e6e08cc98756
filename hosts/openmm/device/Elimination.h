// The order in which the bonds of a Kind are eliminated from the matrix of the multipliers.
#ifndef OPENMM_HOLONOMIC_ELIMINATION_H_
#define OPENMM_HOLONOMIC_ELIMINATION_H_

#include <cstddef>
#include <vector>

#include "Kinds.h"

namespace OpenMM {

// Both put the bonds into their order and note the entries. They give the place of each bond in that order, or nothing,
// with the Kind as it was, where it would be too many entries.

// The order of least fill, which is none where there is no cycle.
std::vector<int> eliminateOneByOne(Kind &kind, std::size_t maxEntries);

// By levels of bonds that have no entries with each other, so that threads eliminate a level at once. Of a chain each
// takes every second bond, at the cost of an entry: 1000 bonds are ten levels.
std::vector<int> eliminateByLevels(Kind &kind);
// Products per bond that its elimination takes at most: trees have some ten, lattices as many as they are large.
constexpr std::size_t mostTermsOfBond = 200;

}  // namespace OpenMM

#endif
