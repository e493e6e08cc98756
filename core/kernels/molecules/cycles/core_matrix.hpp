// The core of a molecule with cycles. Hanging trees leave a tensor of each atom's inverse mass, which is never formed
// (theory (55)). The core's bonds are eliminated by LDL^T in the order of the schedule.
#pragma once

#include "core/kernels/molecules/cycles/core_columns.hpp"
#include "core/kernels/molecules/tree/joint.hpp"

namespace holonomic::HOL_ISA::graph {

template <class V>
struct CoreMatrix {
    V *entry;  // [n_entries] off-diagonal elements, then multipliers; the pivots are E of the rows
    V *reach;  // for every core atom: l of each of its bonds for each of its children
    V *part;   // working memory: bonds of an atom times its children
    V *y;      // working memory of a substitution: core_columns.hpp
    static constexpr int64_t most_parts(const Schedule &s) {
        return static_cast<int64_t>(s.max_core_bonds) * s.max_children;
    }
};

// Returns the number of products of bonds and children over all atoms of the core.
HOL_INLINE int64_t reaches(const Schedule &s) {
    int64_t n = 0;
    for (int32_t c = 0; c < s.n_core_atoms; ++c)
        n += static_cast<int64_t>(s.meet_start[c + 1] - s.meet_start[c]) *
             (s.child_start[s.n_tree + c + 1] - s.child_start[s.n_tree + c]);
    return n;
}

HOL_INLINE double sign_of(int32_t meet) { return meet % 2 ? 1.0 : -1.0; }

// Adds the elements of an atom without children, s_k s_l w d_k.d_l. Refinement mends the products of nearly orthogonal
// bonds.
template <class V>
static inline void add_bare_atom(const Molecules<V> &x, const CoreMatrix<V> &core, int32_t c) {
    const Schedule &s = x.s;
    const int32_t *const meet = s.meet + s.meet_start[c], *entry = s.meet_pair + s.meet_pair_start[c];
    const int32_t n = s.meet_start[c + 1] - s.meet_start[c];
    const V w = x.w[s.n_tree + c];
    for (int32_t e = 0; e < n; ++e) {
        BondRow<V> &row = x.row[s.n_tree + meet[e] / 2];
        row.E = mul_add(w, row.q, row.E);
        const V sign_w = meet[e] % 2 ? w : -w;
        for (int32_t o = 0; o < e; ++o) {
            const V g = sign_w * dot(row.d, x.row[s.n_tree + meet[o] / 2].d);
            core.entry[*entry++] = meet[o] % 2 ? g : -g;
        }
    }
}

// Adds those of an atom with children, s_k s_l (w d_k.d_l - sum over children of z_k z_l r), where z is the forward
// half of l.
template <class V>
static inline void add_core_atom(Molecules<V> &x, const CoreMatrix<V> &core, int32_t c, V *reach, Memory<V> memory) {
    const Schedule &s = x.s;
    const int32_t slot = s.n_tree + c, k = s.child_start[slot + 1] - s.child_start[slot];
    if (k == 0) return add_bare_atom(x, core, c);
    const int32_t *const child = s.child + s.child_start[slot], *const meet = s.meet + s.meet_start[c];
    const int32_t n = s.meet_start[c + 1] - s.meet_start[c], *entry = s.meet_pair + s.meet_pair_start[c];
    const V w = x.w[slot];
    auto f = JointMemory<V, 0>::make(memory, k);
    decompose(AtomRows<V>(x, slot), k, w, f.S, f.r, f.m, x.slack);
    V *const m = x.pair + s.pair_start[slot];
    for (int32_t a = 0; a < k; ++a) x.row[child[a]].r = f.r[a];
    for (int32_t a = 0; a < k * (k - 1) / 2; ++a) m[a] = f.m[a];
    for (int32_t e = 0; e < n; ++e) {
        BondRow<V> &row = x.row[s.n_tree + meet[e] / 2];
        V *const z = core.part + e * k, *const l = reach + e * k;
        for (int32_t a = 0; a < k; ++a) f.y[a] = w * dot(x.row[child[a]].d, row.d);
        solve_joint(k, f.r, f.m, f.y, z, l);
        const V whole = w * row.q;
        V left = whole;
        for (int32_t a = 0; a < k; ++a) left = mul_add(-(z[a] * f.r[a]), z[a], left);
        x.slack = min(mul_add(Width<V>::all(-least_part), whole, left), x.slack);
        row.E = row.E + left;
        for (int32_t o = 0; o < e; ++o) {
            V g = w * dot(row.d, x.row[s.n_tree + meet[o] / 2].d);
            const V *const zo = core.part + o * k;
            for (int32_t a = 0; a < k; ++a) g = mul_add(-(z[a] * f.r[a]), zo[a], g);
            core.entry[*entry++] = sign_of(meet[e]) * sign_of(meet[o]) * g;
        }
    }
}

// A pivot below this part of its diagonal element may be nothing but rounding. The bonds may depend on each other;
// corrections don't show that if the right-hand side does not.
constexpr double least_pivot = 1e-10;

template <class V>
static inline void factorize_core(Molecules<V> &x, const CoreMatrix<V> &core, Memory<V> memory) {
    const Schedule &s = x.s;
    for (int32_t e = 0; e < s.n_entries; ++e) core.entry[e] = V{};
    BondRow<V> *const row = x.row + s.n_tree;
    for (int32_t p = 0; p < s.n_core; ++p) row[p].E = V{};
    V *reach = core.reach;
    for (int32_t c = 0; c < s.n_core_atoms; ++c) {
        add_core_atom(x, core, c, reach, memory);
        reach += static_cast<int64_t>(s.meet_start[c + 1] - s.meet_start[c]) *
                 (s.child_start[s.n_tree + c + 1] - s.child_start[s.n_tree + c]);
    }
    for (int32_t p = 0; p < s.n_core; ++p) {
        const int32_t first = s.column_start[p], n = s.column_start[p + 1] - first;
        const int32_t *const below = s.row + first, *update = s.update + s.update_start[p];
        V *const column = core.entry + first;
        const V whole = (x.w[s.from[p]] + x.w[s.to[p]]) * row[p].q;
        x.slack = min(mul_add(Width<V>::all(-least_pivot), whole, row[p].E), x.slack);
        const V r = Width<V>::all(1) / row[p].E;
        row[p].r = r;
        for (int32_t a = 0; a < n; ++a) {
            const V l = column[a] * r;
            for (int32_t b = 0; b < a; ++b, ++update)
                core.entry[*update] = mul_add(-l, core.part[b], core.entry[*update]);
            row[below[a]].E = mul_add(-l, column[a], row[below[a]].E);
            core.part[a] = column[a];
            column[a] = l;
        }
    }
}

// Finds u: first what the children of the core's atoms leave of the right-hand sides, then the core's own.
template <class V>
static inline void substitute_core(const Molecules<V> &x, const CoreMatrix<V> &core, Memory<V> memory) {
    const Schedule &s = x.s;
    const V *reach = core.reach;
    for (int32_t c = 0; c < s.n_core_atoms; ++c) {
        const int32_t slot = s.n_tree + c, k = s.child_start[slot + 1] - s.child_start[slot];
        const int32_t *const child = s.child + s.child_start[slot];
        if (k == 0) continue;
        for (int32_t e = s.meet_start[c]; e < s.meet_start[c + 1]; ++e, reach += k) {
            V sum = {};
            for (int32_t a = 0; a < k; ++a) sum = mul_add(reach[a], x.row[child[a]].t, sum);
            V &y = x.row[s.n_tree + s.meet[e] / 2].t;
            y = s.meet[e] % 2 ? y + sum : y - sum;
        }
        substitute_joint<0, true>(AtomRows<V>(x, slot), k, memory);
    }
    for (int32_t p = 0; p < s.n_core; ++p) core.y[p] = x.row[s.n_tree + p].t;
    forward_columns(s, core.entry, core.y);
}

// Goes back: finds t of the core, then of the first bonds of its hanging trees.
template <class V>
static inline void down_core(const Molecules<V> &x, const CoreMatrix<V> &core) {
    const Schedule &s = x.s;
    BondRow<V> *const row = x.row + s.n_tree;
    back_columns(
        s, core.entry, core.y, [&](int32_t p) HOL_FORCED { return row[p].r; },
        [&](int32_t p, V t) HOL_FORCED { row[p].t = t; });
    const V *reach = core.reach;
    for (int32_t c = 0; c < s.n_core_atoms; ++c) {
        const int32_t slot = s.n_tree + c, k = s.child_start[slot + 1] - s.child_start[slot];
        const int32_t *const child = s.child + s.child_start[slot];
        if (k == 0) continue;
        for (int32_t e = s.meet_start[c]; e < s.meet_start[c + 1]; ++e, reach += k) {
            const V t = x.row[s.n_tree + s.meet[e] / 2].t, signed_t = s.meet[e] % 2 ? t : -t;
            for (int32_t a = 0; a < k; ++a) x.row[child[a]].t = mul_add(reach[a], signed_t, x.row[child[a]].t);
        }
    }
}

}  // namespace holonomic::HOL_ISA::graph
