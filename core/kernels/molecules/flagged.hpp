// Molecules for which plain arithmetic in lanes can't answer, one by one by the extended-precision solver.
#pragma once

#include "core/kernels/extended/plan_of.hpp"
#include "core/kernels/extended/verbs.hpp"
#include "core/plan/elimination.hpp"

namespace holonomic::HOL_ISA::graph {

inline void extended_one(const ForcesCall &call, const ExtendedPlan &plan, const MoleculeLane &lane, double *scratch,
                         Tally &tally) {
    HOL_EXTENDED::extended::forces(call, plan, lane, scratch, tally);
}
inline void extended_one(const SolveCall &call, const ExtendedPlan &plan, const MoleculeLane &lane, double *scratch,
                         Tally &tally) {
    HOL_EXTENDED::extended::solve(call, plan, lane, scratch, tally);
}
inline void extended_one(const VelocitiesCall &call, const ExtendedPlan &plan, const MoleculeLane &lane,
                         double *scratch, Tally &tally) {
    HOL_EXTENDED::extended::velocities(call, plan, lane, scratch, tally);
}
inline void extended_one(const PositionsCall &call, const ExtendedPlan &plan, const MoleculeLane &lane, double *scratch,
                         Tally &tally) {
    HOL_EXTENDED::extended::positions(call, plan, lane, scratch, tally);
}

// The lanes of `rest`; nothing of them has been written. `scratch` is what the block has left of its memory.
template <class Call>
HOL_NOINLINE void solve_flagged(const Call &call, const EliminationPlan &elimination, const MoleculeLane *lane,
                                unsigned rest, double *scratch, Tally &tally) {
    double *const aligned = reinterpret_cast<double *>((reinterpret_cast<uintptr_t>(scratch) + 63) / 64 * 64);
    extended::ByteArena memory = {reinterpret_cast<char *>(aligned)};
    const ExtendedPlan plan = extended::plan_of(*extended_order(elimination), memory);
    for (; rest; rest &= rest - 1)
        extended_one(call, plan, lane[__builtin_ctz(rest)], reinterpret_cast<double *>(memory.next), tally);
}

}  // namespace holonomic::HOL_ISA::graph
