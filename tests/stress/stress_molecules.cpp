/**
 * Hostile molecules of any shape against the reference solution for a given time, with every set of kernels that runs
 * here or with that which HOLONOMIC_ISA names:
 *     stress_molecules SECONDS [DIRECTORY [FIRST [PROCESSES [PERCENT]]]]
 *         molecules from number FIRST on; those that exceed a bound go to DIRECTORY, as files for scripts/oracle.
 * PERCENT of each class may exceed one, by a factor of three at most: for a test that guards what docs/stability.md
 * says.
 *     stress_molecules --group FIRST
 *         the group that begins with number FIRST
 *     stress_molecules --seed NUMBER...
 *         these molecules, among those of a run from number 1 on.
 * Exit status 0: everything within its bounds; 1: something is not; 2: wrong usage.
 */
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <thread>
#include <vector>

#include "molecule_checks.hpp"
#include "molecule_tally.hpp"
#include "molecule_text.hpp"
#include "random.h"
#include "soak.hpp"

using namespace stress;

namespace
{

constexpr long double largest_excess = 3;

unsigned long long number(std::uint64_t n)
{
    return n;
}

/** A file for scripts/oracle, unless there is one. */
void keep(const std::string &directory, const hostile_molecule &m, const std::string &words, bool regular)
{
    const std::string name = "molecule_" + std::to_string(m.seed);
    const std::vector<double> drifted = m.drifted();
    const std::string text = reference::molecule_text(
        m.problem(), {name, !regular, {drifted.data(), m.length.data(), m.dt > 0 ? m.dt : 1, nullptr}});
    if (text.empty()) {  // a number that is zero but for the rounding of any arithmetic
        std::printf("no file for number %llu, which --group repeats\n", number(m.seed));
        return;
    }
    std::FILE *const out = std::fopen((directory + "/" + name + ".txt").c_str(), "wx");
    if (!out) return;
    std::fprintf(out, "# exceeds:%s\n# seed %llu: %s\n%s", words.c_str(), number(m.seed), m.words().c_str(),
                 text.c_str());
    std::fclose(out);
    std::FILE *const index = std::fopen((directory + "/INDEX").c_str(), "a");
    if (!index) return;
    std::fprintf(index, "%s.txt\n", name.c_str());
    std::fclose(index);
}

/** Molecules that are computed together, and each of them alone; in half of the groups all are of one shape, to share a
 * block. */
struct group_of_molecules {
    std::uint64_t first;
    std::vector<hostile_molecule> molecules;
    std::vector<molecule_reference> exact;

    explicit group_of_molecules(std::uint64_t from) : first(from)
    {
        random_stream stream = random_seed(first);
        const std::uint64_t size = static_cast<std::uint64_t>(random_integer(&stream, 1, group_size));
        const bool siblings = random_uniform(&stream) < 0.5;
        const hostile_molecule one =
            make_hostile_molecule(first + static_cast<std::uint64_t>(random_integer(&stream, 0, N_CLASSES - 1)));
        for (std::uint64_t k = 0; k < size; ++k)
            molecules.push_back(siblings ? make_sibling(one, first + k) : make_hostile_molecule(first + k));
    }
    void solve()
    {
        for (const hostile_molecule &m : molecules) exact.emplace_back(m);
    }
};

void check(const group_of_molecules &g, const std::string &directory, molecule_tally &sum)
{
    std::vector<molecule_verdict> verdicts(g.molecules.size());
    check_invariances(g.molecules, g.first + 1, verdicts);
    for (std::size_t k = 0; k < g.molecules.size(); ++k) {
        const hostile_molecule &m = g.molecules[k];
        molecule_facts facts;
        verdicts[k].add(check_alone(m, g.exact[k], facts));
        if (!sum.add(m.shape, m.n_bonds(), m.seed, facts, verdicts[k])) continue;
        const std::string words = exceeded_words(verdicts[k]);
        std::printf(
            "molecule %llu, %lld bonds, condition number %.1Le, least pivot %.1Le:%s repeat with "
            "HOLONOMIC_ISA=%s tests/stress/stress_molecules --group %llu\n",
            number(m.seed), static_cast<long long>(m.n_bonds()), facts.condition, facts.least_pivot, words.c_str(),
            hol_instruction_set(), number(g.first));
        if (!directory.empty()) keep(directory, m, words, facts.regular);
    }
}

int check_seed(std::uint64_t seed)
{
    const std::uint64_t first = seed - (seed - 1) % group_size;  // groups begin with 1, 9, ...
    const group_of_molecules g(first);
    std::vector<molecule_verdict> verdicts(g.molecules.size());
    check_invariances(g.molecules, first + 1, verdicts);
    const bool in_group = seed - first < g.molecules.size();
    const hostile_molecule m = in_group ? g.molecules[seed - first] : make_hostile_molecule(seed);
    molecule_facts facts;
    molecule_verdict v = check_alone(m, molecule_reference(m), facts);
    if (in_group) v.add(verdicts[seed - first]);
    std::printf("%llu: %s; %lld atoms, %lld bonds, condition number %.2Le, least pivot %.2Le\n", number(seed),
                m.words().c_str(), static_cast<long long>(m.n_atoms()), static_cast<long long>(m.n_bonds()),
                facts.condition, facts.least_pivot);
    bool exceeds = false;
    for (int q = 0; q < M_QUANTITIES; ++q) {
        const long double ratio = v.ratio[static_cast<std::size_t>(q)];
        if (ratio >= 0) std::printf("%-14s %12.3Lg of its bound\n", molecule_quantity_name(q), ratio);
        exceeds = exceeds || (ratio > 1 && !is_information(q));
    }
    return exceeds;
}

int run(const soak_options &options, const std::string &directory, double percent)
{
    const std::vector<std::string> sets = sets_of_kernels();
    shared_tallies<molecule_tally> tallies(options.workers, sets.size());
    std::vector<group_of_molecules> batch;
    soak_work work;
    work.prepare = [&](std::uint64_t first) {
        batch.emplace_back(first);
        batch.back().solve();
    };
    work.check = [&](unsigned worker, std::size_t set) {
        for (const group_of_molecules &g : batch) check(g, directory, tallies.of(worker, set));
    };
    work.clear = [&] { batch.clear(); };
    work.progress = [&] {
        std::int64_t molecules = 0, exceeded = 0;
        for (const molecule_tally &t : tallies.of_all_sets())
            for (const auto &c : t.classes) molecules += c.molecules, exceeded += c.exceeded;
        std::fprintf(stderr, "%lld molecules, %lld above a bound\n", static_cast<long long>(molecules),
                     static_cast<long long>(exceeded));
    };
    work.repeat = "tests/stress/stress_molecules --group";
    const int lost = soak(options, sets, work);
    const std::vector<molecule_tally> of_set = tallies.of_all_sets();
    print(class_name, N_CLASSES, sets, of_set);
    if (lost > 0) std::printf("stress: %d processes ended before their time\n", lost);
    bool within = lost == 0;
    for (const molecule_tally &t : of_set)
        within = within && t.within(percent < 0 ? 1 : largest_excess, percent < 0 ? 0 : percent / 100);
    return within ? 0 : 1;
}

}  // namespace

int main(int argc, char **argv)
{
    const auto integer = [&](int i, long long otherwise) { return argc > i ? std::atoll(argv[i]) : otherwise; };
    if (argc >= 3 && std::strcmp(argv[1], "--seed") == 0) {
        int exceed = 0;
        for (int k = 2; k < argc; ++k) exceed += check_seed(std::strtoull(argv[k], nullptr, 10));
        return exceed > 0;
    }
    if (argc == 3 && std::strcmp(argv[1], "--group") == 0)
        return run({1e-9, static_cast<std::uint64_t>(integer(2, 1)), 1}, "", -1);
    soak_options options;
    options.seconds = argc >= 2 ? std::atof(argv[1]) : 0;
    if (!(options.seconds > 0) || argc > 6) {
        std::fprintf(stderr,
                     "usage: stress_molecules SECONDS [DIRECTORY [FIRST [PROCESSES [PERCENT]]]] | --group FIRST | "
                     "--seed NUMBER...\n");
        return 2;
    }
    options.first = static_cast<std::uint64_t>(integer(3, 1));
    options.workers =
        static_cast<unsigned>(std::max(1LL, integer(4, static_cast<long long>(std::thread::hardware_concurrency()))));
    return run(options, argc >= 3 ? argv[2] : "", argc >= 6 ? std::atof(argv[5]) : -1);
}
