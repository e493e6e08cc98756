// The linear levels of molecules that are no chains, once over all ways: constraint forces, multipliers for given
// right-hand sides, velocities (theory (8), (12)): which right-hand sides, solve, write, or leave to extended
// arithmetic. A way gives what differs, for one molecule or those in the lanes of a block:
//   unsigned in_use()                    its lanes
//   unsigned solve()                     reads and solves; the lanes that this answers for
//   write(out, which, tally)             outputs of a solution
//   project(out, twice, which, tally)    the same of velocities, which are `out.g`: v_i += w_i G_i. Twice: once more,
//                                        with the rates of the velocities as they are rounded, which leaves
//                                        d . (v_j - v_i) at their rounding
#pragma once

#include "core/kernels/memory/prefetch.hpp"
#include "core/kernels/molecules/load.hpp"
#include "core/kernels/molecules/store.hpp"

namespace holonomic::HOL_ISA::graph {

// The right-hand sides of a call, and of which terms they are made.
struct RightHandSides {
    Inputs in;
    int terms;
};
HOL_INLINE RightHandSides right_hand_sides_of(const ForcesCall &call) {
    return {{&call.v, &call.f, nullptr, false}, (call.v.x ? squares : 0) | (call.f.x ? pulls : 0)};
}
HOL_INLINE RightHandSides right_hand_sides_of(const SolveCall &call) {
    return {{nullptr, nullptr, call.rhs, false}, given};
}
HOL_INLINE RightHandSides right_hand_sides_of(const KeptCall &call) {
    return {{call.v.x ? &call.v : nullptr, call.f.x ? &call.f : nullptr, call.rhs, false},
            call.rhs ? given : (call.v.x ? squares : 0) | (call.f.x ? pulls : 0)};
}
HOL_INLINE RightHandSides right_hand_sides_of(const VelocitiesCall &call) {
    return {{&call.v, nullptr, nullptr, true, call.strain}, rates};
}
// Velocities in single precision have no use for a second solve.
HOL_INLINE bool solved_twice(const Inputs &in) { return in.rates && !in.v->is_float; }

// Whether all of a call's arrays that there are.
template <class... Arrays>
HOL_INLINE bool are_packed(const Arrays &...array) {
    return (... && (!array.x || array.packed));
}
HOL_INLINE bool are_packed(const ForcesCall &call) { return are_packed(call.r, call.v, call.f, call.g); }
HOL_INLINE bool are_packed(const SolveCall &call) { return are_packed(call.r, call.g); }
HOL_INLINE bool are_packed(const VelocitiesCall &call) { return are_packed(call.r, call.v); }

// What the next molecules are read from.
HOL_INLINE NextMolecules next_of(const ForcesCall &call) {
    return NextMolecules({&call.r, &call.v, &call.f, &call.g}, call.lambda);
}
HOL_INLINE NextMolecules next_of(const SolveCall &call) { return NextMolecules({&call.r, &call.g}, call.lambda); }
HOL_INLINE NextMolecules next_of(const VelocitiesCall &call) { return NextMolecules({&call.r, &call.v}, call.lambda); }

template <class Call>
HOL_INLINE LinearOutputs outputs_of(const Call &call) {
    return {&call.g, call.lambda, call.tension, call.add, call.virial};
}
HOL_INLINE LinearOutputs outputs_of(const VelocitiesCall &call) {
    return {&call.v, call.lambda, nullptr, true, call.virial};
}

// Writes what the lanes in `which` have of a solution. Range: of bonds and atoms, or none for all of them.
template <class Way, class... Range>
HOL_INLINE void write_bonds_and_pulls(Way &x, const LinearOutputs &out, unsigned which, const Range &...range) {
    if (out.lambda) x.template write_bonds<false>(range..., 0.5, out.lambda, which);
    if (out.tension) x.template write_bonds<true>(range..., 1, out.tension, which);
    if (out.g && out.g->x) x.write_pulls(range..., *out.g, out.add, which);
}
// Of velocities before they are projected.
template <class Way>
HOL_INLINE void write_all_but_atoms(Way &x, const LinearOutputs &out, unsigned which, Tally &tally) {
    if (out.lambda || out.virial) x.write({nullptr, out.lambda, nullptr, false, out.virial}, which, tally);
}

// Returns the lanes of which nothing has been written.
template <class Call, class Way>
HOL_INLINE unsigned write_solution(const Call &call, Way &x, unsigned good, Tally &tally) {
    if (good) x.write(outputs_of(call), good, tally);
    return x.in_use() & ~good;
}
template <class Way>
HOL_INLINE unsigned write_solution(const VelocitiesCall &call, Way &x, unsigned good, Tally &tally) {
    if (good) x.project(outputs_of(call), !call.v.is_float, good, tally);
    return x.in_use() & ~good;
}

// between(): what is done between the stages.
template <class Call, class Way, class Between>
HOL_INLINE unsigned solve_linear(const Call &call, Way &x, Tally &tally, const Between &between) {
    const unsigned good = x.solve();
    between();
    const unsigned rest = write_solution(call, x, good, tally);
    between();
    return rest;
}

}  // namespace holonomic::HOL_ISA::graph
