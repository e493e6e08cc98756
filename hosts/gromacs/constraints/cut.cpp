#include "cut.hpp"

#include <algorithm>

#include "gromacs/topology/topology.h"

namespace holonomic {

Topology::Topology(const gmx_mtop_t &topology, gmx::ArrayRef<const gmx::ListOfLists<int>> constraints) {
    for (const gmx::ListOfLists<int> &type : constraints) {
        counts.emplace_back();
        for (size_t atom = 0; atom < static_cast<size_t>(type.ssize()); atom++)
            counts.back().push_back(static_cast<int>(type[atom].size()));
    }
    int first = 0;
    for (const gmx_molblock_t &block : topology.molblock) {
        const int n_atoms = topology.moltype[block.type].atoms.nr;
        blocks.push_back({first, n_atoms, static_cast<size_t>(block.type)});
        first += block.nmol * n_atoms;
    }
}

int Topology::constraints_of(int atom) const {
    const auto after = std::upper_bound(blocks.begin(), blocks.end(), atom,
                                        [](int number, const Block &block) { return number < block.first; });
    const Block &block = *(after - 1);
    return counts[block.type][(atom - block.first) % block.n_atoms];
}

}  // namespace holonomic
