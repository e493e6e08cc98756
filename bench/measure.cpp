#include "measure.hpp"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "memory_pass.hpp"
#include "stopwatch.hpp"

namespace bench {
namespace {

double seconds_of(const Method &m, State &s, const Scene &p, Level level) {
    s.restore(p, level);
    if (m.before) m.before(s);
    const Stopwatch watch(m.threads);
    m.call(s);
    const double seconds = watch.seconds();
    if (m.after) m.after(s);
    return seconds;
}

/// Collects the time per iteration of each repetition, by name.
class Collector : public benchmark::BenchmarkReporter {
public:
    std::map<std::string, std::vector<double>> seconds;
    bool ReportContext(const Context &) override { return true; }
    void ReportRuns(const std::vector<Run> &runs) override {
        for (const Run &run : runs)
            if (run.run_type == Run::RT_Iteration && run.iterations > 0)
                seconds[run.run_name.function_name].push_back(run.real_accumulated_time /
                                                              static_cast<double>(run.iterations));
    }
};

double quantile(const std::vector<double> &sorted, double part) {
    const double place = part * static_cast<double>(sorted.size() - 1);
    const auto low = static_cast<std::size_t>(place);
    const std::size_t high = std::min(low + 1, sorted.size() - 1);
    return sorted[low] + (place - static_cast<double>(low)) * (sorted[high] - sorted[low]);
}

Method pass_method(const Scene &p, int threads) {
    Method m;
    m.name = "memory pass";
    m.threads = threads;
    m.call = [&p, threads](State &s) { memory_pass(p.r, p.v, p.f, s.g, threads); };
    return m;
}

/// The calls of one repetition, timed; restoring inputs between them is not. Where nothing is restored the clock is
/// read once for all. A repetition ends early if calls take far longer than the first ones did, as when threads have to
/// wait for a core that another program holds: the rest of its iterations then do nothing.
void repeat(benchmark::State &b, const Method &m, const Scene &p, Level level, State &state, double seconds_at_most) {
    const bool restores = m.before || m.after || level == Level::position || level == Level::velocity;
    double seconds = 0;
    int calls = 0;
    bool late = false;
    const Stopwatch elapsed(2), watch(m.threads);
    for (auto _ : b) {
        if (late) continue;
        if (restores) {
            seconds += seconds_of(m, state, p, level);
        } else {
            m.call(state);
            benchmark::ClobberMemory();
        }
        late = ++calls % 8 == 0 && elapsed.seconds() > seconds_at_most;
        if (late && !restores) seconds = watch.seconds();
    }
    if (!late && !restores) seconds = watch.seconds();
    b.SetIterationTime(seconds / calls * static_cast<double>(b.iterations()));
}

/// A repetition is so many calls that it takes the time asked for.
void register_method(const std::string &name, const Method &m, const Scene &p, Level level, State &state,
                     double seconds_per_call, const Effort &effort) {
    const double calls = std::ceil(effort.seconds / std::max(seconds_per_call, 1e-9));
    const bool slow = seconds_per_call > effort.slow_seconds;
    const double most = std::max(6 * effort.seconds, 4 * seconds_per_call);
    auto *made = benchmark::RegisterBenchmark(
        name.c_str(), [&m, &p, level, &state, most](benchmark::State &b) { repeat(b, m, p, level, state, most); });
    made->UseManualTime();
    made->Iterations(static_cast<std::int64_t>(std::clamp(calls, 1.0, 1e7)))
        ->Repetitions(slow ? std::min(3, effort.repetitions) : effort.repetitions);
}

/// So that what a method leaves unwritten is not taken for an answer of its own.
void spoil(State &s) {
    for (std::vector<double> *x : {&s.lambda, &s.g, &s.log_det})
        std::fill(x->begin(), x->end(), std::numeric_limits<double>::quiet_NaN());
}

}  // namespace

void start_measuring() {
    char program[] = "bench", interleave[] = "--benchmark_enable_random_interleaving=true";
    char *arguments[] = {program, interleave, nullptr};
    int count = 2;
    benchmark::Initialize(&count, arguments);
}

std::vector<Row> measure(Level level, const Scene &p, const Methods &methods, const Effort &effort,
                         const ErrorOf &error_of) {
    State state(p, level);
    Methods all = methods;
    std::set<int> thread_counts;
    for (const Method &m : methods) thread_counts.insert(m.threads);
    for (int threads : thread_counts) all.push_back(pass_method(p, threads));

    std::vector<double> errors;
    benchmark::ClearRegisteredBenchmarks();
    for (std::size_t i = 0; i < all.size(); ++i) {
        // Once for the error, and to warm up; the second time tells how long a call takes, unless the first was long
        // enough.
        spoil(state);
        double seconds = seconds_of(all[i], state, p, level);
        if (all[i].for_error) {
            state.restore(p, level);
            all[i].for_error(state);
        }
        if (i >= methods.size())
            errors.push_back(0);
        else
            errors.push_back(all[i].own_error ? all[i].own_error() : error_of(state, all[i].part_done));
        if (seconds < effort.slow_seconds) seconds = seconds_of(all[i], state, p, level);
        register_method(std::to_string(i), all[i], p, level, state, seconds, effort);
    }
    Collector collector;
    benchmark::RunSpecifiedBenchmarks(&collector);

    auto per_bond = [&](std::size_t i) {
        std::vector<double> times = collector.seconds.at(std::to_string(i));
        const std::size_t bonds = all[i].bonds_worked > 0 ? all[i].bonds_worked : p.all_bonds();
        for (double &t : times) t *= 1e9 / static_cast<double>(bonds);
        std::sort(times.begin(), times.end());
        return times;
    };
    std::map<int, double> pass;
    for (std::size_t i = methods.size(); i < all.size(); ++i) pass[all[i].threads] = quantile(per_bond(i), 0.5);
    std::vector<Row> rows;
    for (std::size_t i = 0; i < methods.size(); ++i) {
        const Method &m = methods[i];
        const std::vector<double> times = per_bond(i);
        const double median = quantile(times, 0.5);
        rows.push_back({level_name(level), p.name, p.chains_per_call(), p.bonds, m.threads, m.name, m.setting,
                        errors[i], median, median / pass[m.threads], times.front(), quantile(times, 0.25),
                        quantile(times, 0.75), times.back(), static_cast<int>(times.size())});
    }
    return rows;
}

}  // namespace bench
