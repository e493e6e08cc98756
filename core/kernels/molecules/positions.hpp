// Position level of molecules: load, iterate, move the atoms, store.
#pragma once

#include "core/kernels/molecules/blocks.hpp"
#include "core/kernels/molecules/flagged.hpp"
#include "core/kernels/molecules/position_level.hpp"
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

// Reads the reference positions and the new ones, by index.
template <class V>
HOL_INLINE void read_positions(const EliminationPlan &s, const PositionsCall &call, const Atoms<V> &at,
                               const ByIndex<V> ref, const ByIndex<V> now) {
    read_vectors(call.r_ref, at, s.index_of, s.n_atoms, ref);
    read_vectors(call.r, at, s.index_of, s.n_atoms, now);
}

// Bonds of the reference positions and of the new ones; returns the largest coordinate of the latter.
template <class V>
HOL_NOINLINE V load_bonds(TreeNewton<V> &newton, const PositionsCall &call, const Atoms<V> &at) {
    const EliminationPlan &s = newton.x.s;
    const Vector3<V> *const r_ref = newton.x.r_ref, *const r = newton.x.r;
    read_positions(s, call, at, ByIndex<V>(newton.x.r_ref), ByIndex<V>(newton.x.r));
    V largest = {};
    typename TreeNewton<V>::Errors errors = {};
    const auto load = [&](int32_t k, int32_t from, int32_t to) HOL_FORCED {
        make_bond(newton.x.row[k], call, r_ref[to] - r_ref[from], r[to] - r[from]);
        newton.measure_first(k, newton.x.row[k].D, errors);
    };
    for (int32_t k = 0; k < s.n_tree; ++k) {
        load(k, s.parent[k], k);
        largest = largest_of(largest, r[k]);
    }
    for (int32_t p = 0; p < s.n_core; ++p) load(s.n_tree + p, s.from[p], s.to[p]);
    for (int32_t index = s.n_tree; index < s.n_atoms; ++index) largest = largest_of(largest, r[index]);
    newton.opening = errors.largest();
    return largest;
}
// The atoms of a ring are read into the rows of the bonds behind them.
template <class V>
HOL_NOINLINE V load_bonds(RingNewton<V> &newton, const PositionsCall &call, const Atoms<V> &at) {
    NewtonRow<V> *const row = newton.x.row;
    read_positions(newton.x.s, call, at, ByIndex<V>(row, &row->b.x), ByIndex<V>(row, &row->D.x));
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

// A block of molecules at the position level. System: Newton or RingNewton.
template <class System>
struct PositionsBlock : PositionWay<typename System::Value> {
    typedef typename System::Value V;
    typedef PositionWay<V> Base;
    using Base::call, Base::lane;
    const EliminationPlan &s;
    const Atoms<V> &at;
    System &newton;

    // known: lengths are those of the block before.
    PositionsBlock(const PositionsCall &c, const MoleculeLane *lanes, Tally &sum, const Atoms<V> &atoms, System &system,
                   bool known)
        : Base{c, lanes, sum}, s(system.x.s), at(atoms), newton(system) {
        if (!known) set_lengths();
    }

    // a^2 of all bonds.
    void set_lengths() {
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
    HOL_FORCED auto multipliers() const {
        return [row = newton.x.row](int32_t k) HOL_FORCED -> V & { return row[k].tau; };
    }

    Extent<V> load() {
        const V largest = load_bonds(newton, call, at);
        if (call.guess) this->load_guess(s.bond_of, 0, s.n_bonds, multipliers());
        return {largest, newton.lengths[0], newton.lengths[1]};
    }
    __attribute__((noinline)) V largest_pull(bool) const {
        V pull = {};
        for (int32_t k = 0; k < s.n_bonds; ++k) {
            int32_t from, to;
            ends_of(s, k, from, to);
            pull = max(max(newton.x.w[from], newton.x.w[to]) * abs(newton.x.row[k].tau), pull);
        }
        return pull;
    }
    void note_worst(unsigned which, V error) const {
        note_worst_bond(
            s, which, error, lane, [&](int32_t k) { return newton.left_of(k); },
            [&](const auto &each) { each(0, s.n_bonds); }, this->tally);
    }
    __attribute__((noinline)) void write_multipliers(unsigned which) const {
        this->write_lambda(s.bond_of, 0, s.n_bonds, which, multipliers());
    }
    void add_virial(unsigned which) const {
        graph::add_virial<V>(
            0, s.n_bonds, [&](int32_t k) HOL_FORCED { return newton.x.row[k].b; }, multipliers(), this->per_dt2(),
            which, this->tally);
    }
    // Moves the atoms, and their velocities, but fixed ones.
    HOL_FORCED void write_moves(unsigned which, unsigned right) const {
        unsigned char any_fixed = 0;
        for (int32_t i = 0; i < s.n_atoms; ++i) any_fixed |= s.fixed[i];
        const unsigned char *const fixed = any_fixed ? s.fixed : nullptr;
        move_vectors(call, at, s.index_of, s.n_atoms, newton.displacements(),
                     Written<V>{which, fixed, nullptr, false, 0, right});
    }
};

struct PositionsOfBlocks {
    const PositionsCall &call;
    const EliminationPlan &elimination;
    const bool packed;
    Tally &tally;
    const LongTeam *team;
    NextMolecules &ahead;

    template <class V>
    void by_way(Way way, const MoleculeLane *lane, int used, bool known, double *scratch) const {
        Memory<V> memory = {scratch};
        const unsigned rest = way == Way::sparse_ldl ? by_ldl<V>(lane, used, known, memory)
                              : way == Way::ring     ? by_block<RingNewton<V>>(lane, used, known, memory)
                                                     : by_block<TreeNewton<V>>(lane, used, known, memory);
        if (__builtin_expect(rest != 0, 0)) solve_flagged(call, elimination, lane, rest, memory.next, tally);
    }

    template <class V>
    unsigned by_ldl(const MoleculeLane *lane, int used, bool known, Memory<V> &memory) const {
        LdlPositions<V> x(call, elimination, lane, used, packed, known, team, memory, tally);
        return solve_positions(x, Width<V>::first(used), [] {});
    }
    template <class System, class V>
    unsigned by_block(const MoleculeLane *lane, int used, bool known, Memory<V> &memory) const {
        const Atoms<V> at(lane, used, packed);
        System newton(elimination, memory);
        if (!known) newton.set_masses(lane);
        PositionsBlock<System> x(call, lane, tally, at, newton, known);
        return solve_positions(x, Width<V>::first(used), [&] { ahead.fetch(); });
    }
};

}  // namespace holonomic::HOL_ISA::graph
