// Finds by counting that the bonds of a molecule can't be independent of each other.
#pragma once

#include "core/molecules/given/recognise.hpp"

namespace holonomic {

// Throws Error if some atoms have more bonds among them than 3 n - 6, or with fixed atoms than n movable ones have
// freedoms: in each part that is left when atoms with at most three bonds are taken away until there are none (a part
// that is overfull stays so), and among any five atoms with all their ten distances. A part whose cycles may go round
// the periodic box can't turn in it: it has 3 n - 3.
void check_count(const BondList &list, const Draft &draft);

}  // namespace holonomic
