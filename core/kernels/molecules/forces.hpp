// Constraint forces of molecules, and multipliers for given right-hand sides.
#pragma once

#include "core/kernels/molecules/blocks.hpp"
#include "core/kernels/molecules/flagged.hpp"
#include "core/kernels/molecules/solve.hpp"
#include "core/kernels/molecules/sparse_ldl/outputs.hpp"
#include "core/kernels/molecules/store.hpp"
#include "core/kernels/molecules/triangle/blocks.hpp"

namespace holonomic::HOL_ISA::graph {

template <class V>
static inline void write_outputs(Linear<V> &z, const Outputs &out, unsigned which, Tally &tally) {
    const Molecules<V> &x = z.x;
    if (out.lambda) write_bonds<false>(x, 0.5, out.lambda, which);
    if (out.tension) write_bonds<true>(x, 1, out.tension, which);
    if (out.virial) add_pulls_to_virial(x, which, tally);
    if (out.g->x)
        write_vectors(*out.g, x.at, x.s.slot_of, x.s.n_atoms, Slots<V>(z.pulls()),
                      Written<V>{which, nullptr, x.lane, out.add});
}
// The right-hand sides of a call into z, and their terms.
template <class V>
static inline int open_sides(const ForcesCall &call, Linear<V> &z) {
    z.x.in = {&call.v, &call.f, nullptr, false};
    return (call.v.x ? squares : 0) | (call.f.x ? pulls : 0);
}
template <class V>
static inline int open_sides(const SolveCall &call, Linear<V> &z) {
    z.x.in = {nullptr, nullptr, call.rhs, false};
    return given;
}

// Solves a block and writes: Call is ForcesCall or SolveCall.
template <class Call, class V>
static inline unsigned solve_block(const Call &call, Linear<V> &z, bool masses_known, NextMolecules &ahead,
                                   Tally &tally) {
    const unsigned good = load_and_solve(z, open_sides(call, z), masses_known);
    ahead.fetch();
    write_outputs(z, {&call.g, call.lambda, call.tension, call.add, call.virial}, good, tally);
    ahead.fetch();
    return bits(z.x.in_use()) & ~good;
}

}  // namespace holonomic::HOL_ISA::graph
