// bench_holonomic [--tiny | --quick] --out DIR [SECTION ..]
// bench_holonomic --isa: the instruction set in use
#include <holonomic.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <exception>
#include <thread>

#include "sections.hpp"
#include "stopwatch.hpp"

namespace bench {

void Run::measure(Level level, const Problem &p, const Methods &methods, const UnitSystems *systems) const {
    // The reference of the metric takes a time that grows as the square of the bonds of a chain.
    const Reference reference(p, level, systems, effort.reference_bonds / (level == Level::metric ? 4 : 1));
    measure(level, p, methods, [&reference](const State &s, double part) { return reference.error(s, part); });
}

void Run::measure(Level level, const Scene &p, const Methods &methods, const ErrorOf &error_of) const {
    std::printf("   %-12s %-12s %7lld x %-7lld %2zu rows", level_name(level), p.name.c_str(),
                static_cast<long long>(p.chains_per_call()), static_cast<long long>(p.bonds), methods.size());
    std::fflush(stdout);
    const Stopwatch watch(2);
    results.add(bench::measure(level, p, methods, effort, error_of));
    std::printf("%6.1f s\n", watch.seconds());
}

namespace {

using Section = void (*)(const Run &);

const std::vector<std::pair<std::string, Section>> sections = {
    {"acceleration", acceleration_section},
    {"velocity", velocity_section},
    {"position", position_section},
    {"metric", metric_section},
    {"solve", solve_section},
    {"skips", skips_section},
    {"condition", condition_section},
    {"drift", drift_section},
    {"molecules", molecules_section},
    {"adding", adding_section},
    {"isa", instruction_set_section},
};

Section find(const std::string &name) {
    for (const auto &section : sections)
        if (section.first == name) return section.second;
    return nullptr;
}

Effort effort_of(Extent extent) {
    Effort effort;
    if (extent == Extent::full) return effort;
    effort.repetitions = extent == Extent::quick ? 5 : 2;
    effort.seconds = extent == Extent::quick ? 0.003 : 1e-5;
    effort.reference_bonds = extent == Extent::quick ? 2000 : 200;
    return effort;
}

int usage() {
    std::fprintf(
        stderr,
        "usage: bench_holonomic [--tiny | --quick] --out DIR [SECTION ..]\n       bench_holonomic --isa\nsections:");
    for (const auto &section : sections) std::fprintf(stderr, " %s", section.first.c_str());
    std::fprintf(stderr, "\n");
    return 2;
}

}  // namespace
}  // namespace bench

int main(int argc, char **argv) {
    using namespace bench;
    Extent extent = Extent::full;
    std::string out;
    std::vector<std::string> wanted;
    for (int i = 1; i < argc; ++i) {
        if (std::strcmp(argv[i], "--quick") == 0)
            extent = Extent::quick;
        else if (std::strcmp(argv[i], "--tiny") == 0)
            extent = Extent::tiny;
        else if (std::strcmp(argv[i], "--isa") == 0)
            return std::printf("%s\n", hol_instruction_set()) < 0;
        else if (std::strcmp(argv[i], "--out") == 0 && i + 1 < argc)
            out = argv[++i];
        else if (argv[i][0] != '-' && find(argv[i]))
            wanted.push_back(argv[i]);
        else
            return usage();
    }
    if (out.empty()) return usage();
    try {
        start_measuring();
        Results results(out);
        const int threads = std::thread::hardware_concurrency() >= 2 ? 2 : 1;
        const Run run = {extent, effort_of(extent), results, threads};
        for (const auto &section : sections)
            if (wanted.empty() || std::find(wanted.begin(), wanted.end(), section.first) != wanted.end())
                section.second(run);
    } catch (const std::exception &problem) {
        std::fprintf(stderr, "bench_holonomic: %s\n", problem.what());
        return 1;
    }
    return 0;
}
