// Solves the linear equations of a block of trees, or of rings with trees.
#pragma once

#include "core/kernels/molecules/ring/linear.hpp"
#include "core/kernels/molecules/store.hpp"

namespace holonomic::HOL_ISA::graph {

template <class V>
struct TreeLinear {
    Molecules<V> x;
    RingLinear<V> ring;
    Vector3<V> *r, *v, *f;  // [n_atoms] as they were read, by index; those that there are terms of
    Memory<V> working;      // of a joint of many bonds

    static constexpr int64_t bond_values = sizeof(BondRow<V>) / sizeof(V);

    // Rows beside those of bonds: of a tree the root's, see load.hpp.
    static int64_t more_rows(const EliminationPlan &s) { return s.type == EliminationPlan::tree ? 1 : 0; }

    // Values of V that the arrays take.
    static int64_t values(const EliminationPlan &s) {
        int64_t n = s.n_atoms + bond_values * s.n_bonds + s.n_pairs + JointMemory<V, 0>::values(s.max_joint);
        if (s.type == EliminationPlan::ring) n += RingLinear<V>::values(s);
        n += bond_values * more_rows(s);
        n += 3 * 3 * static_cast<int64_t>(s.n_atoms);
        return n;
    }

    TreeLinear(const EliminationPlan &s, const MoleculeLane *lane, int used, bool packed, const Box &box,
               const AtomArray &at, Memory<V> &memory)
        : x{s, lane, used, Atoms<V>(lane, used, packed), &box, &at, nullptr, nullptr, nullptr, Width<V>::all(1), {}},
          ring() {
        x.per_cancelled2 = 1 / most_cancelled2(s.n_bonds);
        x.row = reinterpret_cast<BondRow<V> *>(memory.values(bond_values * (s.n_bonds + more_rows(s))));
        x.w = memory.values(s.n_atoms);
        x.pair = memory.values(s.n_pairs);
        if (s.type == EliminationPlan::ring)
            ring = {memory.values(s.n_core), memory.values(2 * static_cast<int64_t>(s.n_tree))};
        r = memory.vectors(s.n_atoms);
        v = memory.vectors(s.n_atoms);
        f = memory.vectors(s.n_atoms);
        working = memory;
        memory.values(JointMemory<V, 0>::values(s.max_joint));
    }

    // From right-hand sides to the solution, both in t of the rows.
    void factorize_and_solve() {
        up_trees(x, working);
        if (x.s.type == EliminationPlan::ring)
            choose([&](auto bare) HOL_FORCED { up_and_down_ring<bare>(); }, x.s.n_tree == 0);
        down_and_pull<true>();
    }
    // For the rates of the velocities v.
    void solve_for_rates() {
        const Molecules<V> &y = x;
        const Vector3<V> *const speed = v;
        solve_again([&](int32_t bond_index, int32_t from, int32_t to) HOL_FORCED {
            BondRow<V> &row = y.row[bond_index];
            row.t = dot(row.d, speed[to] - speed[from]);
            if (y.in.strain) row.t = row.t + stretching(y.in.strain, row.d);
        });
        down_and_pull<false>();
    }
    // G of all atoms by index, once all is solved.
    Vector3<V> *pulls() const { return r; }

private:
    // Goes down the trees; the bonds at the root or the ring are solved for already.
    template <bool look>
    void down_and_pull() {
        pull_top(x, pulls());
        down_trees<look>(x, pulls());
    }

    // Up, and back to the bonds at the root, or the ring and the bonds at its atoms. Right-hand sides are found on the
    // way.
    template <class Rhs>
    __attribute__((noinline)) void solve_again(const Rhs &rhs) {
        const Molecules<V> &y = x;
        for (int32_t p = 0; p < x.s.n_core; ++p) rhs(x.s.n_tree + p, x.s.from[p], x.s.to[p]);
        substitute_trees(x, working, [&](int32_t index) HOL_FORCED { rhs(index, y.s.parent[index], index); });
        if (x.s.type == EliminationPlan::ring)
            choose(
                [&](auto bare) HOL_FORCED {
                    substitute_ring<bare>(x, ring);
                    down_ring<false, bare>(x, ring);
                },
                x.s.n_tree == 0);
    }

    template <bool bare>
    HOL_FORCED void up_and_down_ring() {
        up_ring<bare>(x, ring);
        down_ring<true, bare>(x, ring);
    }
};

}  // namespace holonomic::HOL_ISA::graph
