// Forces, given right-hand sides and velocities of molecules along a list: one (V = double), or W of one shape in
// lanes. Each returns the lanes that are in doubt, of which nothing has been written.
#pragma once

#include "core/kernels/molecules/list/flat_linear.hpp"
#include "core/kernels/molecules/solve.hpp"

namespace holonomic::HOL_ISA::graph {

// W molecules or one of a shape, and what of theirs the memory has already.
template <class V>
struct FlatBlock {
    const Schedule &schedule;
    const MoleculeLane *lane;
    int used;
    bool packed, masses_known;
    const LongTeam *team;
    Memory<V> &memory;
    FlatLinear<V> linear(const Box &box, const AtomArray &r, const Inputs &in, int terms) const {
        return FlatLinear<V>(*schedule.flat, lane, used, packed, masses_known, team, box, r, in, terms, memory);
    }
};

// Call: of forces or of given right-hand sides.
template <class V, class Call>
static inline unsigned pull_flat(const Call &call, const FlatLinear<V> &x, Tally &tally) {
    const unsigned good = solve_and_refine(x);
    if (good && call.lambda) x.write_bonds(0.5, call.lambda, good);
    if (good && call.tension) x.write_tensions(call.tension, good);
    if (good && call.virial) x.add_virial(good, tally);
    if (good && call.g.x) x.write_atoms(call.g, x.pull, call.add, good);
    return bits(x.in_use()) & ~good;
}

template <class V>
static inline unsigned solve_flat(const ForcesCall &call, const FlatBlock<V> &block, Tally &tally) {
    const Inputs in = {&call.v, &call.f, nullptr, false};
    const int terms = (call.v.x ? squares : 0) | (call.f.x ? pulls : 0);
    return pull_flat(call, block.linear(call.box, call.r, in, terms), tally);
}

template <class V>
static inline unsigned solve_flat(const SolveCall &call, const FlatBlock<V> &block, Tally &tally) {
    const Inputs in = {nullptr, nullptr, call.rhs, false};
    return pull_flat(call, block.linear(call.box, call.r, in, given), tally);
}

template <class V>
static inline unsigned solve_flat(const VelocitiesCall &call, const FlatBlock<V> &block, Tally &tally) {
    const Inputs in = {&call.v, nullptr, nullptr, true, call.strain};
    const FlatLinear<V> x = block.linear(call.box, call.r, in, rates);
    const unsigned good = solve_and_refine(x);
    if (!good) return bits(x.in_use());
    if (call.lambda) x.write_bonds(0.5, call.lambda, good);
    if (call.virial) x.add_virial(good, tally);
    if (!call.v.is_float) x.solve_again();
    x.write_atoms(call.v, x.a, false, good);
    return bits(x.in_use()) & ~good;
}

}  // namespace holonomic::HOL_ISA::graph
