#include "results.hpp"

#include <stdexcept>

namespace bench {
namespace {

std::FILE *open(const std::string &name, const char *head) {
    std::FILE *file = std::fopen(name.c_str(), "a");
    if (!file) throw std::runtime_error("cannot write " + name);
    std::fseek(file, 0, SEEK_END);
    if (std::ftell(file) == 0) std::fprintf(file, "%s\n", head);
    return file;
}

}  // namespace

Results::Results(const std::string &directory)
    : results_(open(directory + "/results.csv",
                    "level,problem,chains,bonds,threads,method,setting,error,ns_per_bond,memory_passes")),
      spread_(open(directory + "/spread.csv",
                   "level,problem,chains,bonds,threads,method,setting,repetitions,smallest,lower_quartile,median,"
                   "upper_quartile,largest")) {}

Results::~Results() {
    std::fclose(results_);
    std::fclose(spread_);
}

void Results::add(const std::vector<Row> &rows) {
    for (const Row &row : rows) {
        for (std::FILE *file : {results_, spread_})
            std::fprintf(file, "%s,%s,%lld,%lld,%d,%s,%s,", row.level.c_str(), row.problem.c_str(),
                         static_cast<long long>(row.chains), static_cast<long long>(row.bonds), row.threads,
                         row.method.c_str(), row.setting.c_str());
        std::fprintf(results_, "%.3g,%.4g,%.4g\n", row.error, row.ns_per_bond, row.memory_passes);
        std::fprintf(spread_, "%d,%.4g,%.4g,%.4g,%.4g,%.4g\n", row.repetitions, row.smallest, row.lower_quartile,
                     row.ns_per_bond, row.upper_quartile, row.largest);
    }
    std::fflush(results_);
    std::fflush(spread_);
}

}  // namespace bench
