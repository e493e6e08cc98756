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
#include <cstdlib>
#include <cstring>
#include <string>
#include <thread>
#include <vector>

#include "case_file.hpp"
#include "checks.hpp"
#include "invariances.hpp"
#include "seam_features.hpp"
#include "soak.hpp"
#include "tally.hpp"

using namespace stress;

namespace
{

constexpr long double largest_excess = 3;

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

std::string exceeded_words(const verdict &v)
{
    std::string words;
    char text[64];
    for (int q = 0; q < N_QUANTITIES; ++q) {
        const long double x = v.ratio[static_cast<std::size_t>(q)];
        if (!(x > 1) || for_information(q)) continue;
        std::snprintf(text, sizeof text, " %s %.3Lg times its bound;", quantity_name(q), x);
        words += text;
    }
    return words;
}

void report(const checked_chain &x, const chain_group &group, const verdict &v, const std::string &directory)
{
    const std::string words = exceeded_words(v);
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
        for (std::size_t q = 0; q < v.ratio.size(); ++q) v.ratio[q] = std::max(v.ratio[q], verdicts[k].ratio[q]);
        sum.add(x.c, v);
        sum.singular += !x.exact.metric.regular;
        if (x.exact.metric.regular) sum.largest_condition = std::max(sum.largest_condition, x.exact.metric.condition);
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
    for (int q = 0; q < N_QUANTITIES; ++q)
        if (v.ratio[static_cast<std::size_t>(q)] >= 0)
            std::printf("%-14s %12.3Lg of its bound\n", quantity_name(q), v.ratio[static_cast<std::size_t>(q)]);
    return v.exceeded() ? 1 : status_of_undecided(v.ratio[UNDECIDED] > 0, 1);
}

/** longest 0: chains by features at seams, every `step`th of them round and round. */
int run(const soak_options &options, std::int64_t longest, const std::string &directory, double percent,
        std::uint64_t step = 1)
{
    const std::vector<std::string> sets = sets_of_kernels();
    shared_tallies<tally> tallies(options.workers, sets.size());
    std::vector<group_of_chains> batch;
    soak_work work;
    work.prepare = [&](std::uint64_t first) {
        if (longest > 0) batch.emplace_back(first, longest);
        for (std::uint64_t k = 0; longest == 0 && k < group_size && first + k < options.end; ++k)
            batch.emplace_back(make_seam_chain((first + k) * step % n_seam_chains()));
    };
    work.check = [&](unsigned worker, std::size_t set) {
        for (const group_of_chains &g : batch) check(g, directory, tallies.of(worker, set));
    };
    work.clear = [&] { batch.clear(); };
    const auto sum = [&] {
        tally all;
        for (const tally &t : tallies.of_all_sets()) all.add(t);
        return all;
    };
    work.progress = [&] {
        const tally all = sum();
        std::fprintf(stderr, "%lld chains, %lld above a bound, the largest error of lambda is %.2Lg of its bound\n",
                     static_cast<long long>(all.chains), static_cast<long long>(all.exceeded),
                     all.quantity[LAMBDA].worst);
    };
    work.repeat = longest > 0 ? "tests/stress/stress --group" : "tests/stress/stress --seams";
    const auto start = std::chrono::steady_clock::now();
    const int lost = soak(options, sets, work);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    print(sets, tallies.of_all_sets());
    const tally all = sum();
    std::printf("stress: %.0f chains an hour in %u processes, a chain counted for each set of kernels\n",
                3600 * static_cast<double>(all.chains) / seconds, options.workers);
    if (lost > 0) std::printf("stress: %d processes ended before their time\n", lost);
    const double allowed = percent < 0 ? 0 : percent / 100 * static_cast<double>(all.chains);
    if (lost > 0 || static_cast<double>(all.exceeded) > allowed || (percent >= 0 && all.worst() > largest_excess))
        return 1;
    return status_of_undecided(all.quantity[UNDECIDED].exceeded, all.chains);
}

}  // namespace

int main(int argc, char **argv)
{
    const auto integer = [&](int i, long long otherwise) { return argc > i ? std::atoll(argv[i]) : otherwise; };
    if (argc == 3 && std::strcmp(argv[1], "--case") == 0) return check_file(argv[2]);
    if (argc >= 3 && std::strcmp(argv[1], "--group") == 0)
        return run({1e-9, static_cast<std::uint64_t>(integer(2, 1)), 1}, std::max(1LL, integer(3, 2000)), "", -1);
    const auto processes = [&](int i) {
        return static_cast<unsigned>(
            std::max(1LL, integer(i, static_cast<long long>(std::thread::hardware_concurrency()))));
    };
    soak_options options;
    if (argc >= 2 && std::strcmp(argv[1], "--seams") == 0) {
        options.seconds = 1e9;
        options.first = static_cast<std::uint64_t>(integer(2, 0));
        options.end = argc > 3 ? options.first + static_cast<std::uint64_t>(integer(3, 0)) : n_seam_chains();
        options.workers = processes(4);
        return run(options, 0, "", -1, static_cast<std::uint64_t>(std::max(1LL, integer(5, 1))));
    }
    options.seconds = argc >= 2 ? std::atof(argv[1]) : 0;
    if (!(options.seconds > 0) || argc > 7) {
        std::fprintf(stderr,
                     "usage: stress SECONDS [DIRECTORY [FIRST [PROCESSES [LONGEST [PERCENT]]]]] | stress --group "
                     "FIRST [LONGEST] | stress --case FILE\n");
        return 2;
    }
    options.first = static_cast<std::uint64_t>(integer(3, 1));
    options.workers =
        static_cast<unsigned>(std::max(1LL, integer(4, static_cast<long long>(std::thread::hardware_concurrency()))));
    return run(options, std::max(1LL, integer(5, 2000)), argc >= 3 ? argv[2] : "", argc >= 7 ? std::atof(argv[6]) : -1);
}
