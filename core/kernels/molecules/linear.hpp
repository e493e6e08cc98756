// Solves the linear equations of a block of molecules, whatever their shape.
#pragma once

#include "core/kernels/molecules/cycles/proof.hpp"
#include "core/kernels/molecules/cycles/refine.hpp"
#include "core/kernels/molecules/ring/ring.hpp"
#include "core/kernels/molecules/store.hpp"

namespace holonomic::HOL_ISA::graph {

template <class V>
struct Linear {
    Molecules<V> x;
    CoreMatrix<V> core;
    Ring<V> ring;
    Equations<V> equations;
    V *t, *b;           // [n_bonds] of a graph: the solution so far; right-hand sides
    Memory<V> working;  // of a joint of many bonds

    static constexpr int64_t bond_values = sizeof(BondRow<V>) / sizeof(V);

    // Rows beside those of bonds: of a tree the root's, see load.hpp.
    static int64_t more_rows(const Schedule &s) { return s.type == Schedule::tree ? 1 : 0; }

    // Values of V that the arrays take.
    static int64_t values(const Schedule &s) {
        int64_t n = s.n_atoms + bond_values * s.n_bonds + s.n_pairs + JointMemory<V, 0>::values(s.max_joint);
        if (s.type == Schedule::ring) n += Ring<V>::values(s);
        n += bond_values * more_rows(s);
        n += 3 * 3 * static_cast<int64_t>(s.n_atoms);
        if (s.type == Schedule::graph) {
            const int64_t part = CoreMatrix<V>::most_parts(s);
            n += s.n_core + columns_ahead + 1 + s.n_entries + reaches(s) + (part > s.max_column ? part : s.max_column) +
                 9 * static_cast<int64_t>(s.n_bonds) + 7 * static_cast<int64_t>(s.n_atoms);
        }
        return n;
    }

    Linear(const Schedule &s, const MoleculeLane *lane, int used, bool packed, const Box &box, const AtomArray &r,
           Memory<V> &memory)
        : x{s, lane, used, Atoms<V>(lane, used, packed), &box, &r, nullptr, nullptr, nullptr, Width<V>::all(1), {}},
          core(), ring(), equations(), t(), b() {
        x.per_cancelled2 = 1 / most_cancelled2(s.n_bonds);
        x.row = reinterpret_cast<BondRow<V> *>(memory.values(bond_values * (s.n_bonds + more_rows(s))));
        x.w = memory.values(s.n_atoms);
        x.pair = memory.values(s.n_pairs);
        if (s.type == Schedule::ring)
            ring = {memory.values(s.n_core), memory.values(2 * static_cast<int64_t>(s.n_tree))};
        equations.r = memory.vectors(s.n_atoms);
        equations.velocity = memory.vectors(s.n_atoms);
        equations.force = memory.vectors(s.n_atoms);
        if (s.type == Schedule::graph) {
            const int64_t part = CoreMatrix<V>::most_parts(s);
            core = {memory.values(s.n_entries), memory.values(reaches(s)),
                    memory.values(part > s.max_column ? part : s.max_column),
                    memory.values(s.n_core + columns_ahead + 1)};
            t = memory.values(s.n_bonds);
            b = memory.values(s.n_bonds);
            equations.given = memory.values(s.n_bonds);
            equations.a = reinterpret_cast<Pair3<V> *>(memory.values(7 * static_cast<int64_t>(s.n_atoms)));
            equations.d = reinterpret_cast<Pair3<V> *>(memory.values(6 * static_cast<int64_t>(s.n_bonds)));
        }
        working = memory;
        memory.values(JointMemory<V, 0>::values(s.max_joint));
    }

    // From right-hand sides to the solution, both in t of the rows.
    void factorize_and_solve() {
        if (x.s.type == Schedule::graph)
            for (int32_t k = 0; k < x.s.n_bonds; ++k) b[k] = x.row[k].t;
        up_trees(x, working);
        if (x.s.type == Schedule::ring) {
            choose([&](auto bare) HOL_FORCED { up_and_down_ring<bare>(); }, x.s.n_tree == 0);
        } else if (x.s.type == Schedule::graph) {
            factorize_core(x, core, working);
            substitute_core(x, core, working);
            down_core(x, core);
            return down_trees<false, false, V>(x, nullptr);
        }
        down_and_pull<true>();
    }

    // For other right-hand sides in t of the rows.
    void solve_again() {
        solve_again(nullptr);
        down_trees<false, false, V>(x, nullptr);
    }
    // For the rates of velocities v.
    void solve_for_rates(const Vector3<V> *v) {
        solve_again(v);
        down_and_pull<false>();
    }

    // G of all atoms by slot, once all is solved.
    Vector3<V> *pulls() const { return equations.r; }
    // Goes down the trees; the bonds at the root or the core are solved for already.
    template <bool look>
    void down_and_pull() {
        pull_top(x, pulls());
        down_trees<look, true>(x, pulls());
    }

    // Up, and back to the bonds at the root, or the core and the bonds at its atoms. With v, rates are found on the
    // way.
    __attribute__((noinline)) void solve_again(const Vector3<V> *v) {
        const Molecules<V> &y = x;
        const auto find_rate = [&](int32_t place, int32_t from, int32_t to) HOL_FORCED {
            if (!v) return;
            BondRow<V> &row = y.row[place];
            row.t = dot(row.d, v[to] - v[from]);
            if (y.in.strain) row.t = row.t + stretching(y.in.strain, row.d);
        };
        for (int32_t p = 0; p < x.s.n_core; ++p) find_rate(x.s.n_tree + p, x.s.from[p], x.s.to[p]);
        substitute_trees(x, working, [&](int32_t slot) HOL_FORCED { find_rate(slot, y.s.parent[slot], slot); });
        if (x.s.type == Schedule::ring) {
            choose(
                [&](auto bare) HOL_FORCED {
                    substitute_ring<bare>(x, ring);
                    down_ring<false, bare>(x, ring);
                },
                x.s.n_tree == 0);
        } else if (x.s.type == Schedule::graph) {
            substitute_core(x, core, working);
            down_core(x, core);
        }
    }

    // Corrects the solution of a graph against the exact residual until a correction would be less than a rounding,
    // unless a proof shows that none is needed. Returns the lanes in which corrections shrank as they should. The
    // solution is t of the rows, as before.
    MaskOf<V> refine() {
        typedef MaskOf<V> Mask;
        const Schedule &s = x.s;
        const Mask proven =
            worth_a_proof(s) ? x.in_use() & proven_lanes(x, core, equations, Width<V>::all(1)) : Width<V>::none();
        if (!any(x.in_use() & ~proven)) return x.in_use();
        find_unrounded(x, equations);
        for (int32_t k = 0; k < s.n_bonds; ++k) t[k] = x.row[k].t;
        const Mask good = correct_until_right<V>(
            x.in_use() & ~proven, [&]() HOL_FORCED { solve_for_residuals(); },
            [&](Mask active) HOL_FORCED { return correct(active); },
            [&]() HOL_FORCED { return lanes_of_rounded_sides(); });
        for (int32_t k = 0; k < s.n_bonds; ++k) x.row[k].t = t[k];
        return good | proven | ~x.in_use();
    }

private:
    template <bool bare>
    HOL_FORCED void up_and_down_ring() {
        up_ring<bare>(x, ring);
        down_ring<true, bare>(x, ring);
    }

    void solve_for_residuals() {
        find_residuals(x, equations, t);
        solve_again();
    }

    // Returns the lanes whose corrections, in t of the rows, are no more than what rounding does to right-hand sides:
    // of velocities that are projected already, or in free fall.
    MaskOf<V> lanes_of_rounded_sides() const {
        V least = Width<V>::all(1);
        for (int32_t k = 0; k < x.s.n_bonds; ++k) {
            int32_t from, to;
            ends_of(x.s, k, from, to);
            const Vector3<V> terms =
                absolute(equations.input_of(from, x.w[from])) + absolute(equations.input_of(to, x.w[to]));
            const V rounded = (4 * epsilon) * (dot(absolute(x.row[k].d), terms) * x.row[k].r);
            least = min(rounded - abs(x.row[k].t), least);
        }
        return less_equal(V{}, least);
    }

    // Adds the corrections in t of the rows, in the lanes in `active`.
    V correct(MaskOf<V> active) {
        return add_corrections<V>(x.s.n_bonds, [&](int32_t k) HOL_FORCED {
            const BondRow<V> &row = x.row[k];
            return Correction<V>{keep(active, row.t), b[k] * row.r, row.q, t[k]};
        });
    }
};

}  // namespace holonomic::HOL_ISA::graph
