// Newton's method for the positions of a block of molecules (theory (15)-(17), (58)). The corrections move_i of the
// atoms must bring every D.D to a^2. move_i is w_i times the sum of tau b over the bonds that point away from atom i,
// less the same sum over those that point to it.
#pragma once

#include "core/kernels/molecules/atoms/vectors.hpp"
#include "core/kernels/molecules/cycles/newton_core.hpp"
#include "core/kernels/molecules/ring/ring_trees_newton.hpp"

namespace holonomic::HOL_ISA::graph {

template <class V>
struct Newton {
    typedef V Value;
    static constexpr bool by_length = true;
    NewtonSystem<V> x;
    V *kept;     // factors, while new ones are made for some lanes
    V *lengths;  // least and largest
    V opening;   // the largest error of the bonds as they came

    static constexpr int64_t row_values = static_cast<int64_t>(sizeof(NewtonRow<V>) / sizeof(V));
    static int64_t values(const Schedule &s) {
        const int64_t part = CoreMatrix<V>::most_parts(s), n_atoms = s.n_atoms, n_bonds = s.n_bonds;
        return 7 * n_atoms + 2 + columns_ahead + 1 + (row_values + 7) * n_bonds + 4 * static_cast<int64_t>(s.n_pairs) +
               4 * static_cast<int64_t>(s.n_entries) + 4 * reaches(s) + 2 * part +
               NewtonMemory<V, 0>::values(s.max_joint);
    }

    Newton(const Schedule &s, Memory<V> &memory)
        : x{s, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, memory}, kept(), lengths(memory.values(2)),
          opening() {
        const int64_t part = CoreMatrix<V>::most_parts(s), n_reaches = reaches(s);
        x.w = memory.values(s.n_atoms);
        x.row = reinterpret_cast<NewtonRow<V> *>(memory.values(row_values * s.n_bonds));
        x.lower = memory.values(s.n_pairs);
        x.upper = memory.values(s.n_pairs);
        x.move = memory.vectors(s.n_atoms);
        x.r = memory.vectors(s.n_atoms);
        x.new_D = memory.vectors(s.n_bonds);
        x.core = memory.values(s.n_core + columns_ahead + 1);
        x.core_lower = memory.values(s.n_entries);
        x.core_upper = memory.values(s.n_entries);
        x.reach_up = memory.values(n_reaches);
        x.reach_down = memory.values(n_reaches);
        x.part_up = memory.values(part);
        x.part_down = memory.values(part);
        kept = memory.values(3 * static_cast<int64_t>(s.n_bonds) +
                             2 * (s.n_pairs + static_cast<int64_t>(s.n_entries) + n_reaches));
        x.working = memory;
        memory.values(NewtonMemory<V, 0>::values(s.max_joint));
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

    // Makes factors for the bonds in new_D, in the lanes of `which`.
    void factorize(MaskOf<V> which) {
        Errors unused = {};
        for (int32_t k = 0; k < x.s.n_bonds; ++k) {
            NewtonRow<V> &row = x.row[k];
            const V stretch = row.stretch, t = row.t;
            measure<true>(row, x.new_D[k], unused);
            row.stretch = select(which, row.stretch, stretch);
            row.t = select(which, row.t, t);
        }
        if (bits(which) == all_of<V>) return make_factors();
        V *to = kept;
        const V *from = kept;
        for_factors([&](V &value) HOL_FORCED { *to++ = value; });
        make_factors();
        for_factors([&](V &value) HOL_FORCED { value = select(which, value, *from++); });
    }

    // Calls body(value) for all values that factors are made of.
    template <class Body>
    HOL_FORCED void for_factors(const Body &body) const {
        const Schedule &s = x.s;
        for (int32_t k = 0; k < s.n_bonds; ++k) {
            body(x.row[k].r);
            body(x.row[k].up);
            body(x.row[k].down);
        }
        for (int32_t p = 0; p < s.n_pairs; ++p) {
            body(x.lower[p]);
            body(x.upper[p]);
        }
        for (int32_t e = 0; e < s.n_entries; ++e) {
            body(x.core_lower[e]);
            body(x.core_upper[e]);
        }
        for (int64_t e = 0; e < reaches(s); ++e) {
            body(x.reach_up[e]);
            body(x.reach_down[e]);
        }
    }

    __attribute__((noinline)) void make_factors() const {
        const Schedule &s = x.s;
        for (int32_t slot = 0; slot < s.n_tree; ++slot) {
            const int k = s.child_start[slot + 1] - s.child_start[slot];
            if (k == 0)
                x.row[slot].E = x.w[slot] * dot(x.new_D[slot], x.row[slot].b);
            else
                choose_few<3>(k, [&](auto known) HOL_FORCED {
                    factorize_joint<known, false, V>(NewtonAtom<V, known>(x, slot), k);
                });
        }
        if (s.n_core_atoms == 0)
            factorize_joint<1, true, V>(NewtonAtom<V, 1>(x, s.n_tree), 1);
        else if (s.type == Schedule::ring)
            factorize_ring(x);
        else
            factorize_core(x);
    }

    // Substitutes up: t of the rows, what is left of the lengths, becomes u.
    __attribute__((noinline)) void substitute() {
        const Schedule &s = x.s;
        for (int32_t slot = 0; slot < s.n_tree; ++slot) {
            const int k = s.child_start[slot + 1] - s.child_start[slot];
            if (k > 0)
                choose_few<3>(k, [&](auto known) HOL_FORCED {
                    substitute_newton_joint<known, false, V>(NewtonAtom<V, known>(x, slot), k);
                });
        }
        if (s.n_core_atoms == 0)
            substitute_newton_joint<1, true, V>(NewtonAtom<V, 1>(x, s.n_tree), 1);
        else if (s.type == Schedule::ring)
            substitute_ring(x);
        else
            substitute_core(x);
    }

    // Solves for what is left, in t of the rows, adds the corrections to tau in the lanes of `active`, and displaces
    // atoms.
    void solve(MaskOf<V> active) {
        substitute();
        solve_top(active);
        move_down<true, false>(active);
    }
    void solve_top(MaskOf<V> active) const {
        if (x.s.type == Schedule::ring)
            down_ring(x, active);
        else if (x.s.n_core_atoms > 0)
            down_core(x, active);
    }

    // Returns the displacement of an atom by tau.
    HOL_FORCED Vector3<V> displacement(int32_t slot) const {
        Vector3<V> pull = {};
        for_bonds_of<V>(x.s, slot, [&](int32_t place, auto sign) HOL_FORCED {
            pull = add_times(pull, sign * x.row[place].tau, x.row[place].b);
        });
        return x.w[slot] * pull;
    }

    // Of all atoms: solve() and move() leave them here.
    HOL_FORCED Slots<V> displace() const { return Slots<V>(x.move); }

    // Moves atoms and bonds by tau. Returns the largest error.
    V move() { return move_down<false, true>(Width<V>::none()); }
    // Behind solve(), in one: each bond is measured once both its atoms have moved, and its multiplier's correction is
    // not needed any more.
    V solve_and_move(MaskOf<V> active) {
        substitute();
        solve_top(active);
        return move_down<true, true>(active);
    }

    // Displaces atoms, from the root or the core down. corrected: by the corrections in t, too, which come first;
    // measured: moves bonds.
    template <bool corrected, bool measured>
    __attribute__((noinline)) V move_down(MaskOf<V> active) {
        const Schedule &s = x.s;
        Errors errors = {};
        const Slots<V> moves(x.move), new_D(x.new_D);
        const auto measure_bond = [&](int32_t k, int32_t from, const Vector3<V> &to_moves) HOL_FORCED {
            if (!measured) return;
            const Vector3<V> D = x.row[k].D + (to_moves - x.move[from]);
            new_D.put(k, D);
            measure<false>(x.row[k], D, errors);
        };
        const auto pull_by = [&](NewtonRow<V> &row, Vector3<V> &pull) HOL_FORCED {
            if (corrected) row.tau = row.tau + keep(active, row.t);
            pull = add_times(pull, row.tau, row.b);
        };
        for (int32_t slot = s.n_atoms - 1; slot >= s.n_tree; --slot) {
            Vector3<V> pull = {};
            for (int32_t c = s.child_start[slot]; c < s.child_start[slot + 1]; ++c) pull_by(x.row[s.child[c]], pull);
            for_core_bonds_of<V>(s, slot, [&](int32_t place, auto sign) HOL_FORCED {
                pull = add_times(pull, sign * x.row[place].tau, x.row[place].b);
            });
            moves.put(slot, x.w[slot] * pull);
        }
        for (int32_t p = 0; p < s.n_core; ++p) measure_bond(s.n_tree + p, s.from[p], x.move[s.to[p]]);
        for (int32_t slot = s.n_tree - 1; slot >= 0; --slot) {
            const NewtonRow<V> &above = x.row[slot];
            Vector3<V> pull = {};
            for_children(s, slot, [&](int32_t child) HOL_FORCED {
                NewtonRow<V> &row = x.row[child];
                if (corrected) row.t = mul_add(row.down, above.t, row.t);
                pull_by(row, pull);
            });
            pull = x.w[slot] * add_times(pull, -above.tau, above.b);
            moves.put(slot, pull);
            measure_bond(slot, s.parent[slot], pull);
        }
        return errors.largest();
    }

    // Sets tau = 0 in the lanes of `which`.
    void forget(MaskOf<V> which) {
        for (int32_t k = 0; k < x.s.n_bonds; ++k) x.row[k].tau = select(which, V{}, x.row[k].tau);
    }

    // Returns the relative error of one bond, as it was measured last.
    V left_of(int32_t k) const { return abs(excess(x.new_D[k], x.row[k].a2)) * x.row[k].per_a2; }

    // A bond as it comes: the first factors are for these.
    HOL_FORCED void measure_first(int32_t k, const Vector3<V> &D, Errors &errors) const {
        Slots<V>(x.new_D).put(k, D);
        measure<true>(x.row[k], D, errors);
    }
    V open() const { return opening; }
    void first_factors() { make_factors(); }
};

template <class V, class Mask>
HOL_INLINE auto solve_and_move(Newton<V> &newton, Mask active) {
    return newton.solve_and_move(active);
}

}  // namespace holonomic::HOL_ISA::graph
