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

    /// A scene of molecules of any topology rather than of chains.
    bool is_molecule() const;
    bool is_special() const {  ///< condition numbers, energy drift: not a level at work on a scene of its own
        return setting.rfind("condition", 0) == 0 || setting.rfind("energy drift", 0) == 0;
    }
};

/// What identifies a row, apart from its numbers.
struct Key {
    std::string level, problem;
    std::int64_t chains = 0, bonds = 0;
    std::string method = "holonomic", setting = "default";
    int threads = 1;
};

/// All rows of a run.
class Table {
public:
    /// Reads results.csv and spread.csv of a folder; rows that stand in both at the same place belong together.
    explicit Table(const std::string &directory);
    const std::vector<Measurement> &rows() const { return rows_; }
    /// NULL if there is no such row. Where several fit, the first.
    const Measurement *find(const Key &key) const;
    /// Time per bond; NaN if there is no such row.
    double ns(const Key &key) const;

private:
    std::vector<Measurement> rows_;
};

}  // namespace bench

#endif
