// Molecules for which plain arithmetic in lanes can't answer, one by one by the careful solver.
#pragma once

#include "core/kernels/careful/careful.hpp"
#include "core/kernels/careful/plan_of.hpp"
#include "core/kernels/molecules/schedule.hpp"

namespace holonomic::HOL_ISA::graph {

inline void careful_one(const ForcesCall &call, const CarefulPlan &plan, const MoleculeLane &lane, double *scratch,
                        Tally &tally) {
    HOL_CAREFUL::careful::forces(call, plan, lane, scratch, tally);
}
inline void careful_one(const SolveCall &call, const CarefulPlan &plan, const MoleculeLane &lane, double *scratch,
                        Tally &tally) {
    HOL_CAREFUL::careful::solve(call, plan, lane, scratch, tally);
}
inline void careful_one(const VelocitiesCall &call, const CarefulPlan &plan, const MoleculeLane &lane, double *scratch,
                        Tally &tally) {
    HOL_CAREFUL::careful::velocities(call, plan, lane, scratch, tally);
}
inline void careful_one(const PositionsCall &call, const CarefulPlan &plan, const MoleculeLane &lane, double *scratch,
                        Tally &tally) {
    HOL_CAREFUL::careful::positions(call, plan, lane, scratch, tally);
}

// The lanes of `rest`; nothing of them has been written. `scratch` is what the block has left of its memory.
template <class Call>
HOL_NOINLINE void solve_doubtful(const Call &call, const Schedule &schedule, const MoleculeLane *lane, unsigned rest,
                                 double *scratch, Tally &tally) {
    double *const aligned = reinterpret_cast<double *>((reinterpret_cast<uintptr_t>(scratch) + 63) / 64 * 64);
    careful::Memory memory = {reinterpret_cast<char *>(aligned)};
    const CarefulPlan plan = careful::plan_of(*careful_order(schedule), memory);
    for (; rest; rest &= rest - 1)
        careful_one(call, plan, lane[__builtin_ctz(rest)], reinterpret_cast<double *>(memory.next), tally);
}

}  // namespace holonomic::HOL_ISA::graph
