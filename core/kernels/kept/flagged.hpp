// Molecules that kept factors do not answer for.
#pragma once

#include "core/kernels/molecules/flagged.hpp"
#include "core/kernels/tally.hpp"

namespace holonomic::HOL_ISA::graph {

// To the ordinary verbs: lanes of `which`.
HOL_NOINLINE void leave(const MoleculeLane *lane, unsigned which, unsigned char *left) {
    for (; which; which &= which - 1) left[lane[__builtin_ctz(which)].molecule] = 1;
}

// Molecules that are kept, but one of whose bonds is cancelling, are solved in twice the precision. What it does not
// answer for is left.
HOL_NOINLINE void solve_extended(const KeptCall &call, const EliminationPlan &s, const MoleculeLane *lane,
                                 unsigned which, double *memory, Tally &tally) {
    for (; which; which &= which - 1) {
        const unsigned of = which & -which;
        Tally one = empty_tally();
        if (call.rhs)
            solve_flagged(SolveCall{call.kept->r, call.g, call.rhs, call.lambda, call.tension, call.add, call.virial,
                                    *call.kept->box},
                          s, lane, of, memory, one);
        else
            solve_flagged(ForcesCall{call.kept->r, call.v, call.f, call.g, call.lambda, call.tension, call.add,
                                     call.virial, *call.kept->box},
                          s, lane, of, memory, one);
        if (one.n_bad > 0)
            leave(lane, of, call.left);
        else
            add(tally, one);
    }
}

}  // namespace holonomic::HOL_ISA::graph
