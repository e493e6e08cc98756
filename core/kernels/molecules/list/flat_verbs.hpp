// Forces, given right-hand sides and velocities of one large molecule with cycles, along a list. False where a
// refinement is in doubt: then nothing has been written.
#pragma once

#include "core/kernels/molecules/list/flat_linear.hpp"
#include "core/kernels/molecules/schedule.hpp"
#include "core/kernels/molecules/solve.hpp"

namespace holonomic::HOL_ISA::graph {

// Call: of forces or of given right-hand sides.
template <class Call>
static inline bool pull_flat(const Call &call, const FlatLinear &x, Tally &tally) {
    if (!solve_and_refine(x)) return false;
    if (call.lambda) x.write_bonds(0.5, call.lambda);
    if (call.tension) x.write_tensions(call.tension);
    if (call.virial) x.add_virial(tally);
    for (int32_t i = 0; i < x.s.n_atoms && call.g.x; ++i) {
        if (!x.writable(i)) continue;
        Vector3<double> pull = vector_of(x.pull[x.s.place_of[i]]);
        if (call.add) pull = read(call.g, x.at, i) + pull;
        write(call.g, x.at, i, pull, 1);
    }
    return true;
}

static inline bool solve_flat(const ForcesCall &call, const Schedule &s, const MoleculeLane &lane, bool packed,
                              Memory<double> memory, Tally &tally) {
    const Inputs in = {&call.v, &call.f, nullptr, false};
    const int terms = (call.v.x ? squares : 0) | (call.f.x ? pulls : 0);
    return pull_flat(call, FlatLinear(*s.flat, lane, packed, call.box, call.r, in, terms, memory), tally);
}

static inline bool solve_flat(const SolveCall &call, const Schedule &s, const MoleculeLane &lane, bool packed,
                              Memory<double> memory, Tally &tally) {
    const Inputs in = {nullptr, nullptr, call.rhs, false};
    return pull_flat(call, FlatLinear(*s.flat, lane, packed, call.box, call.r, in, given, memory), tally);
}

static inline bool solve_flat(const VelocitiesCall &call, const Schedule &s, const MoleculeLane &lane, bool packed,
                              Memory<double> memory, Tally &tally) {
    const Inputs in = {&call.v, nullptr, nullptr, true, call.strain};
    const FlatLinear x(*s.flat, lane, packed, call.box, call.r, in, rates, memory);
    if (!solve_and_refine(x)) return false;
    if (call.lambda) x.write_bonds(0.5, call.lambda);
    if (call.virial) x.add_virial(tally);
    if (!call.v.is_float) x.solve_again();
    for (int32_t i = 0; i < x.s.n_atoms; ++i)
        if (x.writable(i)) write(call.v, x.at, i, vector_of(x.a[x.s.place_of[i]]), 1);
    return true;
}

}  // namespace holonomic::HOL_ISA::graph
