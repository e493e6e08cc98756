// SPDX-License-Identifier: GPL-2.0-only
#ifndef HOLONOMIC_LAMMPS_PLAN_COMPONENTS_HPP
#define HOLONOMIC_LAMMPS_PLAN_COMPONENTS_HPP

#include <mpi.h>

#include <cstdint>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "route.hpp"

namespace holonomic_lammps {

using Tag = std::int64_t;

/** The rank that keeps the books for an atom or for the molecule named after it. */
inline int bookkeeper(Tag tag, int n_ranks) { return static_cast<int>(tag % n_ranks); }

/** What bookkeepers answer to some questions, in the order of the questions; `about` names a question's tag;
 * collective. */
template <class Answer, class Question, class About, class Function>
std::vector<Answer> ask_bookkeepers(MPI_Comm world, const std::vector<Question> &questions, About about,
                                    Function answer) {
    const int n_ranks = size_of(world);
    Outgoing<Question> outgoing(n_ranks);
    for (const Question &question : questions) outgoing[bookkeeper(about(question), n_ranks)].push_back(question);
    const Outgoing<Answer> answers = ask<Answer>(world, outgoing, answer);
    std::vector<std::size_t> read(n_ranks, 0);
    std::vector<Answer> result;
    result.reserve(questions.size());
    for (const Question &question : questions) {
        const int p = bookkeeper(about(question), n_ranks);
        result.push_back(answers[p][read[p]++]);
    }
    return result;
}

/** What all ranks name, on each of them; collective. */
inline std::unordered_set<Tag> everywhere(MPI_Comm world, const std::vector<Tag> &tags) {
    const std::vector<Tag> all = route(world, Outgoing<Tag>(size_of(world), tags)).items;
    return {all.begin(), all.end()};
}

/** Of a question that is a tag. */
inline Tag itself(Tag tag) { return tag; }

/** A rigid body that an atom belongs to, and where it is in any frame of the body's own. */
struct InBody {
    Tag body;
    double at[3];
};

/** An atom, as its bookkeeper knows it. */
struct Node {
    Tag tag;
    Tag component;               /**< the lowest tag of all that hang together */
    std::vector<Tag> neighbours; /**< atoms that it is bonded to */
    std::vector<double> lengths; /**< of these bonds */
    std::vector<InBody> bodies;  /**< several where they share the atom */
};

/**
 * Finds which nodes hang together, over all ranks, and fills in their component. nodes: those whose books are kept
 * here, each neighbour being a node of some rank. Collective. The number of rounds grows as the logarithm of the
 * longest path: labels jump to their label's label (FastSV: Zhang, Azad and Hu 2020, arXiv:1910.05971).
 */
void find_components(MPI_Comm world, std::vector<Node> &nodes);

}  // namespace holonomic_lammps

#endif
