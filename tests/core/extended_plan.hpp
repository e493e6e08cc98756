/**
 * @file extended_plan.hpp
 * A plan for the extended-precision solver and its memory, with a canary behind what the two ask for.
 */
#ifndef EXTENDED_PLAN_HPP
#define EXTENDED_PLAN_HPP

#include "core/kernels/extended/plan_of.hpp"
#include "core/kernels/extended/scratch.hpp"
#include "core/molecules/planned/elimination_plan.hpp"
#include "extended_case.hpp"

namespace extended_case
{

struct planned {
    std::unique_ptr<const holonomic::EliminationPlan> elimination;
    std::vector<double> memory;
    holonomic::ExtendedPlan plan;
    double *scratch, *canary;

    explicit planned(const molecule &m)
        : elimination(holonomic::make_elimination_plan(m.n_atoms, m.n_bonds, m.pairs.data(), nullptr))
    {
        std::int64_t more = 0;
        const std::int64_t bytes = holonomic::extended_scratch_bytes(*elimination, more) + more;
        const std::size_t size = static_cast<std::size_t>(bytes) / 8;
        memory.assign(size + 16, 12345.0);
        double *const first = memory.data() + (8 - reinterpret_cast<std::uintptr_t>(memory.data()) / 8 % 8) % 8;
        canary = first + size;
        holonomic::HOL_ISA::extended::ByteArena left = {reinterpret_cast<char *>(first)};
        plan = holonomic::HOL_ISA::extended::plan_of(*elimination, left);
        scratch = reinterpret_cast<double *>(left.next);
        const std::ptrdiff_t taken = left.next - reinterpret_cast<char *>(first);
        require(taken <= holonomic::extended_plan_bytes(*elimination), m.name, "the plan takes more than it says");
    }
    bool overrun() const
    {
        return *canary != 12345.0;
    }
};

}  // namespace extended_case

#endif
