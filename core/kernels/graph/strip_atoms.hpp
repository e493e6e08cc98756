// The atoms of strips of triangles at the position level, along the strip: read and written four at a time where they
// stand one behind the other.
#ifndef HOLONOMIC_KERNELS_GRAPH_STRIP_ATOMS_HPP
#define HOLONOMIC_KERNELS_GRAPH_STRIP_ATOMS_HPP

#include "core/kernels/graph/along.hpp"
#include "core/kernels/graph/strip_newton.hpp"

namespace holonomic {
namespace HOL_ISA {
namespace graph {

// Bonds of the reference positions and of the new ones; returns the largest coordinate of the latter.
template <Layout layout, class V>
HOL_NOINLINE V load_bonds(StripNewton<V> &z, const PositionsCall &call, const Atoms<V> &at) {
    const Schedule &s = z.x.s;
    Vector3<V> ref[6] = {}, now[6] = {}, unused = {};  // two atoms of the group before, and those of one
    V largest = {};
    const auto bond = [&](int32_t place, int from, int to) HOL_FORCED {
        auto &row = z.x.row[place];
        row.b = ref[to] - ref[from];
        row.D = now[to] - now[from];
        take_image<false>(call.box_ref, row.b, unused);
        take_image<false>(call.box, row.D, unused);
    };
    for_groups(s.n_atoms, [&](int32_t slot, auto number) HOL_FORCED {
        constexpr int count = number;
        const bool follow = follow_each_other<count>(s.atom_of + slot);
        read_few<layout, count>(call.r_ref, at, s.atom_of + slot, follow, ref + 2);
        read_few<layout, count>(call.r, at, s.atom_of + slot, follow, now + 2);
        HOL_UNROLL
        for (int j = 2; j < count + 2; ++j) {
            largest = max(max(abs(now[j].x), abs(now[j].y)), max(abs(now[j].z), largest));
            const int32_t first = first_place_at(slot + j - 2);
            if (first + end_long > 0) bond(first + end_long, j - 2, j);
            if (first + end_short >= 0) bond(first + end_short, j - 1, j);
        }
        HOL_UNROLL
        for (int j = 0; j < 2; ++j) {
            ref[j] = ref[count + j];
            now[j] = now[count + j];
        }
    });
    return largest;
}

// Moves the atoms of the lanes in `which`, and their velocities.
template <Layout layout, class V>
HOL_NOINLINE void write_moves(const StripNewton<V> &z, const PositionsCall &call, const Atoms<V> &at, unsigned which) {
    typename StripNewton<V>::Displacements displacements = {};
    move_along<layout>(z.x.s, call, at, which, [&](int32_t slot) HOL_FORCED { return displacements.next(z, slot); });
}

}  // namespace graph
}  // namespace HOL_ISA
}  // namespace holonomic
#endif
