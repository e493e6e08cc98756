// bench_report DIR: writes DIR/report.md from DIR/results.csv, DIR/spread.csv and DIR/machine.txt.
#include <cmath>
#include <cstdio>
#include <exception>
#include <fstream>
#include <set>
#include <stdexcept>
#include <string>

#include "table.hpp"

namespace bench {
namespace {

using Table = std::vector<Measurement>;

std::string number(double x, const char *format = "%.3g") {
    char text[32];
    std::snprintf(text, sizeof text, format, x);
    return text;
}

std::string scene_of(const Measurement &m) {
    return m.level + ", " + m.problem + ", " + std::to_string(m.chains) + " x " + std::to_string(m.bonds) +
           (m.threads > 1 ? ", " + std::to_string(m.threads) + " threads" : "");
}

const Measurement *find(const Table &all, const std::string &level, const std::string &problem, std::int64_t chains,
                        std::int64_t bonds, const std::string &method, const std::string &setting, int threads = 1) {
    for (const Measurement &m : all)
        if (m.level == level && m.problem == problem && m.chains == chains && m.bonds == bonds &&
            m.threads == threads && m.method == method && m.setting == setting)
            return &m;
    return nullptr;
}

struct Scene {
    const char *level, *problem;
    std::int64_t chains, bonds;
};

struct Rival {
    const char *method, *setting;
};

/// The library beside the strongest others on the scenes that matter most.
void headline(std::FILE *out, const Table &all) {
    static const Scene scenes[] = {
        {"acceleration", "melt", 10000, 100}, {"acceleration", "melt", 1000, 100},
        {"acceleration", "melt", 256, 32},    {"acceleration", "melt", 100000, 3},
        {"acceleration", "coil", 1, 1000000}, {"acceleration", "straight5", 1, 1000000},
        {"acceleration", "coil", 1, 1000},    {"velocity", "melt", 1000, 100},
        {"position", "coil", 1000, 100},      {"position", "coil", 10000, 3},
        {"position", "coil", 100000, 1},      {"position", "coil", 1, 100000},
    };
    static const Rival rivals[] = {
        {"lapack-dptsv", "assembled"},     {"lapack-dgtsv", "assembled"},        {"rattle", "tolerance 1e-12"},
        {"milc-shake", "tolerance 1e-12"}, {"sparse-newton", "tolerance 1e-12"}, {"lincs", "order 4 iterations 1"},
    };
    std::fprintf(out,
                 "## The library beside the others\n\nTimes faster than (below 1: slower). `default` rows, one thread; "
                 "2 threads: "
                 "one thread's time over two threads'.\n\n| scene | ns/bond | memory passes | error | 2 threads | "
                 "dptsv | dgtsv | "
                 "RATTLE 1e-12 | MILC-SHAKE 1e-12 | sparse Newton 1e-12 | LINCS 4, 1 "
                 "|\n|---|---|---|---|---|---|---|---|---|---|---|\n");
    for (const Scene &s : scenes) {
        const Measurement *own = find(all, s.level, s.problem, s.chains, s.bonds, "holonomic", "default");
        if (!own) continue;
        const Measurement *two = find(all, s.level, s.problem, s.chains, s.bonds, "holonomic", "default", 2);
        std::fprintf(out, "| %s | %s | %s | %s | %s |", scene_of(*own).c_str(), number(own->ns).c_str(),
                     number(own->passes).c_str(), number(own->error, "%.1e").c_str(),
                     two ? number(own->ns / two->ns).c_str() : "");
        for (const Rival &rival : rivals) {
            const Measurement *other = find(all, s.level, s.problem, s.chains, s.bonds, rival.method, rival.setting);
            std::fprintf(out, " %s |", other ? number(other->ns / own->ns).c_str() : "");
        }
        std::fprintf(out, "\n");
    }
}

/// Every scene in which another method with an error no worse than ten times the library's, or than 1e-12, took less
/// time.
void losses(std::FILE *out, const Table &all) {
    std::fprintf(
        out,
        "\n## Where another method is faster\n\nEvery row that took less time than the library's default on the same "
        "scene, with an error below ten times the library's or below 1.1e-12; then those that are faster at a "
        "larger error.\n");
    for (const bool accurate : {true, false}) {
        std::fprintf(out,
                     "\n### %s\n\n| scene | method | ns/bond | error | holonomic: ns/bond | error "
                     "|\n|---|---|---|---|---|---|\n",
                     accurate ? "As accurate" : "Less accurate");
        int n = 0;
        for (const Measurement &m : all) {
            if (m.method == "holonomic" || m.is_special()) continue;
            const Measurement *own =
                find(all, m.level, m.problem, m.chains, m.bonds, "holonomic", "default", m.threads);
            if (!own || m.ns >= own->ns || (m.error <= std::fmax(10 * own->error, 1.1e-12)) != accurate) continue;
            std::fprintf(out, "| %s | %s, %s | %s | %s | %s | %s |\n", scene_of(m).c_str(), m.method.c_str(),
                         m.setting.c_str(), number(m.ns).c_str(), number(m.error, "%.1e").c_str(),
                         number(own->ns).c_str(), number(own->error, "%.1e").c_str());
            ++n;
        }
        if (n == 0) std::fprintf(out, "| none | | | | | |\n");
    }
}

void all_tables(std::FILE *out, const Table &all) {
    std::fprintf(
        out,
        "\n## All measurements\n\nMedians; the spread is the range between the quartiles, in percent of the median.\n");
    std::set<std::string> done;
    for (const Measurement &first : all) {
        if (first.is_special() || !done.insert(scene_of(first)).second) continue;
        std::fprintf(
            out,
            "\n### %s\n\n| method | setting | ns/bond | spread | memory passes | error |\n|---|---|---|---|---|---|\n",
            scene_of(first).c_str());
        for (const Measurement &m : all)
            if (m.same_scene(first) && !m.is_special())
                std::fprintf(out, "| %s | %s | %s | %s %% | %s | %s |\n", m.method.c_str(), m.setting.c_str(),
                             number(m.ns).c_str(), number(100 * (m.upper - m.lower) / m.ns, "%.0f").c_str(),
                             number(m.passes).c_str(), number(m.error, "%.1e").c_str());
    }
}

void plots(std::FILE *out) {
    static const char *const names[] = {"positions_coil",    "positions_straight5", "positions_light_joints",
                                        "size_acceleration", "size_velocity",       "size_position",
                                        "condition",         "energy_drift",        "skips_acceleration",
                                        "skips_velocity",    "skips_position",      "skips_metric"};
    std::fprintf(out, "\n## Plots\n\n");
    for (const char *name : names) std::fprintf(out, "![%s](%s.png)\n\n", name, name);
}

void write(const std::string &directory) {
    const Table all = read_results(directory);
    std::FILE *out = std::fopen((directory + "/report.md").c_str(), "w");
    if (!out) throw std::runtime_error("cannot write report.md");
    std::fprintf(
        out,
        "# Run time against error\n\nMade by scripts/bench; docs/benchmarks.md of the source tree explains rows, "
        "methods and errors.\n\n");
    std::ifstream machine(directory + "/machine.txt");
    for (std::string line; std::getline(machine, line);) std::fprintf(out, "    %s\n", line.c_str());
    std::fprintf(out, "\n");
    headline(out, all);
    losses(out, all);
    plots(out);
    all_tables(out, all);
    std::fclose(out);
}

}  // namespace
}  // namespace bench

int main(int argc, char **argv) {
    if (argc != 2) {
        std::fprintf(stderr, "usage: bench_report DIR\n");
        return 2;
    }
    try {
        bench::write(argv[1]);
    } catch (const std::exception &problem) {
        std::fprintf(stderr, "bench_report: %s\n", problem.what());
        return 1;
    }
    return 0;
}
