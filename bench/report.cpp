// bench_report DIR [PAGE]: writes DIR/report.md from DIR/results.csv, DIR/spread.csv and DIR/machine.txt; and replaces
// in PAGE what stands between <!-- bench NAME --> and <!-- end --> by the block of that name.
#include <cstdio>
#include <exception>
#include <fstream>
#include <iterator>
#include <sstream>
#include <stdexcept>

#include "tables.hpp"

namespace bench {
namespace {

struct Block {
    std::string name, title, text;
};

std::string machine_block(const std::string &directory) {
    std::ifstream machine(directory + "/machine.txt");
    std::string text;
    for (std::string line; std::getline(machine, line);) text += "    " + line + "\n";
    return text;
}

std::string plots_block() {
    std::string text;
    for (const char *name :
         {"positions_coil", "positions_straight5", "positions_light_joints", "size_acceleration", "size_velocity",
          "size_position", "condition", "energy_drift", "skips_acceleration", "skips_velocity", "skips_position",
          "skips_metric", "molecules_acceleration", "molecules_velocity", "molecules_position", "positions_water",
          "positions_dodecane", "large_acceleration", "large_position"})
        text += std::string("![") + name + "](" + name + ".png)\n";
    return text;
}

std::vector<Block> blocks(const std::string &directory) {
    const Table all(directory);
    return {
        {"machine", "The run", machine_block(directory)},
        {"glance", "At a glance, one thread", glance_block(all)},
        {"summary", "The library beside the others: times faster than (below 1: slower), one thread",
         summary_block(all)},
        {"targets", "What was aimed at, and what was reached", targets_block(all)},
        {"plots", "Plots", plots_block()},
        {"losses", "Where another method is faster and as accurate (error below ten times the library's, or 1.1e-12)",
         losses_block(all, true, false)},
        {"rough", "Where another method is faster and less accurate", losses_block(all, false, false)},
        {"molecules", "Molecules of any topology: times faster than (below 1: slower), one thread",
         molecules_block(all)},
        {"molecule_targets", "Molecules: what was aimed at, and what was reached", molecule_targets_block(all)},
        {"molecule_losses", "Molecules: where another method is faster and as accurate", losses_block(all, true, true)},
        {"molecule_rough", "Molecules: where another method is faster and less accurate",
         losses_block(all, false, true)},
        {"adding", "Adding bonds, one thread", adding_block(all)},
        {"batches", "Many chains in a call, the library's default", batches_block(all)},
        {"accelerations", "Accelerations: ns per bond against the length of a chain, one chain per call",
         sizes_block(all, "acceleration")},
        {"velocities", "Velocities, likewise", sizes_block(all, "velocity")},
        {"positions", "Positions, likewise", sizes_block(all, "position")},
        {"metric", "Metric, likewise", sizes_block(all, "metric")},
        {"solve", "The bare tridiagonal system, likewise", sizes_block(all, "solve")},
        {"coil", "Run time and error: coils", accuracy_block(all, "coil")},
        {"straight5", "Run time and error: nearly straight chains", accuracy_block(all, "straight5")},
        {"light_joints", "Run time and error: light joints", accuracy_block(all, "light_joints")},
        {"condition", "Error of the multipliers against the condition number, 64 bonds", condition_block(all)},
        {"drift", "Energy drift over the kinetic energy, per unit of time", drift_block(all)},
        {"skips",
         "What a scene saves or pays: ns per bond (over the whole work on a plain melt), 1000 chains of 100 bonds",
         skips_block(all)},
    };
}

std::string read(const std::string &name) {
    std::ifstream file(name);
    if (!file) throw std::runtime_error("cannot read " + name);
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

void write(const std::string &name, const std::string &text) {
    std::ofstream file(name);
    file << text;
    file.close();
    if (!file) throw std::runtime_error("cannot write " + name);
}

std::string report(const std::vector<Block> &list) {
    std::string text =
        "# Run time against error\n\nMade by scripts/bench from results.csv; docs/benchmarks/rows.md of the source "
        "tree "
        "explains rows, methods and errors. Medians; spread is the range between the quartiles.\n";
    for (const Block &block : list) text += "\n## " + block.title + "\n\n" + block.text;
    return text;
}

/// The page with its blocks replaced; a name that is none of ours is an error.
std::string renew(const std::string &page, const std::vector<Block> &list) {
    const std::string open = "<!-- bench ", close = " -->\n", end = "<!-- end -->";
    std::string text;
    std::size_t at = 0;
    for (std::size_t from; (from = page.find(open, at)) != std::string::npos;) {
        const std::size_t name = from + open.size(), inside = page.find(close, name), to = page.find(end, name);
        if (inside == std::string::npos || to == std::string::npos || inside > to)
            throw std::runtime_error("a block without its end");
        const Block *block = nullptr;
        for (const Block &b : list)
            if (b.name == page.substr(name, inside - name)) block = &b;
        if (!block) throw std::runtime_error("there is no block " + page.substr(name, inside - name));
        text += page.substr(at, inside + close.size() - at) + "\n" + block->text + "\n";
        at = to;
    }
    return text + page.substr(at);
}

}  // namespace
}  // namespace bench

int main(int argc, char **argv) {
    if (argc < 2 || argc > 3) {
        std::fprintf(stderr, "usage: bench_report DIR [PAGE]\n");
        return 2;
    }
    try {
        const std::vector<bench::Block> list = bench::blocks(argv[1]);
        bench::write(std::string(argv[1]) + "/report.md", bench::report(list));
        if (argc == 3) bench::write(argv[2], bench::renew(bench::read(argv[2]), list));
    } catch (const std::exception &problem) {
        std::fprintf(stderr, "bench_report: %s\n", problem.what());
        return 1;
    }
    return 0;
}
