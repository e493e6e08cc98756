// Solves with kept factors of trees, and of rings with trees. The factors are read where they stand. Scratch has two
// values per bond, and what stands per atom.
#pragma once

#include "core/kernels/kept/tree_block.hpp"
#include "core/kernels/molecules/load.hpp"
#include "core/kernels/molecules/solve.hpp"

namespace holonomic::HOL_ISA::graph {

// What the way down has found: lanes in which all multipliers are finite; and how many atoms are to be looked at again.
struct Found {
    unsigned finite;
    int32_t n_flagged;
};
// On the way down.
template <class V>
struct KeptWay {
    V sum;      // not finite once a value is not
    int32_t n;  // atoms at which a bond may be cancelling
    int32_t *flagged;
    HOL_FORCED void count(V t) { sum = mul_add(Width<V>::all(0), t, sum); }
    // least: the smallest size that a bond at the atom has, less the error.
    HOL_FORCED void look(V least, int32_t index) {
        if (__builtin_expect(any(less(least, V{})), 0)) flagged[n++] = index;
    }
};

// A solve of a block. In molecules that go in lanes the children of an atom have indices that follow each other.
template <class V>
struct KeptTreesSolve {
    const EliminationPlan &s;
    const KeptTrees<V> kept;
    KeptValue<V> *const value;  // by bond index
    V *const pulls2;            // by index, of atoms with many children: what siblings.hpp needs
    int32_t *const flagged;
    const double per_cancelled2;

    KeptTreesSolve(const EliminationPlan &plan, const KeptTrees<V> &k, Memory<V> &memory, double cancelled)
        : s(plan), kept(k),
          value(reinterpret_cast<KeptValue<V> *>(memory.values(2 * static_cast<int64_t>(plan.n_bonds)))),
          pulls2(memory.values(plan.max_children > most_decomposed ? plan.n_atoms : 0)),
          flagged(reinterpret_cast<int32_t *>(memory.values(plan.n_atoms))), per_cancelled2(cancelled) {}

    int children(int32_t index) const { return s.child_start[index + 1] - s.child_start[index]; }
    // Where the bond indices of an index's children begin: those of trees stand in the order of the indices above them,
    // those of a ring's atoms do not.
    int32_t first_child(int32_t index) const {
        const int32_t start = s.child_start[index];
        return index < s.n_tree || start == s.child_start[index + 1] ? start : s.child[start];
    }
    // Which bond of a ring is before the one at an index.
    int32_t before(int32_t index) const { return index == s.n_tree ? s.n_bonds - 1 : index - 1; }

    // From the leaves to the top: u of all bonds, for right-hand sides rhs(bond_index, from, to).
    template <class Rhs>
    inline HOL_FORCED void up(const Rhs &rhs) const {  // of a copy: so that its members stay in registers
        for (int32_t p = 0; p < s.n_core; ++p) {
            const int32_t bond_index = s.n_tree + p;
            value[bond_index].t = rhs(bond_index, s.from[p], s.to[p]);
        }
        for (int32_t index = 0; index < s.n_tree; ++index) {
            V y = rhs(index, s.parent[index], index);
            const int k = children(index);
            if (k > 0) y = up_joint(index, k, y);
            value[index].t = y;
        }
        if (s.type == EliminationPlan::ring) return s.n_tree == 0 ? up_ring<true>() : up_ring<false>();
        const int32_t top = s.child_start[s.n_tree];
        value[top].t = value[top].own = value[top].t * kept.bond[top].r;
    }

    // From the top to the leaves: multipliers, and if wanted the pulls on all atoms.
    template <bool pulled>
    inline __attribute__((noinline)) Found down(Vector3<V> *pull) const {
        const KeptTreesSolve y = *this;
        KeptWay<V> way = {V{}, 0, y.flagged};
        if (y.s.type == EliminationPlan::tree)
            y.template down_root<pulled>(pull, way);
        else if (y.s.n_tree == 0)
            y.template down_ring<pulled, true>(pull, way);
        else
            y.template down_ring<pulled, false>(pull, way);
        for (int32_t index = y.s.n_tree - 1; index >= 0; --index) {
            const V above = y.value[index].t;
            Vector3<V> g = {};
            if (pulled) g = add_times(g, -above, y.kept.bond[index].d);  // zeros as +0
            const int k = y.children(index);
            if (k == 1)
                y.template down_joint<1, pulled>(index, k, above, g, way);
            else if (k == 2)
                y.template down_joint<2, pulled>(index, k, above, g, way);
            else if (k == 3)
                y.template down_joint<3, pulled>(index, k, above, g, way);
            else if (k > 3)
                way = down_some<pulled>(*this, index, k, way, pull);
            if (pulled && k <= 3) put(pull[index], g);
        }
        return {bits(finite(way.sum)), way.n};
    }

    // The square of that part of the error which all bonds at an atom share, as siblings.hpp has it.
    V shared_error(int32_t index) const {
        const int k = children(index);
        V T2 = kept.bond[index].q * (value[index].t * value[index].t);
        if (index >= s.n_tree) {
            const int32_t to = before(index);
            T2 = mul_add(kept.bond[to].q, own2(value[to]), kept.bond[index].q * own2(value[index]));
        }
        for (int32_t a = 0, c = first_child(index); a < k; ++a, ++c)
            T2 = mul_add(kept.bond[c].q, value[c].t * value[c].t, T2);
        return shared_error(index, k, T2);
    }

private:
    // Of an atom's children, from y to u. Returns y of the bond above.
    inline HOL_FORCED V up_joint(int32_t index, int k, V y) const {
        if (k == 1) return up_decomposed<1, 1>(index, k, y);
        if (k == 2) return up_decomposed<2, 2>(index, k, y);
        if (k == 3) return up_decomposed<3, 3>(index, k, y);
        return k > most_decomposed ? up_many(index, k, y) : up_some(index, k, y);
    }
    inline __attribute__((noinline)) V up_some(int32_t index, int k, V y) const {
        return up_decomposed<0, most_decomposed>(index, k, y);
    }
    template <int known, int most>
    inline HOL_FORCED V up_decomposed(int32_t index, int k, V y) const {
        const KeptBond<V> *const bond = kept.bond + s.child_start[index];
        for_children<known, most>(index, s.child_start[index], k,
                                  [&](int a, V of_child) HOL_FORCED { y = mul_add(bond[a].l, of_child, y); });
        return y;
    }
    // Calls body(a, y of child a), and then solves for u of the children.
    template <int known, int most, class Body>
    inline HOL_FORCED void for_children(int32_t index, int32_t first, int count, const Body &body) const {
        const int k = known > 0 ? known : count;
        const KeptBond<V> *const bond = kept.bond + first;
        KeptValue<V> *const of = value + first;
        V y[most], z_of[most], u[most], r[most];
        HOL_UNROLL_FEW
        for (int a = 0; a < k; ++a) {
            y[a] = of[a].t;
            r[a] = bond[a].r;
            body(a, y[a]);
            of[a].own = y[a] * r[a];
        }
        solve_joint(k, r, kept.pair + s.pair_start[index], y, z_of, u);
        HOL_UNROLL_FEW
        for (int a = 0; a < k; ++a) of[a].t = u[a];
    }
    inline __attribute__((noinline)) V up_many(int32_t index, int k, V y) const {
        const int32_t first = s.child_start[index];
        const KeptBond<V> *const bond = kept.bond + first;
        KeptValue<V> *const of = value + first;
        Vector3<V> sum = {};
        V size2 = {};
        for (int a = 0; a < k; ++a) {
            const V u = of[a].t * bond[a].r;
            sum = add_times(sum, u, bond[a].d);
            size2 = mul_add(bond[a].q, u * u, size2);
            y = mul_add(bond[a].l, of[a].t, y);
        }
        const V *const matrix = kept.pair + s.pair_start[index];
        const Vector3<V> a0 = kept_matrix(matrix) * sum;
        for (int a = 0; a < k; ++a) {
            of[a].own = of[a].t * bond[a].alone;
            of[a].t = bond[a].r * (of[a].t - dot(bond[a].d, a0));
        }
        pulls2[index] = size2;
        return y;
    }

    // As substitute_ring() does.
    template <bool bare>
    inline __attribute__((noinline)) void up_ring() const {
        const KeptTreesSolve y = *this;
        y.template substitute_ring<bare>();
    }
    template <bool bare>
    inline HOL_FORCED void substitute_ring() const {
        const V *reach = kept.reach, *to_last = kept.to_last;
        V carried = {}, y_of_last = {};
        for (int32_t index = s.n_tree; index < s.n_atoms; ++index) {
            const int32_t bond_index = before(index);
            choose_number<0, bare ? 0 : most_on_ring>(bare ? 0 : children(index), [&](auto known) HOL_FORCED {
                if constexpr (known > 0) {
                    V y_to = value[bond_index].t, y_from = value[index].t;
                    for_children<known, known>(index, first_child(index), known, [&](int a, V y) HOL_FORCED {
                        y_to = mul_add(reach[a], y, y_to);
                        y_from = mul_add(reach[known + a], y, y_from);
                    });
                    reach += 2 * known;
                    value[bond_index].t = y_to;
                    value[index].t = y_from;
                }
            });
            if (index == s.n_tree) continue;
            const KeptBond<V> &bond = kept.bond[bond_index];
            const V y = value[bond_index].t + carried;
            y_of_last = mul_add(*to_last++, y, y_of_last);
            carried = bond.l * y;
            value[bond_index].t = value[bond_index].own = y * bond.r;
        }
        KeptValue<V> &last = value[s.n_bonds - 1];
        last.t = last.own = (last.t + y_of_last) * kept.bond[s.n_bonds - 1].r;
    }
    template <bool pulled>
    inline HOL_FORCED void down_root(Vector3<V> *pull, KeptWay<V> &way) const {
        const int32_t top = s.child_start[s.n_tree];
        const V t = value[top].t;
        way.count(t);
        if (pulled) put(pull[s.n_tree], add_times(Vector3<V>{}, t, kept.bond[top].d));
    }

    // From u of the k children to t. g: the atom's pull so far.
    template <int known, bool pulled>
    inline HOL_FORCED void down_joint(int32_t index, int count, V above, Vector3<V> &g, KeptWay<V> &way) const {
        const int k = known > 0 ? known : count;
        const int32_t first = s.child_start[index];
        const KeptBond<V> *const bond = kept.bond + first, &e = kept.bond[index];
        KeptValue<V> *const of = value + first;
        V T2 = e.q * (above * above);
        HOL_UNROLL_FEW
        for (int a = 0; a < k; ++a) {
            const V t = of[a].t = mul_add(bond[a].l, above, of[a].t);
            way.count(t);
            if (k > 1) T2 = mul_add(bond[a].q, t * t, T2);
            if (pulled) g = add_times(g, t, bond[a].d);
        }
        if (k == 1) return;
        const V shared = shared_error(index, k, T2);
        V least = mul_add(-shared, e.error, own2(value[index]));
        HOL_UNROLL_FEW
        for (int a = 0; a < k; ++a) least = min(mul_add(-shared, bond[a].error, own2(of[a])), least);
        way.look(least, index);
    }
    template <bool pulled>
    static __attribute__((noinline)) KeptWay<V> down_some(const KeptTreesSolve &x, int32_t index, int k, KeptWay<V> way,
                                                          Vector3<V> *pull) {
        const V above = x.value[index].t;
        Vector3<V> g = {};
        if (pulled) g = add_times(g, -above, x.kept.bond[index].d);
        x.template down_joint<0, pulled>(index, k, above, g, way);
        if (pulled) put(pull[index], g);
        return way;
    }
    // From the squares of the tensions at an atom.
    inline HOL_FORCED V shared_error(int32_t index, int k, V T2) const {
        if (k > most_decomposed) {
            const V above = value[index].t, rounding = kept.pair[s.pair_start[index] + of_rounding];
            return rounding * (per_cancelled2 * mul_add(kept.bond[index].q, above * above, pulls2[index]));
        }
        const V w = kept.w[index];
        return (w * w) * (per_cancelled2 * T2);
    }
    // A bond's own size, in squares.
    inline HOL_FORCED V own2(const KeptValue<V> &of) const { return mul_add(of.own, of.own, of.t * of.t); }

    // As down_ring() of an elimination does, with the pulls on the ring's atoms.
    template <bool pulled, bool bare>
    inline HOL_FORCED void down_ring(Vector3<V> *pull, KeptWay<V> &way) const {
        const V *reach = kept.reach + 2 * static_cast<int64_t>(s.n_tree - s.child_start[s.n_tree]);
        const V last = value[s.n_bonds - 1].t, *to_last = kept.to_last + s.n_core - 1;
        V behind = last, behind2 = own2(value[s.n_bonds - 1]);
        for (int32_t index = s.n_bonds - 1; index >= s.n_tree; --index) {
            const int32_t bond_index = before(index);
            V t = last;
            if (index > s.n_tree)
                value[bond_index].t = t =
                    mul_add(kept.bond[bond_index].l, behind, mul_add(*--to_last, last, value[bond_index].t));
            const V t2 = own2(value[bond_index]);
            way.count(t);
            const int k = bare ? 0 : children(index);
            reach -= 2 * k;
            choose_number<0, bare ? 0 : most_on_ring>(k, [&](auto known) HOL_FORCED {
                down_ring_joint<known, pulled>(index, reach, t, t2, behind, behind2, pull, way);
            });
            behind = t;
            behind2 = t2;
        }
    }
    template <int k, bool pulled>
    inline HOL_FORCED void down_ring_joint(int32_t index, const V *reach, V t, V t2, V behind, V behind2,
                                           Vector3<V> *pull, KeptWay<V> &way) const {
        const int32_t first = first_child(index);
        const KeptBond<V> &to = kept.bond[before(index)], &from = kept.bond[index], *const bond = kept.bond + first;
        KeptValue<V> *const of = value + first;
        V T2 = mul_add(to.q, t2, from.q * behind2);
        Vector3<V> g = {};
        if (pulled) g = add_times(add_times(g, behind, from.d), -t, to.d);
        HOL_UNROLL_FEW
        for (int a = 0; a < k; ++a) {
            const V own = of[a].t = mul_add(reach[a], t, mul_add(reach[k + a], behind, of[a].t));
            way.count(own);
            T2 = mul_add(bond[a].q, own * own, T2);
            if (pulled) g = add_times(g, own, bond[a].d);
        }
        if (pulled) put(pull[index], g);
        const V shared = shared_error(index, k, T2);
        V least = min(mul_add(-shared, to.error, t2), mul_add(-shared, from.error, behind2));
        HOL_UNROLL_FEW
        for (int a = 0; a < k; ++a) least = min(mul_add(-shared, bond[a].error, own2(of[a])), least);
        way.look(least, index);
    }
};

}  // namespace holonomic::HOL_ISA::graph
