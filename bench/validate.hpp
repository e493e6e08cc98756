/** Expectations of bench_validate. */
#ifndef BENCH_VALIDATE_HPP
#define BENCH_VALIDATE_HPP

#include <string>

namespace bench {

/// Prints whether the value is in its window, and counts those that are not.
void expect(const std::string &what, double value, double low, double high);

void validate_molecules();

}  // namespace bench

#endif
