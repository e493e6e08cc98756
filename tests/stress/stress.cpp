/**
 * Hostile chains against the reference solution for a given time:
 *     stress SECONDS [DIRECTORY [FIRST [THREADS [LONGEST [PERCENT]]]]]
 *         chains from number FIRST on, of at most LONGEST bonds; those that exceed a bound go to DIRECTORY. PERCENT of
 *         them may exceed one, by a factor of three at most: for a test that guards what docs/stability.md says
 *     stress --case FILE
 *         one file in the format of tests/oracle
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

#include "case_file.hpp"
#include "checks.hpp"
#include "invariances.hpp"
#include "tally.hpp"

using namespace stress;

namespace
{

std::int64_t longest = 2000;
constexpr std::uint64_t group_size = 8;
constexpr int most_files = 1000;  // the disk stays free
constexpr long double largest_excess = 3;

using clock_type = std::chrono::steady_clock;

struct run {
    double seconds;
    std::string directory;
    clock_type::time_point start = clock_type::now();
    std::atomic<std::uint64_t> next;
    std::atomic<int> files{0};
    std::mutex lock;
    tally total;  // under the lock

    double elapsed() const
    {
        return std::chrono::duration<double>(clock_type::now() - start).count();
    }
};

std::string exceeded_words(const verdict &v)
{
    std::string words = "exceeds:";
    char text[64];
    for (int q = 0; q < N_QUANTITIES; ++q) {
        const long double x = v.ratio[static_cast<std::size_t>(q)];
        if (!(x > 1) || for_information(q)) continue;
        std::snprintf(text, sizeof text, " %s %.3Lg times its bound;", quantity_name(q), x);
        words += text;
    }
    return words;
}

void keep(run &all, const hostile_chain &c, const std::string &name, const chain_group &group, const verdict &v)
{
    if (!v.exceeded() || all.directory.empty()) return;
    if (all.files.fetch_add(1) >= most_files || !write_case(all.directory, name, exceeded_words(v), group, c))
        std::fprintf(stderr, "stress: no file for %s: there are %d already, it is singular, or %s can't be written\n",
                     name.c_str(), most_files, all.directory.c_str());
}

void check_one(run &all, const hostile_chain &c, verdict v, const std::string &name, const chain_group &group,
               tally &sum)
{
    bool regular = true;
    long double condition = 0;
    const verdict alone = check_alone(c, regular, condition);
    for (std::size_t q = 0; q < v.ratio.size(); ++q) v.ratio[q] = std::max(v.ratio[q], alone.ratio[q]);
    sum.add(c, v);
    sum.singular += !regular;
    if (regular) sum.largest_condition = std::max(sum.largest_condition, condition);
    keep(all, c, name, group, v);
}

std::vector<hostile_chain> chains_of(const chain_group &group)
{
    std::vector<hostile_chain> chains;
    for (std::uint64_t k = 0; k < group.size; ++k) chains.push_back(make_hostile_chain(group.first + k, group.longest));
    return chains;
}

void check_group(run &all, std::uint64_t first)
{
    tally sum;
    random_stream stream = random_seed(first);
    const std::int64_t size = random_integer(&stream, 1, static_cast<std::int64_t>(group_size));
    const chain_group group{first, static_cast<std::uint64_t>(size), longest}, none{0, 0, 0};
    const std::vector<hostile_chain> chains = chains_of(group);
    std::vector<verdict> verdicts(chains.size());
    check_invariances(chains, first + 1, verdicts);
    for (std::size_t k = 0; k < chains.size(); ++k)
        check_one(all, chains[k], verdicts[k], "chain_" + std::to_string(chains[k].seed), group, sum);
    check_one(all, reversed(chains[0]), verdict(), "reversed_" + std::to_string(chains[0].seed), none, sum);
    check_one(all, turned(chains[0]), verdict(), "turned_" + std::to_string(chains[0].seed), none, sum);
    const std::lock_guard<std::mutex> guard(all.lock);
    all.total.add(sum);
}

void work(run &all)
{
    do {
        check_group(all, all.next.fetch_add(group_size));
    } while (all.elapsed() < all.seconds);
}

void show_progress(run &all, const std::atomic<bool> &done)
{
    for (int tick = 0; !done; ++tick) {
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
        if (tick % 100 != 99) continue;
        const std::lock_guard<std::mutex> guard(all.lock);
        std::fprintf(
            stderr,
            "%6.0f of %.0f s: %lld chains, %lld exceed a bound, the largest error of lambda is %.2Lg of its bound\n",
            all.elapsed(), all.seconds, static_cast<long long>(all.total.chains),
            static_cast<long long>(all.total.exceeded), all.total.quantity[LAMBDA].worst);
    }
}

int check_file(const char *path)
{
    chain_group group;
    const hostile_chain c = read_case(path, group);
    bool regular;
    long double condition;
    verdict v = check_alone(c, regular, condition);
    std::vector<hostile_chain> chains = chains_of(group);  // what it was computed together with
    const auto here =
        std::find_if(chains.begin(), chains.end(), [&](const hostile_chain &x) { return x.seed == c.seed; });
    const std::size_t place = here == chains.end() ? 0 : static_cast<std::size_t>(here - chains.begin());
    if (here == chains.end()) chains = {c};
    chains[place] = c;
    std::vector<verdict> same(chains.size());
    check_invariances(chains, group.first + 1, same);
    v.note(SAME_BITS, same[place].ratio[SAME_BITS]);
    v.note(OUTPUTS_KEPT, same[place].ratio[OUTPUTS_KEPT]);
    std::printf("%s: %lld bonds, condition number %.2Le\n", path, static_cast<long long>(c.n_bonds), condition);
    for (int q = 0; q < N_QUANTITIES; ++q)
        if (v.ratio[static_cast<std::size_t>(q)] >= 0)
            std::printf("%-14s %12.3Lg of its bound\n", quantity_name(q), v.ratio[static_cast<std::size_t>(q)]);
    return v.exceeded();
}

}  // namespace

int main(int argc, char **argv)
{
    if (argc == 3 && std::strcmp(argv[1], "--case") == 0) return check_file(argv[2]);
    const double seconds = argc >= 2 ? std::atof(argv[1]) : 0;
    if (!(seconds > 0) || argc > 7) {
        std::fprintf(stderr,
                     "usage: stress SECONDS [DIRECTORY [FIRST [THREADS [LONGEST [PERCENT]]]]] | stress --case FILE\n");
        return 2;
    }
    run all;
    all.seconds = seconds;
    if (argc >= 3) all.directory = argv[2];
    all.next = argc >= 4 ? std::strtoull(argv[3], nullptr, 10) : 1;
    const unsigned n_threads = argc >= 5 ? static_cast<unsigned>(std::max(1, std::atoi(argv[4])))
                                         : std::max(1u, std::thread::hardware_concurrency());
    if (argc >= 6) longest = std::max(1, std::atoi(argv[5]));
    std::vector<std::thread> threads;
    std::atomic<bool> done{false};
    std::thread progress(show_progress, std::ref(all), std::cref(done));
    for (unsigned t = 0; t < n_threads; ++t) threads.emplace_back(work, std::ref(all));
    for (std::thread &t : threads) t.join();
    done = true;
    progress.join();
    all.total.print();
    std::printf("stress: %.0f chains an hour on %u threads, instruction set %s\n",
                3600 * static_cast<double>(all.total.chains) / all.elapsed(), n_threads, hol_instruction_set());
    if (argc < 7) return all.total.exceeded > 0;
    if (all.total.worst() > largest_excess) return 1;
    return static_cast<double>(all.total.exceeded) > std::atof(argv[6]) / 100 * static_cast<double>(all.total.chains);
}
