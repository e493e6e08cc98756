// SPDX-License-Identifier: GPL-2.0-only
#ifndef HOLONOMIC_LAMMPS_PLAN_COMPONENTS_HPP
#define HOLONOMIC_LAMMPS_PLAN_COMPONENTS_HPP

#include <mpi.h>

#include <cstdint>
#include <unordered_map>
#include <vector>

namespace holonomic_lammps {

using Tag = std::int64_t;

/** The rank that keeps the books for an atom or for the molecule named after it. */
inline int bookkeeper(Tag tag, int n_ranks) { return static_cast<int>(tag % n_ranks); }

/** An atom, as its bookkeeper knows it. */
struct Node {
    Tag tag;
    Tag component;               /**< the lowest tag of all that hang together */
    std::vector<Tag> neighbours; /**< atoms that it is bonded to */
    std::vector<double> lengths; /**< of these bonds */
};

/**
 * Finds which nodes hang together, over all ranks, and fills in their component. nodes: those whose books are kept
 * here, each neighbour being a node of some rank. Collective. The number of rounds grows as the logarithm of the
 * longest path: labels jump to their label's label (FastSV: Zhang, Azad and Hu 2020, arXiv:1910.05971).
 */
void find_components(MPI_Comm world, std::vector<Node> &nodes);

}  // namespace holonomic_lammps

#endif
