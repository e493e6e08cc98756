/** The files that a run leaves: results.csv with exactly the agreed columns, and spread.csv beside it. */
#ifndef BENCH_RESULTS_HPP
#define BENCH_RESULTS_HPP

#include <cstdio>
#include <string>
#include <vector>

#include "measure.hpp"

namespace bench {

class Results {
public:
    /// Appends to directory/results.csv and directory/spread.csv; writes the heads if they are new.
    explicit Results(const std::string &directory);
    ~Results();
    Results(const Results &) = delete;
    Results &operator=(const Results &) = delete;

    void add(const std::vector<Row> &rows);

private:
    std::FILE *results_, *spread_;
};

}  // namespace bench

#endif
