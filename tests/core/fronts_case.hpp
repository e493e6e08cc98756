// What the fronts of a network are asked to solve.
#ifndef HOLONOMIC_TESTS_FRONTS_CASE_HPP
#define HOLONOMIC_TESTS_FRONTS_CASE_HPP

#include <cstdint>
#include <vector>

#include "core/plan/network.hpp"

namespace fronts_case
{

// An element of the matrix in the leaf of a node.
struct Term {
    std::int32_t row, column;
    double value;
};
struct Terms {
    std::vector<std::vector<Term>> of_node;
    std::vector<double> diagonal;
};

#define FRONTS_OF(set)                                                                                          \
    namespace set                                                                                               \
    {                                                                                                           \
    bool solve(const holonomic::NetworkPlan &, bool symmetric, const Terms &, double least_part, int n_threads, \
               std::vector<double> &x);                                                                         \
    }
FRONTS_OF(fronts2)
FRONTS_OF(fronts4)
FRONTS_OF(fronts8)
FRONTS_OF(fronts16)

}  // namespace fronts_case
#endif
