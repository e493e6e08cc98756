/** The yardstick: how long it takes to read three arrays and to write one. */
#ifndef BENCH_MEMORY_PASS_HPP
#define BENCH_MEMORY_PASS_HPP

#include <cstddef>
#include <vector>

namespace bench {

/// g = r + v f, element by element, over the arrays on which the methods work.
void memory_pass(const std::vector<double> &r, const std::vector<double> &v, const std::vector<double> &f,
                 std::vector<double> &g, int threads);

/// Time of a pass over so many numbers per array, one thread.
double memory_pass_seconds(std::size_t numbers);

}  // namespace bench

#endif
