// Newton's method for the positions of a block of molecules (theory (15)-(17), (58)). The corrections move_i of the
// atoms must bring every D.D to a^2. move_i is w_i times the sum of tau b over the bonds that point away from atom i,
// less the same sum over those that point to it.
#pragma once

#include "core/kernels/molecules/atoms/vectors.hpp"
#include "core/kernels/molecules/ring/newton_with_trees.hpp"

namespace holonomic::HOL_ISA::graph {

template <class V>
struct TreeNewton {
    typedef V Value;
    NewtonSystem<V> x;
    V *kept;              // factors, while new ones are made for some lanes
    V *lengths;           // least and largest
    V opening;            // the largest error of the bonds as they came
    bool pulled = false;  // atoms know their pulls by tau

    static constexpr int64_t row_values = static_cast<int64_t>(sizeof(NewtonRow<V>) / sizeof(V));
    // Values of factors that a ring has beside those of its bonds.
    static int64_t of_ring(const EliminationPlan &s) {
        return s.n_core > 0 ? 2 * static_cast<int64_t>(s.n_core) + 4 * static_cast<int64_t>(s.n_tree) : 0;
    }
    static int64_t values(const EliminationPlan &s) {
        const int64_t n_atoms = s.n_atoms, n_bonds = s.n_bonds;
        return 11 * n_atoms + 2 + (row_values + 6) * n_bonds + 4 * static_cast<int64_t>(s.n_pairs) + 2 * of_ring(s) +
               NewtonMemory<V, 0>::values(s.max_joint);
    }

    TreeNewton(const EliminationPlan &s, Memory<V> &memory)
        : x{s, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, memory}, kept(), lengths(memory.values(2)), opening() {
        x.w = memory.values(s.n_atoms);
        x.row = reinterpret_cast<NewtonRow<V> *>(memory.values(row_values * s.n_bonds));
        x.lower = memory.values(s.n_pairs);
        x.upper = memory.values(s.n_pairs);
        x.atom = reinterpret_cast<PulledAtom<V> *>(memory.values(4 * static_cast<int64_t>(s.n_atoms)));
        x.r_ref = memory.vectors(s.n_atoms);
        x.r = memory.vectors(s.n_atoms);
        x.new_D = memory.vectors(s.n_bonds);
        V *const ring = memory.values(of_ring(s));
        x.core_lower = ring;
        x.core_upper = ring + s.n_core;
        x.reach_up = x.core_upper + s.n_core;
        x.reach_down = x.reach_up + 2 * static_cast<int64_t>(s.n_tree);
        kept = memory.values(3 * static_cast<int64_t>(s.n_bonds) + 2 * static_cast<int64_t>(s.n_pairs) + of_ring(s));
        x.working = memory;
        memory.values(NewtonMemory<V, 0>::values(s.max_joint));
    }

    // And all else that stays from block to block.
    void set_masses(const MoleculeLane *lane) {
        masses_by_index(x.s, lane, x.w);
        for (int32_t index = 0; index < x.s.n_atoms; ++index) x.atom[index].w = x.w[index];
        for (int32_t k = 0; k < x.s.n_bonds; ++k) x.row[k].down = V{};  // at the root and the core it is never made
    }

    // The largest |D.D - a^2| / a^2 of the bonds measured so far. max() may lose a NaN, the sum keeps it.
    struct Errors {
        V worst, sum;
        V largest() const { return mul_add(sum, V{}, worst); }
    };
    // Puts what is left of a bond's length into its t, for D as given; first: for the factors that will be made of it.
    template <bool first>
    HOL_FORCED static void measure(NewtonRow<V> &row, const Vector3<V> &D, Errors &errors) {
        const V sigma = excess(D, row.a2), e = sigma * row.per_a2;
        errors.worst = max(abs(e), errors.worst);
        errors.sum = errors.sum + sigma;
        row.t = first ? row.first_left(sigma, e) : row.left(sigma, e);
    }

    // A bond vector between two atoms, as tau moves it.
    HOL_FORCED static Vector3<V> moved(const NewtonRow<V> &row, const PulledAtom<V> &from, const PulledAtom<V> &to) {
        return row.D + difference(to.w, to.pull, from.w, from.pull);
    }
    HOL_FORCED Vector3<V> moved(int32_t bond_index) const {
        int32_t from, to;
        ends_of(x.s, bond_index, from, to);
        return pulled ? moved(x.row[bond_index], x.atom[from], x.atom[to]) : x.row[bond_index].D;
    }

    // Makes factors for the bonds as they have been moved, in the lanes of `which`.
    void factorize(MaskOf<V> which) {
        for (int32_t k = 0; k < x.s.n_bonds; ++k) {
            NewtonRow<V> &row = x.row[k];
            const Vector3<V> D = moved(k);
            ByIndex<V>(x.new_D).put(k, D);
            const V stretch = row.stretch, sigma = excess(D, row.a2), e = sigma * row.per_a2, left = row.left(sigma, e);
            row.t = select(which, row.first_left(sigma, e), left);
            row.stretch = select(which, row.stretch, stretch);
        }
        if (bits(which) == all_of<V>) {
            make_factors();
        } else {
            V *to = kept;
            const V *from = kept;
            for_factors([&](V &value) HOL_FORCED { *to++ = value; });
            make_factors();
            for_factors([&](V &value) HOL_FORCED { value = select(which, value, *from++); });
        }
        go_up<false>();
    }

    // Calls body(value) for all values that factors are made of.
    template <class Body>
    HOL_FORCED void for_factors(const Body &body) const {
        const EliminationPlan &s = x.s;
        for (int32_t k = 0; k < s.n_bonds; ++k) {
            body(x.row[k].r);
            body(x.row[k].up);
            body(x.row[k].down);
        }
        for (int32_t p = 0; p < s.n_pairs; ++p) {
            body(x.lower[p]);
            body(x.upper[p]);
        }
        for (int64_t i = 0; i < of_ring(s); ++i) body(x.core_lower[i]);
    }

    __attribute__((noinline)) void make_factors() const {
        const EliminationPlan &s = x.s;
        for (int32_t index = 0; index < s.n_tree; ++index) {
            const int k = s.child_start[index + 1] - s.child_start[index];
            if (k == 0)
                x.row[index].r = x.w[index] * dot(x.new_D[index], x.row[index].b);
            else
                choose_mostly<3>(k, [=](auto known) HOL_FORCED {
                    factorize_joint<known, false, V>(NewtonAtom<V, known>(x, index), k);
                });
        }
        if (s.n_core_atoms == 0)
            factorize_joint<1, true, V>(NewtonAtom<V, 1>(x, s.n_tree), 1);
        else
            factorize_ring(x);
    }

    // At one atom of k children.
    HOL_FORCED void substitute(int32_t index, int k) const {
        if (k > 0)
            choose_mostly<3>(k, [=](auto known) HOL_FORCED {
                substitute_newton_joint<known, false, V>(NewtonAtom<V, known>(x, index), k);
            });
    }
    // Goes up the trees and the core: what is left of the lengths becomes u, in t of the rows. measured: it is found on
    // the way, for bonds as tau moves them; returns the largest error.
    template <bool measured>
    __attribute__((noinline)) V go_up() {
        const EliminationPlan &s = x.s;
        Errors errors = {};
        const PulledAtom<V> *const atom = x.atom, *own = atom;
        NewtonRow<V> *row = x.row;
        for (int32_t p = 0; measured && p < s.n_core; ++p) {
            NewtonRow<V> &bond = row[s.n_tree + p];
            measure<false>(bond, moved(bond, atom[s.from[p]], atom[s.to[p]]), errors);
        }
        const int32_t *const parent = s.parent, *const child_start = s.child_start;
        for (int32_t index = 0; index < s.n_tree; ++index, ++row, ++own) {
            if (measured) measure<false>(*row, moved(*row, atom[parent[index]], *own), errors);
            substitute(index, child_start[index + 1] - child_start[index]);
        }
        if (s.n_core_atoms == 0)
            substitute_newton_joint<1, true, V>(NewtonAtom<V, 1>(x, s.n_tree), 1);
        else
            substitute_ring(x);
        return errors.largest();
    }

    // Adds the corrections that follow from u to tau in the lanes of `active`. Then atoms know their pulls.
    void solve(MaskOf<V> active) {
        if (x.s.n_core_atoms > 0) down_ring(x, active);
        go_down<true>(active);
    }
    // The bonds as tau moves them, and their largest error.
    V move() {
        if (!pulled) go_down<false>(Width<V>::none());
        return go_up<true>();
    }

    // Goes down, bond by bond: corrected: through the trees, with the corrections in t, which are added to tau.
    template <bool corrected>
    __attribute__((noinline)) void go_down(MaskOf<V> active) {
        const EliminationPlan &s = x.s;
        if (s.type == EliminationPlan::ring) {
            const auto of_bond = [&](int32_t bond_index)
                                     HOL_FORCED { return x.row[bond_index].tau * x.row[bond_index].b; };
            Vector3<V> before = of_bond(s.n_bonds - 1);
            for (int32_t index = s.n_tree; index < s.n_atoms; ++index) {
                const Vector3<V> behind = of_bond(index);
                put(x.atom[index].pull, behind - before);
                put(before, behind);
            }
        } else {
            put(x.atom[s.n_tree].pull, Vector3<V>{});
        }
        V t = {};
        for (int32_t index = s.n_tree; index-- > 0;) {
            const int32_t parent = s.parent[index];
            NewtonRow<V> &row = x.row[index];
            PulledAtom<V> &own = x.atom[index], &above = x.atom[parent];
            V tau = row.tau;
            if (corrected) {
                if (parent != index + 1)
                    t = x.row[parent].t;  // else at hand; through memory the next would wait for it
                row.t = t = mul_add(row.down, t, row.t);
                row.tau = tau = tau + keep(active, t);
            }
            put(own.pull, -tau * row.b);
            put(above.pull, add_times(above.pull, tau, row.b));
        }
        pulled = true;
    }

    Displacements<V> displacements() const { return {ByIndex<V>(x.atom, &x.atom->pull.x), x.w}; }

    // Sets tau = 0 in the lanes of `which`.
    void forget(MaskOf<V> which) {
        for (int32_t k = 0; k < x.s.n_bonds; ++k) x.row[k].tau = select(which, V{}, x.row[k].tau);
        pulled = false;
    }

    // Returns the relative error of one bond, as it was measured last.
    V left_of(int32_t k) const { return abs(excess(moved(k), x.row[k].a2)) * x.row[k].per_a2; }

    // A bond as it comes: the first factors are for these.
    HOL_FORCED void measure_first(int32_t k, const Vector3<V> &D, Errors &errors) const {
        ByIndex<V>(x.new_D).put(k, D);
        measure<true>(x.row[k], D, errors);
    }
    V open() const { return opening; }
    void first_factors() {
        make_factors();
        go_up<false>();
    }
};

}  // namespace holonomic::HOL_ISA::graph
