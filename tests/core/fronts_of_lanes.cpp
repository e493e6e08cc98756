// Compiled once per number of lanes, with HOL_LANES and HOL_ISA as a set of kernels is.
#include "fronts_case.hpp"

#include <atomic>
#include <thread>

#include "core/kernels/molecules/network/fronts.hpp"

namespace fronts_case
{
namespace HOL_ISA
{

using namespace holonomic::HOL_ISA;
using namespace holonomic::HOL_ISA::graph;

// Threads of our own, each with its memory: what is shared out goes to any of them.
struct Threads {
    std::vector<std::vector<double>> memory;
    static void run(const void *self, std::int64_t n, holonomic::Tally &,
                    void (*body)(const void *, std::int64_t, double *, holonomic::Tally &), const void *context)
    {
        std::atomic<std::int64_t> next{0};
        std::vector<std::thread> all;
        for (const std::vector<double> &own : static_cast<const Threads *>(self)->memory)
            all.emplace_back([&next, n, body, context, buffer = const_cast<double *>(own.data())] {
                holonomic::Tally unused = holonomic::empty_tally();
                for (std::int64_t i; (i = next++) < n;) body(context, i, buffer, unused);
            });
        for (std::thread &one : all) one.join();
    }
};

bool solve(const holonomic::NetworkPlan &s, bool symmetric, const Terms &terms, double least_part, int n_threads,
           std::vector<double> &x)
{
    const holonomic::FrontPlan &plan = s.fronts;
    std::vector<double> owned(static_cast<std::size_t>(Fronts::values(plan, symmetric)) + 8, 0x1p1000),
        buffer(static_cast<std::size_t>(Fronts::values_of_buffer(plan)), 0x1p1000);
    const Threads threads = {std::vector<std::vector<double>>(static_cast<std::size_t>(n_threads), buffer)};
    const holonomic::LongTeam team = {&threads, Threads::run};
    Memory<double> memory = {owned.data()};
    const Fronts fronts(plan, symmetric, n_threads > 0 ? &team : nullptr, buffer.data(), memory, memory);
    if (memory.next - owned.data() != Fronts::values(plan, symmetric)) return false;
    const bool good = fronts.factorize(
        least_part,
        [&](const holonomic::FrontPlan::Front &front, const Dense &a) {
            for (std::int32_t i = front.first_node; i < front.end_node; ++i)
                for (const Term &t : terms.of_node[static_cast<std::size_t>(plan.node[i])])
                    if (t.row >= t.column || !symmetric) Fronts::element(front, a, t.row, t.column) += t.value;
        },
        [&](std::int32_t u) { return terms.diagonal[static_cast<std::size_t>(u)]; });
    if (good) fronts.solve(x.data());
    return good;
}

}  // namespace HOL_ISA
}  // namespace fronts_case
