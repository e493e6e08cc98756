/**
 * Hostile molecules with rigid bodies against the reference solution for a given time, with every set of kernels that
 * runs here or with that which HOLONOMIC_ISA names:
 *     stress_bodies SECONDS [FIRST [PROCESSES [PERCENT]]]
 *         molecules from number FIRST on. PERCENT of each class may exceed a bound, by a factor of three at most.
 *     stress_bodies --group FIRST
 *         the group that begins with number FIRST
 *     stress_bodies --seed NUMBER...
 *         these molecules, each alone and to its group, among those of a run from number 1 on.
 * Exit status 0: everything within its bounds; 1: something is not; 2: wrong usage.
 */
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <thread>
#include <vector>

#include "body_checks.hpp"
#include "molecule_tally.hpp"
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

/** Molecules that are computed together, and each of them alone; in half of the groups all are of one kind, side by
 * side in the kernels if they are lone bodies. */
struct group_of_bodies {
    std::uint64_t first;
    std::vector<hostile_body> molecules;
    std::vector<reference::rigid_solution> exact;

    explicit group_of_bodies(std::uint64_t from) : first(from)
    {
        random_stream stream = random_seed(first);
        const std::uint64_t size = static_cast<std::uint64_t>(random_integer(&stream, 1, group_size));
        const bool twins = random_uniform(&stream) < 0.5;
        const hostile_body one =
            make_one(first + static_cast<std::uint64_t>(random_integer(&stream, 0, N_BODY_CLASSES - 1)));
        for (std::uint64_t k = 0; k < size; ++k)
            molecules.push_back(twins ? make_twin(one, first + k) : make_one(first + k));
    }
    /** A quarter of the groups are of relations, another one of lists that depend. */
    hostile_body make_one(std::uint64_t seed) const
    {
        const std::uint64_t kind = first / group_size % 4;
        return kind == 1 ? make_related(seed) : kind == 3 ? make_listed(seed) : make_hostile_body(seed);
    }
    void solve()
    {
        for (const hostile_body &m : molecules)
            exact.push_back(m.shape == LISTED ? reference::rigid_solution() : solution_of(m));
    }
    /** With the kernels that are in use: lists, whose positions are the library's. */
    group_of_bodies completed() const
    {
        group_of_bodies g = *this;
        for (std::size_t k = 0; k < g.molecules.size(); ++k) {
            if (g.molecules[k].shape != LISTED) continue;
            complete_listed(g.molecules[k]);
            g.exact[k] = solution_of(g.molecules[k]);
        }
        return g;
    }
    static reference::rigid_solution solution_of(const hostile_body &m)
    {
        if (m.refused) return {};
        reference::rigid_solution s = reference::solve_rigid(m.p, m.right_hand_side(), m.drifted(), m.dt);
        if (s.regular && !s.agrees) {
            std::printf("stress: the two reference solutions of molecule %llu differ\n", number(m.seed));
            std::exit(2);
        }
        return s;
    }
};

void check(const group_of_bodies &given, molecule_tally &sum)
{
    const group_of_bodies g = given.completed();
    std::vector<molecule_verdict> verdicts(g.molecules.size());
    check_invariances(g.molecules, g.first + 1, verdicts);
    for (std::size_t k = 0; k < g.molecules.size(); ++k) {
        const hostile_body &m = g.molecules[k];
        molecule_facts facts;
        verdicts[k].add(check_alone(m, g.exact[k], facts));
        if (!sum.add(m.shape, m.n_bonds(), m.seed, facts, verdicts[k])) continue;
        std::printf(
            "molecule %llu (%s), %zu atoms, %lld bonds, least pivot %.1Le:%s repeat with HOLONOMIC_ISA=%s "
            "tests/stress/stress_bodies --group %llu\n",
            number(m.seed), m.words().c_str(), m.p.n_atoms(), static_cast<long long>(m.n_bonds()), facts.least_pivot,
            exceeded_words(verdicts[k]).c_str(), hol_instruction_set(), number(g.first));
    }
}

int check_seed(std::uint64_t seed)
{
    const std::uint64_t first = seed - (seed - 1) % group_size;  // groups begin with 1, 9, ...
    group_of_bodies g(first);
    const bool in_group = seed - first < g.molecules.size();
    if (!in_group) {
        g.molecules.push_back(g.make_one(seed));
    } else {
        const auto its = g.molecules.begin() + static_cast<std::ptrdiff_t>(seed - first);
        std::rotate(its, its + 1, g.molecules.end());
    }
    g.exact.resize(g.molecules.size());
    g = g.completed();
    std::vector<molecule_verdict> verdicts(g.molecules.size());
    check_invariances(g.molecules, first + 1, verdicts);
    const hostile_body &m = g.molecules.back();
    molecule_facts facts;
    molecule_verdict v = check_alone(m, group_of_bodies::solution_of(m), facts);
    v.add(verdicts.back());
    std::printf("%llu: %s; %zu atoms, %lld bonds, least pivot %.2Le\n", number(seed), m.words().c_str(), m.p.n_atoms(),
                static_cast<long long>(m.n_bonds()), facts.least_pivot);
    for (int q = 0; q < M_QUANTITIES; ++q) {
        const long double ratio = v.ratio[static_cast<std::size_t>(q)];
        if (ratio >= 0) std::printf("%-14s %12.3Lg of its bound\n", molecule_quantity_name(q), ratio);
    }
    return !exceeded_words(v).empty();
}

int run(const soak_options &options, double percent)
{
    const std::vector<std::string> sets = sets_of_kernels();
    shared_tallies<molecule_tally> tallies(options.workers, sets.size());
    std::vector<group_of_bodies> batch;
    soak_work work;
    work.prepare = [&](std::uint64_t first) {
        batch.emplace_back(first);
        batch.back().solve();
    };
    work.check = [&](unsigned worker, std::size_t set) {
        for (const group_of_bodies &g : batch) check(g, tallies.of(worker, set));
    };
    work.clear = [&] { batch.clear(); };
    work.progress = [&] {
        std::int64_t molecules = 0, exceeded = 0;
        for (const molecule_tally &t : tallies.of_all_sets())
            for (const auto &c : t.classes) molecules += c.molecules, exceeded += c.exceeded;
        std::fprintf(stderr, "%lld molecules with bodies, %lld above a bound\n", static_cast<long long>(molecules),
                     static_cast<long long>(exceeded));
    };
    work.repeat = "tests/stress/stress_bodies --group";
    const int lost = soak(options, sets, work);
    const std::vector<molecule_tally> of_set = tallies.of_all_sets();
    print(body_class_name, LISTED + 1, sets, of_set);
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
        return run({1e-9, std::strtoull(argv[2], nullptr, 10), 1}, -1);
    soak_options options;
    options.seconds = argc >= 2 ? std::atof(argv[1]) : 0;
    if (!(options.seconds > 0) || argc > 5) {
        std::fprintf(stderr,
                     "usage: stress_bodies SECONDS [FIRST [PROCESSES [PERCENT]]] | --group FIRST | "
                     "--seed NUMBER...\n");
        return 2;
    }
    options.first = static_cast<std::uint64_t>(integer(2, 1));
    options.workers =
        static_cast<unsigned>(std::max(1LL, integer(3, static_cast<long long>(std::thread::hardware_concurrency()))));
    return run(options, argc >= 5 ? std::atof(argv[4]) : -1);
}
