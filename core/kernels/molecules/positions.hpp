// Position level of molecules: load, iterate, move the atoms, store.
#pragma once

#include "core/kernels/molecules/blocks.hpp"
#include "core/kernels/molecules/flagged.hpp"
#include "core/kernels/molecules/iterate.hpp"
#include "core/kernels/molecules/ring/newton.hpp"
#include "core/kernels/molecules/sparse_ldl/positions.hpp"
#include "core/kernels/molecules/store.hpp"
#include "core/kernels/molecules/tree/newton.hpp"
#include "core/kernels/molecules/triangle/blocks.hpp"
#include "core/kernels/tally.hpp"

namespace holonomic::HOL_ISA::graph {

template <class V>
HOL_INLINE void make_bond(NewtonRow<V> &row, const PositionsCall &call, const Vector3<V> &b, const Vector3<V> &D) {
    Vector3<V> unused = {};
    row.b = b;
    row.D = D;
    row.tau = V{};
    take_image<false>(call.box_ref, row.b, unused);
    take_image<false>(call.box, row.D, unused);
}
template <class V>
HOL_INLINE V largest_of(const V &largest, const Vector3<V> &r) {
    return max(max(abs(r.x), abs(r.y)), max(abs(r.z), largest));
}

// Reads the reference positions and the new ones, by slot.
template <class V>
HOL_INLINE void read_positions(const EliminationPlan &s, const PositionsCall &call, const Atoms<V> &at,
                               const Slots<V> ref, const Slots<V> now) {
    read_vectors(call.r_ref, at, s.slot_of, s.n_atoms, ref);
    read_vectors(call.r, at, s.slot_of, s.n_atoms, now);
}

// Bonds of the reference positions and of the new ones; returns the largest coordinate of the latter.
template <class V>
HOL_NOINLINE V load_bonds(Newton<V> &newton, const PositionsCall &call, const Atoms<V> &at) {
    const EliminationPlan &s = newton.x.s;
    const Vector3<V> *const r_ref = newton.x.r_ref, *const r = newton.x.r;
    read_positions(s, call, at, Slots<V>(newton.x.r_ref), Slots<V>(newton.x.r));
    V largest = {};
    typename Newton<V>::Errors errors = {};
    const auto load = [&](int32_t k, int32_t from, int32_t to) HOL_FORCED {
        make_bond(newton.x.row[k], call, r_ref[to] - r_ref[from], r[to] - r[from]);
        newton.measure_first(k, newton.x.row[k].D, errors);
    };
    for (int32_t k = 0; k < s.n_tree; ++k) {
        load(k, s.parent[k], k);
        largest = largest_of(largest, r[k]);
    }
    for (int32_t p = 0; p < s.n_core; ++p) load(s.n_tree + p, s.from[p], s.to[p]);
    for (int32_t slot = s.n_tree; slot < s.n_atoms; ++slot) largest = largest_of(largest, r[slot]);
    newton.opening = errors.largest();
    return largest;
}
// The atoms of a ring are read into the rows of the bonds behind them.
template <class V>
HOL_NOINLINE V load_bonds(RingNewton<V> &newton, const PositionsCall &call, const Atoms<V> &at) {
    NewtonRow<V> *const row = newton.x.row;
    read_positions(newton.x.s, call, at, Slots<V>(row, &row->b.x), Slots<V>(row, &row->D.x));
    const Vector3<V> first_ref = row[0].b, first = row[0].D;
    const int32_t n = newton.x.s.n_bonds;
    V largest = largest_of(V{}, first);
    for (int32_t k = 0; k + 1 < n; ++k) {
        largest = largest_of(largest, row[k + 1].D);
        make_bond(row[k], call, row[k + 1].b - row[k].b, row[k + 1].D - row[k].D);
    }
    make_bond(row[n - 1], call, first_ref - row[n - 1].b, first - row[n - 1].D);
    return largest;
}

// Moves the atoms of the lanes in `which`, and their velocities, but fixed ones. `right`: lanes that stay.
template <class System, class V>
HOL_INLINE void write_moves(const System &newton, const PositionsCall &call, const Atoms<V> &at, unsigned which,
                            unsigned right) {
    const EliminationPlan &s = newton.x.s;
    unsigned char any_fixed = 0;
    for (int32_t i = 0; i < s.n_atoms; ++i) any_fixed |= s.fixed[i];
    const unsigned char *const fixed = any_fixed ? s.fixed : nullptr;
    move_vectors(call, at, s.slot_of, s.n_atoms, newton.displacements(),
                 Written<V>{which, fixed, nullptr, false, 0, right});
}

// A block of molecules at the position level. System: Newton or RingNewton.
template <class System>
struct PositionsBlock {
    typedef typename System::Value V;
    const PositionsCall &call;
    const EliminationPlan &s;
    const MoleculeLane *lane;  // [lanes]
    const Atoms<V> &at;
    System &newton;
    Tally &tally;
    V a_min, a_max, largest_coordinate;

    // a^2 of all bonds, unless they are those of the block before.
    void set_lengths(bool known) {
        if (!known) {
            V least = Width<V>::all(1e300), most = {};
            for (int32_t k = 0; k < s.n_bonds; ++k) {
                V a = {};
                for (int i = 0; i < Width<V>::lanes; ++i) Width<V>::set(a, i, lane[i].length[s.bond_of[k]]);
                least = min(a, least);
                most = max(a, most);
                const V a2 = a * a;
                newton.x.row[k].a2 = a2;
                newton.x.row[k].per_a2 = Width<V>::all(1) / a2;
            }
            newton.lengths[0] = least;
            newton.lengths[1] = most;
        }
        a_min = newton.lengths[0];
        a_max = newton.lengths[1];
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

    __attribute__((noinline)) void write_multipliers(unsigned which) const {
        const V factor = Width<V>::all(0.5 / (call.dt * call.dt));
        write_values<V>(s.bond_of, lane, call.lambda, which, 0, s.n_bonds,
                        [&](int32_t k) HOL_FORCED { return mul_add(newton.x.row[k].tau, factor, V{}); });
    }

    void add_virial(unsigned which) const {
        MoleculesVirial<V> virial;
        for (int32_t k = 0; k < s.n_bonds; ++k) {
            const auto &row = newton.x.row[k];
            virial.add(row.b, row.tau * row.b);
        }
        virial.count(which, 1 / (call.dt * call.dt), tally);
    }

    void note_worst(unsigned which, V error) {
        note_worst_bond(
            s, which, error, lane, [&](int32_t k) { return newton.left_of(k); },
            [&](const auto &each) { each(0, s.n_bonds); }, tally);
    }

    // Finds multipliers, and writes nothing.
    Solved<V> find(MaskOf<V> in_use) {
        largest_coordinate = load_bonds(newton, call, at);
        if (call.guess) load_guess();
        const Limits<V> limits(call, largest_coordinate, a_min);
        return iterate<V, false, System::by_length>(newton, limits, call, in_use);
    }

    // Returns the lanes that need extended arithmetic; nothing of them has been written.
    unsigned solve(MaskOf<V> in_use, NextMolecules &ahead) {
        const Solved<V> out = find(in_use);
        ahead.fetch();
        const MaskOf<V> coarse = out.converged & coarse_moves();
        const unsigned moved = bits(out.converged & ~coarse), good = moved | bits(out.untouched);
        if (call.report) note_worst(good, out.error);
        if (call.lambda) write_multipliers(good);
        if (call.virial) add_virial(moved);
        if (moved) write_moves(newton, call, at, moved, good & ~moved);
        if (moved) count_moved(tally, __builtin_popcount(moved), out.solves);
        return bits(in_use) & ~good;
    }
};

struct PositionsWork {
    const PositionsCall &call;
    const EliminationPlan &elimination;
    const bool packed;
    Tally &tally;
    const LongTeam *team;
    NextMolecules &ahead;

    template <class V>
    void by_way(Way way, const MoleculeLane *lane, int used, bool known, double *scratch) const {
        switch (way) {
            case Way::sparse_ldl:
                return by_ldl<V>(lane, used, known, scratch);
            case Way::ring:
                return solve<RingNewton<V>>(lane, used, known, scratch);
            default:
                return solve<Newton<V>>(lane, used, known, scratch);
        }
    }

    template <class V>
    void by_ldl(const MoleculeLane *lane, int used, bool known, double *scratch) const {
        Memory<V> memory = {scratch};
        LdlPositions<V> list(call, elimination, lane, used, packed, known, team, memory, tally);
        if (const unsigned rest = list.solve()) solve_flagged(call, elimination, lane, rest, memory.next, tally);
    }

    template <class System>
    void solve(const MoleculeLane *lane, int used, bool known, double *scratch) const {
        typedef typename System::Value V;
        Memory<V> memory = {scratch};
        const Atoms<V> at(lane, used, packed);
        System newton(elimination, memory);
        if (!known) newton.set_masses(lane);
        PositionsBlock<System> block = {call, elimination, lane, at, newton, tally, V{}, V{}, V{}};
        block.set_lengths(known);
        const unsigned rest = block.solve(Width<V>::first(used), ahead);
        if (__builtin_expect(rest != 0, 0)) solve_flagged(call, elimination, lane, rest, memory.next, tally);
    }
};

}  // namespace holonomic::HOL_ISA::graph
