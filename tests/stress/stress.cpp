/**
 * Hostile chains against the reference solution for a given time, with every set of kernels that runs here or with that
 * which HOLONOMIC_ISA names:
 *     stress SECONDS [DIRECTORY [FIRST [PROCESSES [LONGEST [PERCENT]]]]]
 *         chains from number FIRST on, of at most LONGEST bonds; those that exceed a bound go to DIRECTORY. PERCENT of
 *         them may exceed one, by a factor of three at most: for a test that guards what docs/stability.md says
 *     stress --group FIRST [LONGEST]
 *         the group that begins with number FIRST
 *     stress --seams [FIRST COUNT [PROCESSES [STEP]]]
 *         chains with what is hard exactly at the places where the kernels cut them, and beside these
 *         (seam_features.hpp)
 *     stress --case FILE
 *         one file in the format of tests/oracle
 * Exit status 0: everything within its bounds; 1: something is not; 2: wrong usage; 77: nothing is wrong, but without
 * MPFR the reference does not decide about all chains.
 */
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <string>
#include <vector>

#include "case_file.hpp"
#include "checks.hpp"
#include "harness.hpp"
#include "invariances.hpp"
#include "seam_features.hpp"

using namespace stress;

namespace
{

/** A chain on its own, with what it is compared with. */
struct checked_chain {
    hostile_chain c;
    chain_reference exact;
    std::string name;
    explicit checked_chain(const hostile_chain &chain, const char *kind)
        : c(chain), exact(chain), name(kind + std::to_string(chain.seed))
    {
    }
};

/** Chains are one class; their features are counted besides. */
struct tally : tally_of<quantity> {
    std::array<std::int64_t, n_features> with_feature{}, exceeded_with_feature{};

    void add(const checked_chain &x, const verdict &v)
    {
        const auto &metric = x.exact.metric;
        tally_of<quantity>::add(0, {x.c.n_bonds, x.c.seed, metric.regular, true, metric.condition}, v);
        for (std::size_t bit = 0; bit < n_features; ++bit) {
            if (!(x.c.features >> bit & 1u)) continue;
            ++with_feature[bit];
            exceeded_with_feature[bit] += v.exceeded();
        }
    }
    void add(const tally &other)
    {
        tally_of<quantity>::add(other);
        for (std::size_t bit = 0; bit < n_features; ++bit) {
            with_feature[bit] += other.with_feature[bit];
            exceeded_with_feature[bit] += other.exceeded_with_feature[bit];
        }
    }
};

/** Chains that are computed together, each of them alone, and the first reversed and turned. */
struct group_of_chains {
    chain_group group;
    std::vector<checked_chain> chains;

    group_of_chains(std::uint64_t first, std::int64_t longest)
    {
        random_stream stream = random_seed(first);
        const std::int64_t size = random_integer(&stream, 1, static_cast<std::int64_t>(group_size));
        group = {first, static_cast<std::uint64_t>(size), longest};
        for (std::uint64_t k = 0; k < group.size; ++k)
            chains.emplace_back(make_hostile_chain(first + k, longest), "chain_");
        const hostile_chain c = chains[0].c;
        chains.emplace_back(reversed(c), "reversed_");
        chains.emplace_back(turned(c), "turned_");
    }
    /** One chain by itself, some of them in other layouts, too. */
    explicit group_of_chains(const hostile_chain &c) : group{c.seed, c.seed % 4 == 0 ? 1u : 0u, 0}
    {
        chains.emplace_back(c, "seam_");
    }
    std::vector<hostile_chain> together() const
    {
        std::vector<hostile_chain> out;
        for (std::uint64_t k = 0; k < group.size; ++k) out.push_back(chains[k].c);
        return out;
    }
};

void report(const checked_chain &x, const chain_group &group, const verdict &v, const std::string &directory)
{
    const std::string words = v.words();
    const bool seam = group.longest == 0;
    std::printf(
        "%s%s%s, %lld bonds, condition number %.1Le:%s repeat with HOLONOMIC_ISA=%s tests/stress/stress %s %llu "
        "%lld\n",
        x.name.c_str(), seam ? ", " : "", seam ? words_of_seam_chain(x.c.seed).c_str() : "",
        static_cast<long long>(x.c.n_bonds), x.exact.metric.condition, words.c_str(), hol_instruction_set(),
        seam ? "--seams" : "--group", static_cast<unsigned long long>(group.first),
        seam ? 1 : static_cast<long long>(group.longest));
    if (!directory.empty() && !write_case(directory, x.name, "exceeds:" + words, group, x.c))
        std::printf("no file for %s: it is there, it is singular, or %s can't be written\n", x.name.c_str(),
                    directory.c_str());
}

void check(const group_of_chains &g, const std::string &directory, tally &sum)
{
    std::vector<verdict> verdicts(g.chains.size());
    if (g.group.size > 0) check_invariances(g.together(), g.group.first + 1, verdicts);
    for (std::size_t k = 0; k < g.chains.size(); ++k) {
        const checked_chain &x = g.chains[k];
        verdict v = check_alone(x.c, x.exact);
        v.add(verdicts[k]);
        sum.add(x, v);
        if (v.exceeded()) report(x, g.group, v, directory);
    }
}

int check_file(const char *path)
{
    chain_group group;
    const hostile_chain c = read_case(path, group);
    const chain_reference exact(c);
    verdict v = check_alone(c, exact);
    std::vector<hostile_chain> chains;  // what it was computed together with
    for (std::uint64_t k = 0; k < group.size; ++k) chains.push_back(make_hostile_chain(group.first + k, group.longest));
    const auto here =
        std::find_if(chains.begin(), chains.end(), [&](const hostile_chain &x) { return x.seed == c.seed; });
    const std::size_t place = here == chains.end() ? 0 : static_cast<std::size_t>(here - chains.begin());
    if (here == chains.end()) chains = {c};
    chains[place] = c;
    std::vector<verdict> same(chains.size());
    check_invariances(chains, group.first + 1, same);
    v.note(SAME_BITS, same[place].ratio[SAME_BITS]);
    v.note(OUTPUTS_KEPT, same[place].ratio[OUTPUTS_KEPT]);
    std::printf("%s: %lld bonds, condition number %.2Le\n", path, static_cast<long long>(c.n_bonds),
                exact.metric.condition);
    v.print();
    return v.exceeded() ? 1 : status_of_undecided(v.ratio[UNDECIDED] > 0, 1);
}

const char *chains_name(int)
{
    return "chains";
}
constexpr class_names chains{chains_name, 1, "chain"};

void write_chains(const std::vector<std::string> &sets, const std::vector<tally> &of_set)
{
    const markdown_table table(sets);
    if (!table.out) return;
    table.row("chains", [&](std::size_t s) { return std::to_string(of_set[s].classes[0].cases); });
    table.row("above a bound", [&](std::size_t s) { return std::to_string(of_set[s].classes[0].exceeded); });
    table.row("lambda above K alone",
              [&](std::size_t s) { return std::to_string(of_set[s].classes[0].quantity[LAMBDA_NEAR].exceeded); });
    for (std::size_t q = 0; q < N_QUANTITIES; ++q)
        if ((!tally::for_information(q) || q == LAMBDA_NEAR) && of_set[0].classes[0].quantity[q].checked > 0)
            table.row(tally::name(q),
                      [&](std::size_t s) { return table.number(of_set[s].classes[0].quantity[q].worst); });
}

void print(const std::vector<std::string> &sets, const std::vector<tally> &of_set)
{
    print_tables(chains, sets, of_set);
    write_chains(sets, of_set);
    tally all;
    for (const tally &t : of_set) all.add(t);
    std::printf("\n%-20s %10s %10s\n", "chains with", "checked", "exceeded");
    for (std::size_t bit = 0; bit < n_features; ++bit)
        std::printf("%-20s %10lld %10lld\n", feature_name(static_cast<int>(bit)),
                    static_cast<long long>(all.with_feature[bit]),
                    static_cast<long long>(all.exceeded_with_feature[bit]));
    print_sums(chains, sets, of_set);
    std::printf("stress: %lld chains, %lld exceed a bound\n", static_cast<long long>(all.all().cases),
                static_cast<long long>(all.all().exceeded));
}

/** longest 0: chains by features at seams, every `step`th of them round and round. */
int run(const soak_options &options, std::int64_t longest, const std::string &directory, double percent,
        std::uint64_t step = 1)
{
    using groups = std::vector<group_of_chains>;
    const harness<groups, tally> h{"stress",
                                   longest > 0 ? "--group" : "--seams",
                                   chains,
                                   [&](std::uint64_t first) {
                                       groups all;
                                       if (longest > 0) all.emplace_back(first, longest);
                                       for (std::uint64_t k = 0;
                                            longest == 0 && k < group_size && first + k < options.end; ++k)
                                           all.emplace_back(make_seam_chain((first + k) * step % n_seam_chains()));
                                       return all;
                                   },
                                   [&](const groups &all, tally &sum) {
                                       for (const group_of_chains &g : all) check(g, directory, sum);
                                   },
                                   print};
    const auto start = std::chrono::steady_clock::now();
    bool complete = false;
    tally all;  // chains of all sets together
    for (const tally &t : h.run(options, complete)) all.add(t);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    std::printf("stress: %.0f chains an hour in %u processes, a chain counted for each set of kernels\n",
                3600 * static_cast<double>(all.all().cases) / seconds, options.workers);
    return complete && h.is_within(all, percent)
               ? status_of_undecided(all.classes[0].quantity[UNDECIDED].exceeded, all.all().cases)
               : 1;
}

}  // namespace

int main(int argc, char **argv)
{
    const arguments given{argc, argv};
    const auto longest = [&](int i) {
        return static_cast<std::int64_t>(std::max<std::uint64_t>(1, given.number(i, 2000)));
    };
    if (argc == 3 && given.is(1, "--case")) return check_file(argv[2]);
    if (argc >= 3 && given.is(1, "--group")) return run(one_group(given.number(2, 1)), longest(3), "", -1);
    soak_options options;
    if (given.is(1, "--seams")) {
        options.seconds = 1e9;
        options.first = given.number(2, 0);
        options.end = argc > 3 ? options.first + given.number(3, 0) : n_seam_chains();
        options.workers = given.processes(4);
        return run(options, 0, "", -1, std::max<std::uint64_t>(1, given.number(5, 1)));
    }
    options.seconds = given.real(1, 0);
    if (!(options.seconds > 0) || argc > 7) {
        std::fprintf(stderr,
                     "usage: stress SECONDS [DIRECTORY [FIRST [PROCESSES [LONGEST [PERCENT]]]]] | stress --group "
                     "FIRST [LONGEST] | stress --case FILE\n");
        return 2;
    }
    options.first = given.number(3, 1);
    options.workers = given.processes(4);
    return run(options, longest(5), given.text(2), given.real(6, -1));
}
