// Velocity level of a large molecule with arms. It is solved, and its velocities are moved, twice from the beginning,
// as in a long chain. The matrix is the same both times. The second time the rates are those that the rounded
// velocities leave.
#pragma once

#include "core/kernels/molecules/forces.hpp"

namespace holonomic::HOL_ISA::graph {

// Returns false, with nothing written, if plain arithmetic can't answer.
HOL_NOINLINE bool project_with_arms(Linear<double> &z, const VelocitiesCall &call, Tally &tally) {
    Molecules<double> &x = z.x;
    x.in = {&call.v, nullptr, nullptr, true, call.strain};
    Vector3<double> *const velocity = z.equations.velocity;
    const auto move = [&](double *lambda, bool virial) {
        const Outputs out = {&call.v, lambda, nullptr, true, virial};
        if (lambda) write_bonds<false>(x, 0.5, lambda, 1);
        if (virial) add_pulls_to_virial(x, 1, tally);
        for_slots(x.s, x.pieces, [&](int32_t first, int32_t end) { move_velocities(x, call.v, first, end); });
        write_arms(x, true, out, tally);
    };
    solve_in_pieces(z, rates);
    if (!solved_lanes(z) || (!call.v.is_float && has_torn_atoms(x))) return false;
    move(call.lambda, call.virial);
    if (call.v.is_float) return true;
    z.equations.velocity = velocity;
    solve_in_pieces(z, rates, false);
    if (finite_solution(x).set) move(nullptr, false);
    return true;
}

}  // namespace holonomic::HOL_ISA::graph
