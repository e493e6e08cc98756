// The ring of a molecule with trees at the position level: LU in the order of linear.hpp. Row k of the matrix has D_k,
// column l has b_l (theory (58)).
#pragma once

#include "core/kernels/molecules/ring/linear.hpp"
#include "core/kernels/molecules/tree/newton_joint.hpp"

namespace holonomic::HOL_ISA::graph {

// What an atom gives to the diagonal elements of the bonds before and behind it, and to the elements between them: in
// the row of the one behind, and in its column.
template <class V>
struct NewtonRingJoint {
    V before, behind, lower, upper;
};

template <int known, class V>
HOL_INLINE NewtonRingJoint<V> factorize_ring_joint(const NewtonSystem<V> &x, int32_t before, int32_t index,
                                                   int64_t reach) {
    constexpr int k = known;
    const NewtonAtom<V> atom(x, index);
    const V w = atom.w();
    const Vector3<V> D_to = x.new_D[before], D_from = x.new_D[index], b_to = x.row[before].b, b_from = x.row[index].b;
    V lower = w * dot(D_from, b_to), upper = w * dot(D_to, b_from);
    if constexpr (k == 0) return {w * dot(D_to, b_to), w * dot(D_from, b_from), -lower, -upper};
    NewtonMemory<V, k + (k == 0)> f;
    factorize_children<V>(atom, k, f);
    V *const up = x.reach_up + reach, *const down = x.reach_down + reach;
    V z[2 * k + 1], h[2 * k + 1];
    const V P_to = couple<V>(atom, k, D_to, b_to, f, z, h, up, down);
    const V P_from = couple<V>(atom, k, D_from, b_from, f, z + k, h + k, up + k, down + k);
    HOL_UNROLL_FEW
    for (int a = 0; a < k; ++a) {
        lower = mul_add(-(h[k + a] * f.r[a]), z[a], lower);
        upper = mul_add(-(h[a] * f.r[a]), z[k + a], upper);
        up[k + a] = -up[k + a];
        down[k + a] = -down[k + a];
    }
    return {P_to, P_from, -lower, -upper};
}

// core_lower and core_upper: what the last row gets of each, and each of the last one's correction.
template <class V>
static inline void factorize_ring(const NewtonSystem<V> &x) {
    int64_t reach = 0, p = 0;
    V fill = {}, lower = {}, upper = {}, diagonal = {}, last = {};
    const int32_t end = x.s.n_bonds - 1;
    for_ring<false>(x.s, [&](int32_t before, int32_t index, int k) HOL_FORCED {
        NewtonRingJoint<V> joint = choose_number<0, most_on_ring>(
            k, [&](auto known) HOL_FORCED { return factorize_ring_joint<known>(x, before, index, reach); });
        reach += 2 * k;
        if (index == x.s.n_tree) {
            last = joint.before;  // the last bond is before this atom, the first one behind it
            lower = joint.upper;
            upper = joint.lower;
        } else {
            NewtonRow<V> &row = x.row[before];
            const V r = Width<V>::all(1) / (diagonal + joint.before + fill);
            if (index == end) {
                lower = lower + joint.lower;
                upper = upper + joint.upper;
                joint.lower = joint.upper = V{};
                last = last + joint.behind;
            }
            row.r = r;
            row.up = -(joint.lower * r);
            row.down = -(joint.upper * r);
            const V to_last = -(lower * r);
            x.core_lower[p] = to_last;
            x.core_upper[p] = -(upper * r);
            ++p;
            last = mul_add(to_last, upper, last);
            fill = row.up * joint.upper;
            lower = to_last * joint.upper;
            upper = row.up * upper;
        }
        diagonal = joint.behind;
    });
    x.row[end].r = Width<V>::all(1) / last;
}

// Goes up, behind the trees: from what is left of the lengths to u of the ring and of its atoms' children.
template <class V>
static inline void substitute_ring(const NewtonSystem<V> &x) {
    substitute_ring<false, NewtonAtom<V>, V>(
        x, x.reach_up, x.core_lower, [](const NewtonRow<V> &row) HOL_FORCED { return row.up; },
        [](const NewtonAtom<V> &atom, auto known) HOL_FORCED { substitute_newton_joint<known, true, V>(atom, known); });
}

// Goes down: puts the corrections of the ring into t, adds them to tau in the lanes of `active`, and gives its atoms'
// children their share.
template <class V>
static inline void down_ring(const NewtonSystem<V> &x, MaskOf<V> active) {
    const EliminationPlan &s = x.s;
    const V *reach = x.reach_down + 2 * static_cast<int64_t>(s.n_tree - s.child_start[s.n_tree]);
    const V last = x.row[s.n_bonds - 1].t, *to_last = x.core_upper + s.n_core - 1;
    V behind = last;
    for (int32_t index = s.n_bonds - 1; index >= s.n_tree; --index) {
        NewtonRow<V> &row = x.row[index];
        row.tau = row.tau + keep(active, behind);
        V before = last;
        if (index > s.n_tree) {
            NewtonRow<V> &next = x.row[index - 1];
            next.t = before = mul_add(next.down, behind, mul_add(*--to_last, last, next.t));
        }
        const int k = children_of(s, index);
        reach -= 2 * k;
        choose_number<0, most_on_ring>(k, [&](auto known) HOL_FORCED {
            for (int a = 0; a < known; ++a) {
                NewtonRow<V> &child = x.row[s.child[s.child_start[index] + a]];
                child.t = mul_add(reach[a], before, mul_add(reach[known + a], behind, child.t));
            }
        });
        behind = before;
    }
}

}  // namespace holonomic::HOL_ISA::graph
