/** Expectations of bench_validate. */
#ifndef BENCH_VALIDATE_HPP
#define BENCH_VALIDATE_HPP

#include <string>
#include <vector>

#include "molecules/molecules.hpp"

namespace bench {

/// Prints whether the value is in its window, and counts those that are not.
void expect(const std::string &what, double value, double low, double high);

/// Molecules of all the kinds that are measured, few of each.
std::vector<Molecules> validated_scenes();

void validate_molecules();
void validate_checks();

}  // namespace bench

#endif
