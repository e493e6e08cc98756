// Compiled once per number of lanes, with HOL_LANES and HOL_ISA as a set of kernels is.
#include "fronts_case.hpp"

#include "core/kernels/molecules/network/fronts.hpp"

namespace fronts_case
{
namespace HOL_ISA
{

using namespace holonomic::HOL_ISA;
using namespace holonomic::HOL_ISA::graph;

bool solve(const holonomic::NetworkPlan &s, bool symmetric, const Terms &terms, double least_part,
           std::vector<double> &x)
{
    const holonomic::FrontPlan &plan = s.fronts;
    std::vector<double> owned(static_cast<std::size_t>(Fronts::values(plan, symmetric)) + 8, 0x1p1000),
        buffer(static_cast<std::size_t>(Fronts::values_of_buffer(plan)) + 8, 0x1p1000);
    Memory<double> memory = {owned.data()};
    const Fronts fronts(plan, symmetric, nullptr, buffer.data(), memory);
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
