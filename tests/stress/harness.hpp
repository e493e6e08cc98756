/**
 * @file harness.hpp
 * What the stress tests of chains, of molecules and of molecules with bodies have in common: groups of cases through
 * all sets of kernels for a given time, what exceeds a bound counted and told, and the command line for that.
 */
#ifndef STRESS_HARNESS_HPP
#define STRESS_HARNESS_HPP

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <thread>
#include <vector>

#include "soak.hpp"
#include "tally.hpp"

namespace stress
{

/** So many times its bound may an error be where a share of the cases may exceed one at all. */
constexpr long double largest_excess = 3;

template <class Group, class Tally>
struct harness {
    const char *program, *repeat;  ///< its name, and the option that repeats a group
    class_names names;
    std::function<Group(std::uint64_t first)> make;        ///< a group with its reference solutions
    std::function<void(const Group &, Tally &sum)> check;  ///< tells what exceeds its bound
    /** What stands at the end; by default a table for each class and a line for each class and set. */
    std::function<void(const std::vector<std::string> &sets, const std::vector<Tally> &of_set)> print;

    /** Returns the tallies of all sets; complete: no process ended before its time. */
    std::vector<Tally> run(const soak_options &options, bool &complete) const
    {
        const std::vector<std::string> sets = sets_of_kernels();
        shared_tallies<Tally> tallies(options.workers, sets.size());
        std::vector<Group> batch;
        soak_work work;
        work.prepare = [&](std::uint64_t first) { batch.push_back(make(first)); };
        work.check = [&](unsigned worker, std::size_t set) {
            for (const Group &g : batch) check(g, tallies.of(worker, set));
        };
        work.clear = [&] { batch.clear(); };
        work.progress = [&] {
            Tally sum;
            for (const Tally &t : tallies.of_all_sets()) sum.add(t);
            std::fprintf(stderr, "%lld checked, %lld above a bound\n", static_cast<long long>(sum.all().cases),
                         static_cast<long long>(sum.all().exceeded));
        };
        work.repeat = std::string("tests/stress/") + program + " " + repeat;
        const int lost = soak(options, sets, work);
        const std::vector<Tally> of_set = tallies.of_all_sets();
        if (print) {
            print(sets, of_set);
        } else {
            print_tables(names, sets, of_set);
            write_markdown(names, sets, of_set);
            print_sums(names, sets, of_set);
        }
        if (lost > 0) std::printf("stress: %d processes ended before their time\n", lost);
        complete = lost == 0;
        return of_set;
    }
    /** The same for all sets. 0: all is within. */
    int run(const soak_options &options, double percent) const
    {
        bool within = false;
        const std::vector<Tally> of_set = run(options, within);
        for (const Tally &t : of_set) within = within && is_within(t, percent);
        return within ? 0 : 1;
    }
    /** PERCENT of each class may exceed a bound; below 0: nothing may. */
    static bool is_within(const Tally &t, double percent)
    {
        return t.within(percent < 0 ? 1 : largest_excess, percent < 0 ? 0 : percent / 100);
    }
};

/** argv[i] as a number, if it is there. */
struct arguments {
    int argc;
    char **argv;
    bool is(int i, const char *word) const
    {
        return argc > i && std::strcmp(argv[i], word) == 0;
    }
    const char *text(int i) const
    {
        return argc > i ? argv[i] : "";
    }
    std::uint64_t number(int i, std::uint64_t otherwise) const
    {
        return argc > i ? std::strtoull(argv[i], nullptr, 10) : otherwise;
    }
    double real(int i, double otherwise) const
    {
        return argc > i ? std::atof(argv[i]) : otherwise;
    }
    unsigned processes(int i) const
    {
        return static_cast<unsigned>(std::max<std::uint64_t>(1, number(i, std::thread::hardware_concurrency())));
    }
};

/** A single group, whatever time it takes. */
inline soak_options one_group(std::uint64_t first)
{
    return {1e-9, first, 1};
}

/**
 * --group FIRST, --seed NUMBER... by check_seed(number), which returns whether one exceeds a bound, or SECONDS with
 * [FIRST [PROCESSES [PERCENT]]] from argument `after` on. 2: wrong usage.
 */
template <class Harness, class CheckSeed>
int harness_main(const arguments &given, int after, const char *usage, const Harness &h, const CheckSeed &check_seed)
{
    if (given.is(1, "--seed") && given.argc >= 3) {
        int exceed = 0;
        for (int k = 2; k < given.argc; ++k) exceed += check_seed(given.number(k, 0));
        return exceed > 0;
    }
    if (given.is(1, "--group") && given.argc == 3) return h.run(one_group(given.number(2, 1)), -1);
    soak_options options;
    options.seconds = given.real(1, 0);
    if (!(options.seconds > 0) || given.argc > after + 3) {
        std::fprintf(stderr, "usage: %s %s\n", h.program, usage);
        return 2;
    }
    options.first = given.number(after, 1);
    options.workers = given.processes(after + 1);
    return h.run(options, given.real(after + 2, -1));
}

}  // namespace stress

#endif
