// Places of the constrained atoms in arrays of our own: molecule behind molecule, equal ones together, the atoms of a
// chain in order along it. There the library takes its shortest paths, whatever the order in the topology or in a
// domain.
#pragma once
#include <cstdint>
#include <vector>

namespace holonomic {

struct Bond {
    int first, second;  // atoms
    double a, b;        // lengths of states A and B
    bool operator==(const Bond &other) const {
        return first == other.first && second == other.second && a == other.a && b == other.b;
    }
};

// Equal molecules: the same bonds between atoms of the same places in them, the same masses and lengths.
struct Kind {
    int64_t count, n_atoms, n_bonds;
    int64_t first_atom, first_bond;  // places
    bool operator==(const Kind &other) const {
        return count == other.count && n_atoms == other.n_atoms && n_bonds == other.n_bonds &&
               first_atom == other.first_atom && first_bond == other.first_bond;
    }
};

struct Arrangement {
    std::vector<int> atoms;    // the atom at each place
    std::vector<int> parents;  // place of one bonded to it, before it in its molecule; of a molecule's first: its own
    std::vector<int> starts;   // place of each molecule's first atom, and the end
    std::vector<int> order;    // the bond of the list at each place
    std::vector<Bond> bonds;   // between places
    std::vector<Kind> kinds;
};

// `masses` [n_atoms], 0 of atoms that are held fixed.
Arrangement arrange(const std::vector<Bond> &list, const std::vector<double> &masses);

}  // namespace holonomic
