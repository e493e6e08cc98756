/** results.csv and spread.csv read back, for the report. */
#ifndef BENCH_TABLE_HPP
#define BENCH_TABLE_HPP

#include <cstdint>
#include <string>
#include <vector>

namespace bench {

struct Measurement {
    std::string level, problem, method, setting;
    std::int64_t chains = 0, bonds = 0;
    int threads = 0, repetitions = 0;
    double error = 0, ns = 0, passes = 0, lower = 0, upper = 0;

    /// Without a number that is not wanted in it: the same problem, size and threads.
    bool same_scene(const Measurement &other) const {
        return level == other.level && problem == other.problem && chains == other.chains && bonds == other.bonds &&
               threads == other.threads;
    }
    bool is_special() const {  ///< condition numbers, energy drift: for the plots, not for the tables
        return setting.rfind("condition", 0) == 0 || setting.rfind("energy drift", 0) == 0;
    }
};

/// Reads both files of a folder; rows that stand in both at the same place belong together.
std::vector<Measurement> read_results(const std::string &directory);

}  // namespace bench

#endif
