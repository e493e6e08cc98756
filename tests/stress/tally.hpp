/**
 * @file tally.hpp
 * Counts over all chains of a run with one set of kernels, and the tables at its end.
 */
#ifndef STRESS_TALLY_HPP
#define STRESS_TALLY_HPP

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "hostile_chain.hpp"
#include "quantities.hpp"

namespace stress
{

struct tally {
    struct of_quantity {
        std::int64_t checked = 0, exceeded = 0;
        long double worst = -1;
        std::uint64_t seed = 0;  ///< of the chain with the largest error
    };
    std::array<of_quantity, N_QUANTITIES> quantity{};
    std::array<std::int64_t, n_features> with_feature{}, exceeded_with_feature{};
    std::int64_t chains = 0, bonds = 0, singular = 0, exceeded = 0;
    long double largest_condition = 0;

    void add(const hostile_chain &c, const verdict &v);
    void add(const tally &other);
    long double worst() const;  ///< largest error over its bound of everything that is promised
};

/** A column for each set; and the same as Markdown to the end of the file that STRESS_MARKDOWN (environment) names. */
void print(const std::vector<std::string> &sets, const std::vector<tally> &of_set);

}  // namespace stress

#endif
