// SPDX-License-Identifier: GPL-2.0-only
#ifndef HOLONOMIC_LAMMPS_PLAN_COMPONENTS_HPP
#define HOLONOMIC_LAMMPS_PLAN_COMPONENTS_HPP

#include <mpi.h>

#include <cstdint>
#include <unordered_map>
#include <vector>

#include "route.hpp"

namespace holonomic_lammps {

using Tag = std::int64_t;

/** The rank that keeps the books for an atom or for the molecule named after it. */
inline int bookkeeper(Tag tag, int n_ranks) { return static_cast<int>(tag % n_ranks); }

/** What the bookkeepers of some tags answer, in the order of the tags; collective. */
template <class Answer, class Function>
std::vector<Answer> ask_bookkeepers(MPI_Comm world, const std::vector<Tag> &tags, Function answer) {
    const int n_ranks = size_of(world);
    Outgoing<Tag> questions(n_ranks);
    for (Tag tag : tags) questions[bookkeeper(tag, n_ranks)].push_back(tag);
    const Outgoing<Answer> answers = ask<Answer>(world, questions, answer);
    std::vector<std::size_t> read(n_ranks, 0);
    std::vector<Answer> result;
    result.reserve(tags.size());
    for (Tag tag : tags) {
        const int p = bookkeeper(tag, n_ranks);
        result.push_back(answers[p][read[p]++]);
    }
    return result;
}

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
