// SPDX-License-Identifier: GPL-2.0-only
#ifndef HOLONOMIC_LAMMPS_PLAN_ROUTE_HPP
#define HOLONOMIC_LAMMPS_PLAN_ROUTE_HPP

#include <mpi.h>

#include <stdexcept>
#include <type_traits>
#include <utility>
#include <vector>

namespace holonomic_lammps {

/** What the ranks have sent here: those of rank p are items[first[p]] .. items[first[p + 1] - 1], in p's order. */
template <class T>
struct Delivery {
    std::vector<T> items;
    std::vector<int> first;
};

/** For each rank, what is to be sent to it. */
template <class T>
using Outgoing = std::vector<std::vector<T>>;

/** Sends outgoing[p] to rank p; collective. */
template <class T>
Delivery<T> route(MPI_Comm world, const Outgoing<T> &outgoing) {
    static_assert(std::is_trivially_copyable<T>::value, "items travel as bytes");
    const int n_ranks = static_cast<int>(outgoing.size());
    std::vector<int> to(n_ranks), from(n_ranks), to_first(n_ranks + 1, 0);
    Delivery<T> delivery;
    delivery.first.assign(n_ranks + 1, 0);
    for (int p = 0; p < n_ranks; ++p) {
        to[p] = static_cast<int>(outgoing[p].size());
        to_first[p + 1] = to_first[p] + to[p];
    }
    MPI_Alltoall(to.data(), 1, MPI_INT, from.data(), 1, MPI_INT, world);
    for (int p = 0; p < n_ranks; ++p) delivery.first[p + 1] = delivery.first[p] + from[p];
    std::vector<T> flat;
    flat.reserve(to_first[n_ranks]);
    for (const std::vector<T> &items : outgoing) flat.insert(flat.end(), items.begin(), items.end());
    delivery.items.resize(delivery.first[n_ranks]);
    MPI_Datatype type;
    MPI_Type_contiguous(static_cast<int>(sizeof(T)), MPI_BYTE, &type);
    MPI_Type_commit(&type);
    MPI_Alltoallv(flat.data(), to.data(), to_first.data(), type, delivery.items.data(), from.data(),
                  delivery.first.data(), type, world);
    MPI_Type_free(&type);
    return delivery;
}

/** Puts a question to other ranks and gives their answers, answers[p][k] to questions[p][k]; collective. */
template <class Answer, class Question, class Function>
Outgoing<Answer> ask(MPI_Comm world, const Outgoing<Question> &questions, Function answer) {
    const Delivery<Question> asked = route(world, questions);
    const int n_ranks = static_cast<int>(questions.size());
    Outgoing<Answer> replies(n_ranks);
    for (int p = 0; p < n_ranks; ++p)
        for (int k = asked.first[p]; k < asked.first[p + 1]; ++k) replies[p].push_back(answer(asked.items[k]));
    const Delivery<Answer> came = route(world, replies);
    for (int p = 0; p < n_ranks; ++p)
        replies[p].assign(came.items.begin() + came.first[p], came.items.begin() + came.first[p + 1]);
    return replies;
}

inline int rank_of(MPI_Comm world) {
    int rank;
    MPI_Comm_rank(world, &rank);
    return rank;
}

inline int size_of(MPI_Comm world) {
    int size;
    MPI_Comm_size(world, &size);
    return size;
}

}  // namespace holonomic_lammps

#endif
