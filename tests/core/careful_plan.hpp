/**
 * @file careful_plan.hpp
 * A plan for the careful solver and its memory, with a canary behind what the two ask for.
 */
#ifndef CAREFUL_PLAN_HPP
#define CAREFUL_PLAN_HPP

#include "careful_case.hpp"
#include "core/kernels/careful/plan_of.hpp"
#include "core/kernels/careful/scratch.hpp"
#include "core/molecules/schedule.hpp"

namespace careful_case
{

struct planned {
    std::unique_ptr<const holonomic::Schedule> schedule;
    std::vector<double> memory;
    holonomic::CarefulPlan plan;
    double *scratch, *canary;

    explicit planned(const molecule &m)
        : schedule(holonomic::make_schedule(m.n_atoms, m.n_bonds, m.pairs.data(), nullptr))
    {
        std::int64_t more = 0;
        const std::int64_t bytes = holonomic::careful_scratch_bytes(*schedule, more) + more;
        const std::size_t size = static_cast<std::size_t>(bytes) / 8;
        memory.assign(size + 16, 12345.0);
        double *const first = memory.data() + (8 - reinterpret_cast<std::uintptr_t>(memory.data()) / 8 % 8) % 8;
        canary = first + size;
        holonomic::HOL_ISA::careful::Memory left = {reinterpret_cast<char *>(first)};
        plan = holonomic::HOL_ISA::careful::plan_of(*schedule, left);
        scratch = reinterpret_cast<double *>(left.next);
        const std::ptrdiff_t taken = left.next - reinterpret_cast<char *>(first);
        require(taken <= holonomic::careful_plan_bytes(*schedule), m.name, "the plan takes more than it says");
    }
    bool overrun() const
    {
        return *canary != 12345.0;
    }
};

}  // namespace careful_case

#endif
