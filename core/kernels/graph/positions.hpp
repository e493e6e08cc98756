// Position level of molecules: load, iterate, move the atoms, store.
#ifndef HOLONOMIC_KERNELS_GRAPH_POSITIONS_HPP
#define HOLONOMIC_KERNELS_GRAPH_POSITIONS_HPP

#include "core/kernels/graph/blocks.hpp"
#include "core/kernels/graph/doubtful.hpp"
#include "core/kernels/graph/flat_positions.hpp"
#include "core/kernels/graph/iterate.hpp"
#include "core/kernels/graph/newton.hpp"
#include "core/kernels/graph/store.hpp"
#include "core/kernels/graph/triangle_blocks.hpp"
#include "core/kernels/tally.hpp"

namespace holonomic {
namespace HOL_ISA {
namespace graph {

// A block of molecules at the position level.
template <Layout layout, class V>
struct PositionsBlock {
    const PositionsCall &call;
    const Schedule &s;
    const MoleculeLane *lane;  // [lanes]
    const Atoms<V> &at;
    Newton<V> &newton;
    Tally &tally;
    V a_min, a_max, largest_coordinate;

    // a^2 of all bonds.
    void set_lengths() {
        a_min = Width<V>::all(1e300);
        a_max = V{};
        for (int32_t k = 0; k < s.n_bonds; ++k) {
            V a = {};
            for (int i = 0; i < Width<V>::lanes; ++i) Width<V>::set(a, i, lane[i].length[s.bond_of[k]]);
            a_min = min(a, a_min);
            a_max = max(a, a_max);
            newton.x.row[k].a2 = a * a;
            newton.x.row[k].per_a2 = Width<V>::all(1) / newton.x.row[k].a2;
        }
    }

    __attribute__((noinline)) void load() {
        Vector3<V> *const r_ref = newton.x.move, *const r = newton.x.new_D;  // until the bonds are made
        V largest = {};
        for (int32_t slot = s.n_atoms - 1; slot >= 0; --slot) {
            const int32_t atom = s.atom_of[slot];
            const Vector3<V> before = read<layout>(call.r_ref, at, atom), now = read<layout>(call.r, at, atom);
            largest = max(max(abs(now.x), abs(now.y)), max(abs(now.z), largest));
            r_ref[slot] = before;
            if (slot < s.n_tree) make_bond(slot, r_ref[s.parent[slot]], before, r[s.parent[slot]], now);
            if (slot < s.n_bonds + 1) r[slot] = now;
        }
        for (int32_t k = s.n_tree; k < s.n_bonds; ++k) {
            const int32_t from = s.from[k - s.n_tree], to = s.to[k - s.n_tree];
            make_bond(k, r_ref[from], r_ref[to], r[from], r[to]);
        }
        largest_coordinate = largest;
    }
    HOL_INLINE void make_bond(NewtonRow<V> &row, const PositionsCall &call, const Vector3<V> &b, const Vector3<V> &D) {
        Vector3<V> unused = {};
        row.b = b;
        row.D = D;
        take_image<false>(call.box_ref, row.b, unused);
        take_image<false>(call.box, row.D, unused);
    }
    void make_bond(int32_t k, const Vector3<V> &b0, const Vector3<V> &b1, const Vector3<V> &D0, const Vector3<V> &D1) {
        make_bond(newton.x.row[k], call, b1 - b0, D1 - D0);
    }

    void load_guess() {
        const double factor = 2 * call.dt * call.dt;
        for (int32_t k = 0; k < s.n_bonds; ++k)
            for (int i = 0; i < Width<V>::lanes; ++i)
                Width<V>::set(newton.x.row[k].tau, i, factor * call.lambda[lane[i].first_bond + s.bond_of[k]]);
    }

    // Lanes in which an atom's displacement is the difference of pulls so large that their rounding is more than the
    // coordinates'.
    MaskOf<V> coarse_moves() const {
        V pull = {};
        for (int32_t k = 0; k < s.n_bonds; ++k) {
            int32_t from, to;
            ends_of(s, k, from, to);
            pull = max(max(newton.x.w[from], newton.x.w[to]) * abs(newton.x.row[k].tau), pull);
        }
        return less(0.25 * (largest_coordinate + a_min), pull * a_max);
    }

    void write_multipliers(unsigned which) const {
        const V factor = Width<V>::all(0.5 / (call.dt * call.dt));
        for (int32_t k = 0; k < s.n_bonds; ++k) {
            const V value = mul_add(newton.x.row[k].tau, factor, V{});
            for (int i = 0; i < Width<V>::lanes; ++i)
                if (which >> i & 1) call.lambda[lane[i].first_bond + s.bond_of[k]] = Width<V>::get(value, i);
        }
    }

    __attribute__((noinline)) void write_atoms(unsigned which) const {
        const V per_dt = Width<V>::all(1 / call.dt);
        for (int32_t slot = s.n_atoms - 1; slot >= 0; --slot) {
            const int32_t atom = s.atom_of[slot];
            if (s.fixed[atom]) continue;
            const Vector3<V> move = newton.x.move[slot];
            write<layout>(call.r, at, atom, read<layout>(call.r, at, atom) + move, which);
            if (call.v.x)
                write<layout>(call.v, at, atom, add_times(read<layout>(call.v, at, atom), per_dt, move), which);
        }
    }

    void add_virial(unsigned which) const {
        MoleculesVirial<V> virial;
        for (int32_t k = 0; k < s.n_bonds; ++k) {
            const NewtonRow<V> &row = newton.x.row[k];
            virial.add(row.b, row.tau * row.b);
        }
        virial.count(which, 1 / (call.dt * call.dt), tally);
    }

    // The worst bond of the molecules in `which`: of a molecule the one with the smallest number among those.
    void note_worst(unsigned which, V error) {
        int worst = -1;
        for (int i = 0; i < Width<V>::lanes; ++i) {
            if (!(which >> i & 1)) continue;
            const double e = Width<V>::get(error, i);
            if (!is_worse(tally, e, lane[i].molecule)) continue;
            tally.worst = e;
            tally.worst_chain = lane[i].molecule;
            worst = i;
        }
        if (worst < 0) return;
        int32_t bond = s.n_bonds;
        for (int32_t k = 0; k < s.n_bonds; ++k) {
            const NewtonRow<V> &row = newton.x.row[k];
            const double e = Width<V>::get(abs(2.0 * row.t) * row.per_a2, worst);
            if (e >= tally.worst && s.bond_of[k] < bond) bond = s.bond_of[k];
        }
        tally.worst_bond = bond < s.n_bonds ? bond : 0;
    }

    // Returns the lanes that need careful arithmetic; nothing of them has been written.
    unsigned solve(MaskOf<V> in_use) {
        load();
        if (call.guess) load_guess();
        const Limits<V> limits(call, largest_coordinate, a_min);
        const Solved<V> out = iterate<V>(newton, limits, call, in_use);
        const MaskOf<V> coarse = out.converged & coarse_moves();
        const unsigned moved = bits(out.converged & ~coarse), good = moved | bits(out.untouched);
        if (call.report) note_worst(good, out.error);
        if (call.lambda) write_multipliers(good);
        if (call.virial) add_virial(moved);
        if (moved) write_atoms(moved);
        tally.n_corrected += __builtin_popcount(moved);
        if (moved && out.solves > tally.iterations) tally.iterations = out.solves;
        return bits(in_use) & ~good;
    }
};

struct PositionsWork {
    const PositionsCall &call;
    const Schedule &schedule;
    const bool packed;
    Tally &tally;

    template <class V>
    void block(const MoleculeLane *lane, int used, bool, double *scratch) const {
        if (schedule.flat && used == 1 && solve_flat(call, schedule, *lane, packed, {scratch}, tally)) return;
        Memory<V> memory = {scratch};
        const Atoms<V> at(lane, used);
        Newton<V> newton(schedule, memory);
        for (int32_t slot = 0; slot < schedule.n_atoms; ++slot)
            for (int i = 0; i < Width<V>::lanes; ++i)
                Width<V>::set(newton.x.w[slot], i, lane[i].w[schedule.atom_of[slot]]);
        const unsigned rest = with_layout(
            at, packed, [&](auto layout) { return solve<decltype(layout)::value>(newton, lane, used, at); });
        if (__builtin_expect(rest != 0, 0)) solve_doubtful(call, schedule, lane, rest, memory.next, tally);
    }

    template <Layout layout, class V>
    unsigned solve(Newton<V> &newton, const MoleculeLane *lane, int used, const Atoms<V> &at) const {
        PositionsBlock<layout, V> block = {call, schedule, lane, at, newton, tally, V{}, V{}, V{}};
        block.set_lengths();
        return block.solve(Width<V>::first(used));
    }
};

}  // namespace graph
}  // namespace HOL_ISA
}  // namespace holonomic
#endif
