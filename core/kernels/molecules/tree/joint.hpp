// Eliminates the k bonds from an atom of a tree to its children together (theory (51)-(53)). The bond vectors
// D = (d_1 .. d_k) all point away from the root. With S = diag(E) + w D^T D,
//
//     S u = y,   S l = w D^T d_e,   y_e = b_e + l.y,   E_e = w (q_e - w d_e^T D S^-1 D^T d_e),   t_c = u_c + l_c t_e.
//
// S = L P L^T is decomposed as it stands, which subtracts. Errors stay at a few roundings while every pivot and every E
// keep a sixteenth of what they are subtracted from. `margin` is negative where they don't.
#pragma once

#include "core/kernels/arithmetic/thresholds.hpp"
#include "core/kernels/molecules/scratch.hpp"
#include "core/kernels/molecules/tree/siblings.hpp"

namespace holonomic::HOL_ISA::graph {

constexpr int pair_of(int a, int b) { return a * (a - 1) / 2 + b; }  // a > b

// Finds multipliers m and reciprocal pivots r of S. S is k (k + 1) / 2 values of working memory, row after row.
template <class Rows, class V>
HOL_INLINE void decompose(const Rows &x, int k, V w, V *S, V *r, V *m, V &margin) {
    HOL_UNROLL_FEW
    for (int a = 0; a < k; ++a) {
        const BondRow<V> &row = x.bond(a);
        HOL_UNROLL_FEW
        for (int b = 0; b < a; ++b) S[pair_of(a + 1, b)] = w * dot(row.d, x.bond(b).d);
        S[pair_of(a + 1, a)] = mul_add(w, row.q, row.E);
    }
    HOL_UNROLL_FEW
    for (int j = 0; j < k; ++j) {
        const V P = S[pair_of(j + 1, j)];
        if (j > 0) {
            const BondRow<V> &row = x.bond(j);
            const V whole = mul_add(w, row.q, row.E);
            margin = min(mul_add(Width<V>::all(-least_part), whole, P), margin);
        }
        r[j] = Width<V>::all(1) / P;
        HOL_UNROLL_FEW
        for (int a = j + 1; a < k; ++a) {
            const V l = S[pair_of(a + 1, j)] * r[j];
            m[pair_of(a, j)] = l;
            HOL_UNROLL_FEW
            for (int b = j + 1; b <= a; ++b)
                S[pair_of(a + 1, b)] = mul_add(-l, S[pair_of(b + 1, j)], S[pair_of(a + 1, b)]);
        }
    }
}

// u = S^-1 y; z keeps y as it is after the forward half. Of S = L D U u = S^-1 y with (L, U), u = y S^-1 with (U, L).
template <class V>
HOL_INLINE void solve_joint(int k, const V *r, const V *first, const V *second, const V *y, V *z, V *u) {
    HOL_UNROLL_FEW
    for (int a = 0; a < k; ++a) {
        V sum = y[a];
        HOL_UNROLL_FEW
        for (int j = 0; j < a; ++j) sum = mul_add(-first[pair_of(a, j)], z[j], sum);
        z[a] = sum;
    }
    HOL_UNROLL_FEW
    for (int a = k - 1; a >= 0; --a) {
        V sum = z[a] * r[a];
        HOL_UNROLL_FEW
        for (int j = a + 1; j < k; ++j) sum = mul_add(-second[pair_of(j, a)], u[j], sum);
        u[a] = sum;
    }
}
template <class V>
HOL_INLINE void solve_joint(int k, const V *r, const V *m, const V *y, V *z, V *u) {
    solve_joint(k, r, m, m, y, z, u);
}

// Working memory of a joint: in registers where k is known to the compiler.
template <class V, int known>
struct JointMemory {
    V S[known * (known + 1) / 2], r[known], m[known * (known - 1) / 2 + 1], y[known], z[known], l[known];
    HOL_STATIC JointMemory make(Memory<V>, int) { return {}; }
};
template <class V>
struct JointMemory<V, 0> {
    V *S, *r, *m, *y, *z, *l;
    HOL_STATIC JointMemory make(Memory<V> a, int k) {
        return {
            a.values(k * (k + 1) / 2), a.values(k), a.values(k * (k - 1) / 2), a.values(k), a.values(k), a.values(k)};
    }
    static constexpr int64_t values(int64_t k) { return k * (k + 1) / 2 + k * (k - 1) / 2 + 4 * k; }
};

// Eliminates the k children of an atom towards the bond above it (top: there is none). Right-hand sides are in t of the
// rows. Multipliers and pivots are kept for another right-hand side.
template <int known, bool top, class V, class Rows>
HOL_INLINE void up_joint(const Rows &x, int count, Memory<V> memory, V &margin) {
    const int k = known > 0 ? known : count;
    if (!top && k > most_decomposed) return up_many(x, k, least_part, margin);
    auto f = JointMemory<V, known>::make(memory, k);
    const V w = x.w();
    decompose(x, k, w, f.S, f.r, f.m, margin);
    V *const m = x.multipliers();
    HOL_UNROLL_FEW
    for (int a = 0; a < k; ++a) {
        x.bond(a).r = f.r[a];
        HOL_UNROLL_FEW
        for (int b = 0; b < a; ++b) m[pair_of(a, b)] = f.m[pair_of(a, b)];
    }
    if (!top) {
        BondRow<V> &e = x.above();
        HOL_UNROLL_FEW
        for (int a = 0; a < k; ++a) f.y[a] = w * x.product(a, k);
        solve_joint(k, f.r, f.m, f.y, f.z, f.l);
        const V whole = w * e.q;
        V E = whole, y = e.t;
        HOL_UNROLL_FEW
        for (int a = 0; a < k; ++a) {
            E = mul_add(-(f.z[a] * f.r[a]), f.z[a], E);
            y = mul_add(f.l[a], x.bond(a).t, y);
            x.bond(a).l = f.l[a];
        }
        margin = min(mul_add(Width<V>::all(-least_part), whole, E), margin);
        e.E = E;
        e.t = y;
    }
    HOL_UNROLL_FEW
    for (int a = 0; a < k; ++a) {
        f.y[a] = x.bond(a).t;
        x.bond(a).E = f.y[a] * f.r[a];  // what siblings.hpp compares with
    }
    solve_joint(k, f.r, f.m, f.y, f.z, f.l);
    HOL_UNROLL_FEW
    for (int a = 0; a < k; ++a) x.bond(a).t = f.l[a];
}

// The same for another right-hand side.
template <int known, bool top, class V, class Rows>
HOL_INLINE void substitute_joint(const Rows &x, int count, Memory<V> memory) {
    const int k = known > 0 ? known : count;
    if (!top && k > most_decomposed) return substitute_many<V>(x, k);
    auto f = JointMemory<V, known>::make(memory, k);
    const V *const m = x.multipliers();
    V y = top ? V{} : x.above().t;
    HOL_UNROLL_FEW
    for (int a = 0; a < k; ++a) {
        const BondRow<V> &row = x.bond(a);
        f.y[a] = row.t;
        f.r[a] = row.r;
        if (!top) y = mul_add(row.l, row.t, y);
        HOL_UNROLL_FEW
        for (int b = 0; b < a; ++b) f.m[pair_of(a, b)] = m[pair_of(a, b)];
    }
    solve_joint(k, f.r, f.m, f.y, f.z, f.l);
    HOL_UNROLL_FEW
    for (int a = 0; a < k; ++a) x.bond(a).t = f.l[a];
    if (!top) x.above().t = y;
}

// Goes up the trees. Finds E, l and u of all their bonds, and y of what is above them. A leaf has E = w q since it was
// loaded.
template <class V>
static inline void up_trees(Molecules<V> &x, Memory<V> memory) {
    V margin = x.margin;  // in a register
    const EliminationPlan &s = x.s;
    for (int32_t index = 0; index < s.n_tree; ++index) {
        const int k = s.child_start[index + 1] - s.child_start[index];
        if (k == 0) continue;
        const Molecules<V> *const molecules = &x;
        margin = choose_mostly<3>(
            k, [=](auto known) HOL_FORCED {  // captures by value, so that pivot margin stays in a register
                V least = margin;
                up_joint<known, false>(AtomRows<V, known>(*molecules, index), k, memory, least);
                return least;
            });
    }
    if (s.type == EliminationPlan::tree) up_joint<1, true>(AtomRows<V, 1>(x, s.n_tree), 1, memory, margin);
    x.margin = margin;
}

// Calls before(index) at each atom, which may make the right-hand side of the bond above it.
template <class V, class Before>
HOL_INLINE void substitute_trees(const Molecules<V> &x, Memory<V> memory, const Before &before) {
    const Molecules<V> *const molecules = &x;
    for (int32_t index = 0; index < x.s.n_tree; ++index) {
        before(index);
        const int k = x.s.child_start[index + 1] - x.s.child_start[index];
        if (k > 0)
            choose_mostly<3>(k, [=](auto known) HOL_FORCED {
                substitute_joint<known, false>(AtomRows<V, known>(*molecules, index), k, memory);
            });
    }
    if (x.s.type == EliminationPlan::tree) substitute_joint<1, true>(AtomRows<V, 1>(x, x.s.n_tree), 1, memory);
}

// Goes down at one atom: u of its children becomes t, from t of the bond above. `look`: tests the result. pulled: adds
// to pull[index], which has t d of the bond above, what the children pull, and begins theirs.
template <int known, class V>
HOL_INLINE void down_joint(const Molecules<V> &x, int32_t index, int count, bool look, bool pulled, Vector3<V> *pull,
                           V &margin) {
    const int k = known > 0 ? known : count;
    const AtomRows<V, known> rows(x, index);
    const V above = x.row[index].t;
    Vector3<V> sum = {};
    if (pulled) sum = pull[index];
    HOL_UNROLL_FEW
    for (int a = k - 1; a >= 0; --a) {
        BondRow<V> &row = rows.bond(a);
        const V t = row.t = mul_add(row.l, above, row.t);
        if (!pulled) continue;
        put(pull[rows.bond_index(a)], add_times(Vector3<V>{}, -t, row.d));  // zeros as +0
        put(sum, add_times(sum, t, row.d));
    }
    if (pulled) put(pull[index], sum);
    if (!look || k == 1) return;
    const MaskOf<V> cancelling = cancelling_bonds<V>(rows, k);
    if (__builtin_expect(any(cancelling), 0)) flag_cancelling_bonds(x, index, k, bits(cancelling), margin);
}
template <class V>
HOL_NOINLINE void down_many_joint(const Molecules<V> &x, int32_t index, int k, bool look, bool pulled, Vector3<V> *pull,
                                  V &margin) {
    down_joint<0>(x, index, k, look, pulled, pull, margin);
}
template <class V>
HOL_INLINE void down_one(const Molecules<V> &x, int32_t index, bool look, bool pulled, Vector3<V> *pull, V &margin) {
    const int k = x.s.child_start[index + 1] - x.s.child_start[index];
    if (k > 3) return down_many_joint(x, index, k, look, pulled, pull, margin);
    if (k == 1) down_joint<1>(x, index, k, look, pulled, pull, margin);
    if (k == 2) down_joint<2>(x, index, k, look, pulled, pull, margin);
    if (k == 3) down_joint<3>(x, index, k, look, pulled, pull, margin);
}

// Goes down the trees.
template <bool look, class V>
static inline void down_trees(Molecules<V> &x, Vector3<V> *pull) {
    V margin = x.margin;
    for (int32_t index = x.s.n_tree - 1; index >= 0; --index) down_one(x, index, look, true, pull, margin);
    x.margin = margin;
}

}  // namespace holonomic::HOL_ISA::graph
