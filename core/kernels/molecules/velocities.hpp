// Velocity level of molecules: the same equations with d . (v_j - v_i) on the right, v_i += w_i G_i. A second solve,
// for the rates of the velocities as they are rounded after the first, leaves d . (v_j - v_i) at their rounding.
#pragma once

#include "core/kernels/molecules/blocks.hpp"
#include "core/kernels/molecules/store.hpp"
#include "core/kernels/molecules/triangle/blocks.hpp"

namespace holonomic::HOL_ISA::graph {

// v + w G of the atom in a slot.
template <class V>
struct Projected {
    const Vector3<V> *v, *pull;
    const V *w;
    HOL_FORCED Vector3<V> operator[](int32_t slot) const { return add_times(v[slot], w[slot], pull[slot]); }
};

// Solves a block and writes.
template <class V>
static inline unsigned solve_block(const VelocitiesCall &call, Linear<V> &z, bool masses_known, NextMolecules &ahead,
                                   Tally &tally) {
    z.x.in = {&call.v, nullptr, nullptr, true, call.strain};
    const unsigned good = load_and_solve(z, rates, masses_known);
    ahead.fetch();
    if (!good) return bits(z.x.in_use());
    if (call.lambda) write_bonds<false>(z.x, 0.5, call.lambda, good);
    if (call.virial) add_pulls_to_virial(z.x, good, tally);
    const Projected<V> projected = {z.v, z.pulls(), z.x.w};
    if (!call.v.is_float) {
        for (int32_t slot = 0; slot < z.x.s.n_atoms; ++slot) put(z.v[slot], projected[slot]);
        solve_for_rates(z);
    }
    write_vectors(call.v, z.x.at, z.x.s.slot_of, z.x.s.n_atoms, projected, Written<V>{good, nullptr, z.x.lane});
    return bits(z.x.in_use()) & ~good;
}

}  // namespace holonomic::HOL_ISA::graph
