/**
 * @file molecule_tally.hpp
 * Counts over all molecules of a run by class with one set of kernels, and the tables at its end.
 */
#ifndef STRESS_MOLECULE_TALLY_HPP
#define STRESS_MOLECULE_TALLY_HPP

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "molecule_checks.hpp"

namespace stress
{

struct molecule_tally {
    struct of_quantity {
        std::int64_t checked = 0, exceeded = 0;
        long double worst = -1;
        std::uint64_t seed = 0;  ///< of the molecule with the largest error
    };
    struct of_class {
        std::array<of_quantity, M_QUANTITIES> quantity{};
        std::int64_t molecules = 0, bonds = 0, singular = 0, not_promised = 0, exceeded = 0;
        long double largest_condition = 0;
    };
    static constexpr std::size_t most_classes = 6;
    std::array<of_class, most_classes> classes{};

    /** Whether the molecule exceeds a bound that is promised. */
    bool add(std::size_t its_class, std::int64_t n_bonds, std::uint64_t seed, const molecule_facts &facts,
             const molecule_verdict &v);
    void add(const molecule_tally &other);
    /** Whether no error is above `excess` times its bound and at most `share` of each class exceed one at all. */
    bool within(long double excess, double share) const;
};

/** A table for each class, with a column for each set; and the largest of each class as Markdown, as for chains. */
void print(const char *(*class_name)(int), std::size_t n_classes, const std::vector<std::string> &sets,
           const std::vector<molecule_tally> &of_set);

}  // namespace stress

#endif
