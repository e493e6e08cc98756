// What a work-group needs to know of a kind of molecules: where each number of its elimination comes from.
#pragma once

#include <vector>

#include "core/device/kinds.hpp"

namespace holonomic::device {

// The parts of a table, by the names that they have in the kernels. It begins with the place of each of them in it.
// Bonds and entries are numbered in the order of the elimination; an atom with a sign is its number + 1, negative where
// it is the second of its bond, or ends one bond of an entry and begins the other.
constexpr const char *parts_of_table[] = {
    "SIZES",            // atoms, bonds, levels
    "ENDS",             // the two atoms of each bond
    "LEVELS",           // where each level of bonds begins, and the end
    "ROWS",             // where the entries of each bond with later ones begin, and the end
    "ENTRIES",          // the two bonds of each entry
    "SHARED",           // the atom that these share, with a sign; 0: none, the elimination fills it
    "EARLIER",          // where the earlier entries of each bond begin in EARLIER_ENTRIES, and the end
    "EARLIER_ENTRIES",  // an entry with an earlier bond, and that bond
    "TERMS",            // where what is taken off each entry begins in TERM_ENTRIES, and the end
    "TERM_ENTRIES",     // entries of its first and of its second bond with an earlier one, and that bond
    "ATOMS",            // where the bonds of each atom begin in BONDS_OF_ATOMS, and the end
    "BONDS_OF_ATOMS",   // a bond + 1, negative where the atom is its second
};

std::vector<int> group_table(const KernelKind &kind);

}  // namespace holonomic::device
