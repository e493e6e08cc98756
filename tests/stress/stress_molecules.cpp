/**
 * Hostile molecules of any shape against the reference solution for a given time:
 *     stress_molecules SECONDS [DIRECTORY [FIRST [THREADS [PERCENT]]]]
 *         molecules from number FIRST on; those that exceed a bound go to DIRECTORY, as files for scripts/oracle.
 * PERCENT of each class may exceed one, by a factor of three at most: for a test that guards what docs/stability.md
 * says.
 *     stress_molecules --seed NUMBER...
 *         these molecules.
 * Exit status 0: everything within its bounds; 1: something is not; 2: wrong usage.
 */
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "molecule_checks.hpp"
#include "molecule_tally.hpp"
#include "molecule_text.hpp"
#include "random.h"

using namespace stress;

namespace
{

constexpr std::uint64_t group_size = 8;
constexpr int most_files = 300;  // the disk stays free
constexpr long double largest_excess = 3;

using clock_type = std::chrono::steady_clock;

struct run {
    double seconds;
    std::string directory;
    clock_type::time_point start = clock_type::now();
    std::atomic<std::uint64_t> next;
    std::atomic<int> files{0};
    std::mutex lock;
    molecule_tally total;  // under the lock

    double elapsed() const
    {
        return std::chrono::duration<double>(clock_type::now() - start).count();
    }
};

std::string exceeded_words(const molecule_verdict &v)
{
    std::string words = "# exceeds:";
    char text[64];
    for (int q = 0; q < M_QUANTITIES; ++q) {
        const long double x = v.ratio[static_cast<std::size_t>(q)];
        if (!(x > 1) || is_information(q)) continue;
        std::snprintf(text, sizeof text, " %s %.3Lg times its bound;", molecule_quantity_name(q), x);
        words += text;
    }
    return words + "\n";
}

/** A file for scripts/oracle. */
void keep(run &all, const hostile_molecule &m, const molecule_verdict &v, bool regular)
{
    if (all.directory.empty() || all.files.fetch_add(1) >= most_files) return;
    const std::string name = "molecule_" + std::to_string(m.seed);
    const std::vector<double> drifted = m.drifted();
    const std::string text = reference::molecule_text(
        m.problem(), {name, !regular, {drifted.data(), m.length.data(), m.dt > 0 ? m.dt : 1, nullptr}});
    if (text.empty()) {  // a number that is zero but for the rounding of any arithmetic
        std::fprintf(stderr, "stress: no file for number %llu, which --seed repeats\n",
                     static_cast<unsigned long long>(m.seed));
        return;
    }
    const std::lock_guard<std::mutex> guard(all.lock);
    std::FILE *out = std::fopen((all.directory + "/" + name + ".txt").c_str(), "w");
    std::FILE *index = std::fopen((all.directory + "/INDEX").c_str(), "a");
    if (out)
        std::fprintf(out, "%s# seed %llu: %s\n%s", exceeded_words(v).c_str(), static_cast<unsigned long long>(m.seed),
                     m.words().c_str(), text.c_str());
    if (out && index) std::fprintf(index, "%s.txt\n", name.c_str());
    if (!out || !index) std::fprintf(stderr, "stress: %s can't be written\n", all.directory.c_str());
    if (out) std::fclose(out);
    if (index) std::fclose(index);
}

/** The molecules of the group that begins with `first`; in half of the groups all are of one shape, to share a block.
 */
std::vector<hostile_molecule> group_of(std::uint64_t first)
{
    random_stream stream = random_seed(first);
    std::vector<hostile_molecule> molecules;
    const std::uint64_t size = static_cast<std::uint64_t>(random_integer(&stream, 1, group_size));
    const bool siblings = random_uniform(&stream) < 0.5;
    const hostile_molecule one =
        make_hostile_molecule(first + static_cast<std::uint64_t>(random_integer(&stream, 0, N_CLASSES - 1)));
    for (std::uint64_t k = 0; k < size; ++k)
        molecules.push_back(siblings ? make_sibling(one, first + k) : make_hostile_molecule(first + k));
    return molecules;
}

void check_group(run &all, std::uint64_t first)
{
    molecule_tally sum;
    const std::vector<hostile_molecule> molecules = group_of(first);
    std::vector<molecule_verdict> verdicts(molecules.size());
    check_invariances(molecules, first + 1, verdicts);
    for (std::size_t k = 0; k < molecules.size(); ++k) {
        molecule_facts facts;
        verdicts[k].add(check_alone(molecules[k], facts));
        if (sum.add(molecules[k], facts, verdicts[k])) keep(all, molecules[k], verdicts[k], facts.regular);
    }
    const std::lock_guard<std::mutex> guard(all.lock);
    all.total.add(sum);
}

void work(run &all)
{
    do {
        check_group(all, all.next.fetch_add(group_size));
    } while (all.elapsed() < all.seconds);
}

int check_seed(std::uint64_t seed)
{
    const std::uint64_t first = seed - (seed - 1) % group_size;  // groups begin with 1, 9, ...
    const std::vector<hostile_molecule> molecules = group_of(first);
    std::vector<molecule_verdict> verdicts(molecules.size());
    check_invariances(molecules, first + 1, verdicts);
    const bool in_group = seed - first < molecules.size();
    const hostile_molecule m = in_group ? molecules[seed - first] : make_hostile_molecule(seed);
    molecule_facts facts;
    molecule_verdict v = check_alone(m, facts);
    if (in_group) v.add(verdicts[seed - first]);
    std::printf("%llu: %s; %lld atoms, %lld bonds, condition number %.2Le, least pivot %.2Le\n",
                static_cast<unsigned long long>(seed), m.words().c_str(), static_cast<long long>(m.n_atoms()),
                static_cast<long long>(m.n_bonds()), facts.condition, facts.least_pivot);
    bool exceeds = false;
    for (int q = 0; q < M_QUANTITIES; ++q) {
        const long double ratio = v.ratio[static_cast<std::size_t>(q)];
        if (ratio >= 0) std::printf("%-14s %12.3Lg of its bound\n", molecule_quantity_name(q), ratio);
        exceeds = exceeds || (ratio > 1 && !is_information(q));
    }
    return exceeds;
}

}  // namespace

int main(int argc, char **argv)
{
    if (argc >= 3 && std::strcmp(argv[1], "--seed") == 0) {
        int exceed = 0;
        for (int k = 2; k < argc; ++k) exceed += check_seed(std::strtoull(argv[k], nullptr, 10));
        return exceed > 0;
    }
    const double seconds = argc >= 2 ? std::atof(argv[1]) : 0;
    if (!(seconds > 0) || argc > 6) {
        std::fprintf(stderr,
                     "usage: stress_molecules SECONDS [DIRECTORY [FIRST [THREADS [PERCENT]]]] | --seed NUMBER...\n");
        return 2;
    }
    run all;
    all.seconds = seconds;
    if (argc >= 3) all.directory = argv[2];
    all.next = argc >= 4 ? std::strtoull(argv[3], nullptr, 10) : 1;
    const unsigned n_threads = argc >= 5 ? static_cast<unsigned>(std::max(1, std::atoi(argv[4])))
                                         : std::max(1u, std::thread::hardware_concurrency());
    std::vector<std::thread> threads;
    for (unsigned t = 0; t < n_threads; ++t) threads.emplace_back(work, std::ref(all));
    for (std::thread &t : threads) t.join();
    all.total.print();
    std::printf("stress: molecules from number %s on, instruction set %s\n", argc >= 4 ? argv[3] : "1",
                hol_instruction_set());
    return all.total.within(argc >= 6 ? largest_excess : 1, argc >= 6 ? std::atof(argv[5]) / 100 : 0) ? 0 : 1;
}
