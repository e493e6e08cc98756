// Molecules that borders of domains cut. GROMACS gives each rank the constraints of its own atoms and those that are up
// to lincs-order + 1 bonds away, with positions of all their atoms, before it calls. Where that is all of a molecule,
// each rank that has an atom of it solves the same equations, and keeps what is its own: no more is sent than for
// LINCS.
#pragma once
#include <string>
#include <vector>

#include "arrangement.hpp"
#include "gromacs.hpp"

namespace holonomic {

// How many constraints each atom of the topology has.
class Topology {
public:
    Topology() = default;
    Topology(const gmx_mtop_t &, gmx::ArrayRef<const gmx::ListOfLists<int>> constraints);
    bool empty() const { return blocks.empty(); }
    int constraints_of(int atom) const;  // counted from 0

private:
    struct Block {
        int first, n_atoms;  // of one molecule
        size_t type;
    };
    std::vector<Block> blocks;
    std::vector<std::vector<int>> counts;  // by type of molecule
};

// Leaves the bonds of molecules of which the rank has an atom, the first `n_home`. Returns an atom whose bonds are not
// all there, or -1. number(atom): in the topology, from 0.
template <typename Number>
int leave_own(std::vector<Bond> &list, int n_atoms, int n_home, const Topology &topology, const Number &number) {
    std::vector<int> root(n_atoms), n_bonds(n_atoms, 0);
    for (int i = 0; i < n_atoms; i++) root[i] = i;
    const auto find = [&](int i) {
        while (root[i] != i) i = root[i] = root[root[i]];
        return i;
    };
    // The lowest atom is the root, so a molecule has an atom of the rank if its root is one.
    for (const Bond &bond : list) {
        const int a = find(bond.first), b = find(bond.second);
        root[a < b ? b : a] = a < b ? a : b;
        ++n_bonds[bond.first];
        ++n_bonds[bond.second];
    }
    std::vector<Bond> own;
    int missing = -1;
    for (const Bond &bond : list) {
        if (find(bond.first) >= n_home) continue;
        own.push_back(bond);
        for (int atom : {bond.first, bond.second})
            if (n_bonds[atom] != topology.constraints_of(number(atom))) missing = atom;
    }
    list.swap(own);
    return missing;
}

}  // namespace holonomic
