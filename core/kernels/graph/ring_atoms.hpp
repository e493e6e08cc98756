// The atoms of rings at the position level: read and written four at a time where they stand one behind the other.
#ifndef HOLONOMIC_KERNELS_GRAPH_RING_ATOMS_HPP
#define HOLONOMIC_KERNELS_GRAPH_RING_ATOMS_HPP

#include "core/kernels/graph/along.hpp"
#include "core/kernels/graph/ring_newton.hpp"

namespace holonomic {
namespace HOL_ISA {
namespace graph {

// Bonds of the reference positions and of the new ones; returns the largest coordinate of the latter.
template <Layout layout, class V>
HOL_NOINLINE V load_bonds(RingNewton<V> &z, const PositionsCall &call, const Atoms<V> &at) {
    const Schedule &s = z.x.s;
    Vector3<V> before[2] = {}, unused = {};
    V largest = {};
    NewtonRow<V> *const row = z.x.row;
    const auto bond = [&](int32_t k, const Vector3<V> &b, const Vector3<V> &D) HOL_FORCED {
        row[k].b = b;
        row[k].D = D;
        take_image<false>(call.box_ref, row[k].b, unused);
        take_image<false>(call.box, row[k].D, unused);
    };
    // The first atom's place is row N-1, until it gets its bond.
    for_groups(s.n_atoms, [&](int32_t slot, auto number) HOL_FORCED {
        constexpr int count = number;
        const bool follow = follow_each_other<count>(s.atom_of + slot);
        Vector3<V> ref[count] = {}, now[count] = {};
        read_few<layout, count>(call.r_ref, at, s.atom_of + slot, follow, ref);
        read_few<layout, count>(call.r, at, s.atom_of + slot, follow, now);
        HOL_UNROLL
        for (int j = 0; j < count; ++j) largest = max(max(abs(now[j].x), abs(now[j].y)), max(abs(now[j].z), largest));
        if (slot > 0) {
            bond(slot - 1, ref[0] - before[0], now[0] - before[1]);
        } else {
            row[s.n_bonds - 1].b = ref[0];
            row[s.n_bonds - 1].D = now[0];
        }
        HOL_UNROLL
        for (int j = 1; j < count; ++j) bond(slot + j - 1, ref[j] - ref[j - 1], now[j] - now[j - 1]);
        before[0] = ref[count - 1];
        before[1] = now[count - 1];
    });
    bond(s.n_bonds - 1, row[s.n_bonds - 1].b - before[0], row[s.n_bonds - 1].D - before[1]);
    return largest;
}

// Moves the atoms of the lanes in `which`, and their velocities.
template <Layout layout, class V>
HOL_NOINLINE void write_moves(const RingNewton<V> &z, const PositionsCall &call, const Atoms<V> &at, unsigned which) {
    Vector3<V> pull = z.pull_of(z.x.s.n_bonds - 1);
    move_along<layout>(z.x.s, call, at, which, [&](int32_t slot) HOL_FORCED {
        const Vector3<V> next = z.pull_of(slot), move = z.x.w[slot] * (next - pull);
        pull = next;
        return move;
    });
}

}  // namespace graph
}  // namespace HOL_ISA
}  // namespace holonomic
#endif
