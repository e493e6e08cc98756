/**
 * Measures methods on one problem, taking turns, with the memory pass among them; Google Benchmark does the timing.
 */
#ifndef BENCH_MEASURE_HPP
#define BENCH_MEASURE_HPP

#include <functional>
#include <string>
#include <vector>

#include "method.hpp"

namespace bench {

/// One row of results.csv, with the spread over the repetitions, which goes to spread.csv.
struct Row {
    std::string level, problem;
    std::int64_t chains, bonds;
    int threads;
    std::string method, setting;
    double error, ns_per_bond, memory_passes;
    double smallest, lower_quartile, upper_quartile, largest;
    int repetitions;
};

struct Effort {
    int repetitions = 7;
    double seconds = 0.01;      ///< least time of one repetition
    double slow_seconds = 0.1;  ///< a call that takes longer is repeated three times only
    std::size_t reference_bonds = 20000;
};

/// Called once per process, before the first measurement.
void start_measuring();

/// How wrong a result is, as far as the first part of the chains goes.
using ErrorOf = std::function<double(const State &, double part)>;

/// Runs every method once for its error, then all of them and the memory passes in turns, in random order.
std::vector<Row> measure(Level level, const Scene &p, const Methods &methods, const Effort &effort,
                         const ErrorOf &error_of);

}  // namespace bench

#endif
