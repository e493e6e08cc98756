// Velocity level of molecules: the same equations with d . (v_j - v_i) on the right, v_i += w_i G_i. A second solve,
// for the rates of the velocities as they are rounded after the first, leaves d . (v_j - v_i) at their rounding.
#pragma once

#include "core/kernels/molecules/blocks.hpp"
#include "core/kernels/molecules/store.hpp"
#include "core/kernels/molecules/triangle/triangle_blocks.hpp"

namespace holonomic::HOL_ISA::graph {

// d . (v_j - v_i) into t of the row of a bond from slot i to slot j.
template <class V>
HOL_INLINE void find_rate(const Molecules<V> &x, const Vector3<V> *v, int32_t place, int32_t from, int32_t to) {
    BondRow<V> &row = x.row[place];
    row.t = dot(row.d, v[to] - v[from]);
    if (x.in.strain) row.t = row.t + stretching(x.in.strain, row.d);
}

// v += w G, and the rates that this leaves in place of the multipliers, if `then_rates`. From the root or the core down
// that is one pass: the atom above a bond has moved already, and no other needs the bond's multiplier any more.
template <class V>
HOL_NOINLINE void add_pulls_to(const Molecules<V> &x, Vector3<V> *v, bool then_rates) {
    const Schedule &s = x.s;
    for (int32_t slot = s.n_atoms; slot-- > s.n_tree;) v[slot] = add_times(v[slot], x.w[slot], pull_on(x, slot));
    for (int32_t p = 0; p < s.n_core && then_rates; ++p) find_rate(x, v, s.n_tree + p, s.from[p], s.to[p]);
    for (int32_t slot = s.n_tree; slot-- > 0;) {
        v[slot] = add_times(v[slot], x.w[slot], pull_on(x, slot));
        if (then_rates) find_rate(x, v, slot, s.parent[slot], slot);
    }
}

// Solves a block and writes.
template <class V>
static inline unsigned solve_block(const VelocitiesCall &call, Linear<V> &z, bool masses_known, Tally &tally) {
    z.equations.force = nullptr;
    z.equations.given = nullptr;
    z.x.in = {&call.v, nullptr, nullptr, true, call.strain};
    const unsigned good = load_and_solve(z, rates, masses_known);
    if (!good) return bits(z.x.in_use());
    if (call.lambda) write_bonds<false>(z.x, 0.5, call.lambda, good);
    if (call.virial) add_pulls_to_virial(z.x, good, tally);
    Vector3<V> *const v = z.equations.start;
    const bool twice = !call.v.is_float;
    add_pulls_to(z.x, v, twice);
    if (twice) solve_again_and_move(z, v);
    write_vectors(call.v, z.x.at, z.x.s.slot_of, z.x.s.n_atoms, Slots<V>(v), Written<V>{good, nullptr, z.x.lane});
    return bits(z.x.in_use()) & ~good;
}

}  // namespace holonomic::HOL_ISA::graph
