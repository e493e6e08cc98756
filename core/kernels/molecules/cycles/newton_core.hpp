// The core at the position level. Its LU has the order and the pattern of the symmetric elimination.
#pragma once

#include "core/kernels/molecules/cycles/core_columns.hpp"
#include "core/kernels/molecules/cycles/core_matrix.hpp"
#include "core/kernels/molecules/tree/newton_joint.hpp"

namespace holonomic::HOL_ISA::graph {

// Bonds that meet at an atom stand in the order of their places, so that the later one of a pair is its row below the
// diagonal.
template <int known, class V>
HOL_INLINE void add_bare_atom(const NewtonSystem<V> &x, int32_t c, int count) {
    const Schedule &s = x.s;
    const int32_t *const meet = s.meet + s.meet_start[c], *entry = s.meet_pair + s.meet_pair_start[c];
    const int n = known > 0 ? known : count;
    const V w = x.w[s.n_tree + c], signed_w[2] = {w, -w};
    HOL_UNROLL_FEW
    for (int e = 0; e < n; ++e) {
        const int32_t place = s.n_tree + meet[e] / 2;
        const Vector3<V> D = x.new_D[place], b = x.row[place].b;
        V &pivot = x.core[meet[e] / 2];
        pivot = mul_add(w, dot(D, b), pivot);
        HOL_UNROLL_FEW
        for (int o = 0; o < e; ++o, ++entry) {
            const int32_t other = s.n_tree + meet[o] / 2;
            const V times = signed_w[(meet[e] ^ meet[o]) & 1];
            x.core_lower[*entry] = times * dot(D, x.row[other].b);
            x.core_upper[*entry] = times * dot(x.new_D[other], b);
        }
    }
}

template <class V>
static inline void add_bare_atom(const NewtonSystem<V> &x, int32_t c) {
    const int n = x.s.meet_start[c + 1] - x.s.meet_start[c];
    choose_few<4, 2>(n, [&](auto known) HOL_FORCED { add_bare_atom<known>(x, c, n); });
}

// Adds the elements of one atom of the core: in row k and column l, s_k s_l (w D_k.b_l - the sum over its children).
template <class V>
static inline void add_core_atom(const NewtonSystem<V> &x, int32_t c, int64_t reach) {
    const Schedule &s = x.s;
    const int32_t slot = s.n_tree + c, k = s.child_start[slot + 1] - s.child_start[slot];
    const int32_t *const meet = s.meet + s.meet_start[c], *entry = s.meet_pair + s.meet_pair_start[c];
    const int32_t n = s.meet_start[c + 1] - s.meet_start[c];
    if (k == 0) return add_bare_atom(x, c);
    const V w = x.w[slot];
    auto f = NewtonMemory<V, 0>::make(x.working, k);
    const NewtonAtom<V> atom(x, slot);
    factorize_children<V>(atom, k, f);
    for (int32_t e = 0; e < n; ++e) {
        const int32_t place = s.n_tree + meet[e] / 2;
        V *const z = x.part_down + e * k, *const h = x.part_up + e * k;
        const NewtonRow<V> &row = x.row[place];
        V &pivot = x.core[meet[e] / 2];
        pivot = pivot + couple<V>(atom, k, x.new_D[place], row.b, f, z, h, f.S, f.u);
        for (int32_t a = 0; a < k; ++a) {
            x.reach_up[reach + e * k + a] = f.S[a];
            x.reach_down[reach + e * k + a] = f.u[a];
        }
        for (int32_t o = 0; o < e; ++o, ++entry) {
            const int32_t other = s.n_tree + meet[o] / 2;
            V eo = w * dot(x.new_D[place], x.row[other].b), oe = w * dot(x.new_D[other], row.b);
            const V *const zo = x.part_down + o * k, *const ho = x.part_up + o * k;
            for (int32_t a = 0; a < k; ++a) {
                eo = mul_add(-(h[a] * f.r[a]), zo[a], eo);
                oe = mul_add(-(ho[a] * f.r[a]), z[a], oe);
            }
            const double sign = sign_of(meet[e]) * sign_of(meet[o]);
            const bool below = place > other;  // row e, column o
            x.core_lower[*entry] = sign * (below ? eo : oe);
            x.core_upper[*entry] = sign * (below ? oe : eo);
        }
    }
}

// Eliminates column p with n entries.
template <int known, class V>
HOL_INLINE void eliminate_column(const Schedule &s, V *pivot, int32_t p, int count, V r, V *lower, V *upper) {
    const int n = known > 0 ? known : count;
    const int32_t first = s.column_start[p];
    const int32_t *const below = s.row + first, *update = s.update + s.update_start[p];
    HOL_UNROLL_FEW
    for (int a = 0; a < n; ++a) {
        const V l = lower[first + a], u = upper[first + a], la = l * r, ua = u * r;
        HOL_UNROLL_FEW
        for (int b = 0; b < a; ++b, ++update) {
            // element (a, b) below the diagonal and (b, a) above it; l and u of b are multiplied by r already
            lower[*update] = mul_add(-l, upper[first + b], lower[*update]);
            upper[*update] = mul_add(-u, lower[first + b], upper[*update]);
        }
        pivot[below[a]] = mul_add(-l, ua, pivot[below[a]]);
        lower[first + a] = la;
        upper[first + a] = ua;
    }
}

template <class V>
static inline void factorize_core(const NewtonSystem<V> &x) {
    const Schedule &s = x.s;
    for (int32_t e = 0; e < s.n_entries; ++e) x.core_lower[e] = x.core_upper[e] = V{};
    for (int32_t p = 0; p < s.n_core; ++p) x.core[p] = V{};
    int64_t reach = 0;
    for (int32_t c = 0; c < s.n_core_atoms; ++c) {
        add_core_atom(x, c, reach);
        reach += static_cast<int64_t>(s.meet_start[c + 1] - s.meet_start[c]) *
                 (s.child_start[s.n_tree + c + 1] - s.child_start[s.n_tree + c]);
    }
    for (int32_t p = 0; p < s.n_core; ++p) {
        const V r = x.row[s.n_tree + p].r = Width<V>::all(1) / x.core[p];
        const int n = s.column_start[p + 1] - s.column_start[p];
        choose_few<4>(
            n, [&](auto known) HOL_FORCED { eliminate_column<known>(s, x.core, p, n, r, x.core_lower, x.core_upper); });
    }
}

// Goes up, behind the trees: finds y of the core and makes the forward half of its substitution.
template <class V>
static inline void substitute_core(const NewtonSystem<V> &x) {
    const Schedule &s = x.s;
    const V *reach = x.reach_up;
    for (int32_t c = 0; c < s.n_core_atoms; ++c) {
        const int32_t slot = s.n_tree + c, k = s.child_start[slot + 1] - s.child_start[slot];
        if (k == 0) continue;
        const int32_t *const child = s.child + s.child_start[slot];
        for (int32_t e = s.meet_start[c]; e < s.meet_start[c + 1]; ++e, reach += k) {
            V sum = {};
            for (int32_t a = 0; a < k; ++a) sum = mul_add(reach[a], x.row[child[a]].t, sum);
            V &y = x.row[s.n_tree + s.meet[e] / 2].t;
            y = s.meet[e] % 2 ? y + sum : y - sum;
        }
        substitute_newton_joint<0, true, V>(NewtonAtom<V>(x, slot), k);
    }
    for (int32_t p = 0; p < s.n_core; ++p) x.core[p] = x.row[s.n_tree + p].t;
    forward_columns(s, x.core_lower, x.core);
}

// Goes down: puts the corrections of the core into t, and adds them to tau in the lanes of `active`. Then it gives the
// first bonds of the hanging trees their share.
template <class V>
static inline void down_core(const NewtonSystem<V> &x, MaskOf<V> active) {
    const Schedule &s = x.s;
    NewtonRow<V> *const row = x.row + s.n_tree;
    back_columns(
        s, x.core_upper, x.core, [&](int32_t p) HOL_FORCED { return row[p].r; },
        [&](int32_t p, V t) HOL_FORCED {
            row[p].t = t;
            row[p].tau = row[p].tau + keep(active, t);
        });
    const V *reach = x.reach_down;
    for (int32_t c = 0; c < s.n_core_atoms; ++c) {
        const int32_t slot = s.n_tree + c, k = s.child_start[slot + 1] - s.child_start[slot];
        if (k == 0) continue;
        const int32_t *const child = s.child + s.child_start[slot];
        for (int32_t e = s.meet_start[c]; e < s.meet_start[c + 1]; ++e, reach += k) {
            const V t = x.row[s.n_tree + s.meet[e] / 2].t, signed_t = s.meet[e] % 2 ? t : -t;
            for (int32_t a = 0; a < k; ++a) x.row[child[a]].t = mul_add(reach[a], signed_t, x.row[child[a]].t);
        }
    }
}

}  // namespace holonomic::HOL_ISA::graph
