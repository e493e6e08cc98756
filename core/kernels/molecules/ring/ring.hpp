// The equations of a molecule with one ring, once the trees that hang from it are eliminated. The bonds of the ring are
// a chain of all but the last one, and that one: LDL^T, each row coupled to the next one and, by fill, to the last. It
// subtracts. What a rounding of all diagonal elements does to each pivot is found beside it (theory (57b)): `error` of
// the pivot at hand, `error_of_last`, and `slope`, the same of what couples the row to the last one. `slack` is
// negative where a pivot is not large enough for that.
//
// Bond p of the ring, at place n_tree + p, points from slot n_tree + p to the next one: the bond *behind* this atom, as
// p - 1 is the one *before* it.
#pragma once

#include "core/kernels/molecules/tree/joint.hpp"

namespace holonomic::HOL_ISA::graph {

// The roundings that a pivot may lose: of the 16 + sqrt(n) that count as right (tests/oracle/molecules/README.md), but
// for what right-hand sides and sums lose.
HOL_INLINE double most_lost(int32_t n_bonds) { return 0.75 * (16 + __builtin_sqrt(static_cast<double>(n_bonds))); }

template <class V>
struct Ring {
    V *to_last;  // [n_core] what the last row gets of y of each, and each of the last one's t
    V *reach;  // for every atom of the ring: the same of its children with the bond before it, then with the one behind
    static int64_t values(const Schedule &s) { return s.n_core + 2 * static_cast<int64_t>(s.n_tree); }
};

// What an atom gives to the diagonal elements of the bonds before and behind it, and between them; what a rounding of
// all that these are made of does to the first two.
template <class V>
struct RingJoint {
    V before, behind, between, error_before, error_behind, slack;
};

HOL_INLINE int32_t children_of(const Schedule &s, int32_t slot) {
    return s.child_start[slot + 1] - s.child_start[slot];
}
// Calls body(before, slot, k) for the atoms of the ring: the place of the bond before it, its slot, which is the place
// of the one behind, and its number of children; bare: none has any.
template <bool bare, class Body>
HOL_INLINE void for_ring(const Schedule &s, const Body &body) {
    int32_t before = s.n_bonds - 1;
    for (int32_t slot = bare ? 0 : s.n_tree; slot < s.n_atoms; ++slot) {
        body(before, slot, bare ? 0 : children_of(s, slot));
        before = slot;
    }
}

// Eliminates the children of an atom of the ring, as up_joint() does, for two bonds in place of one.
template <int known, class V>
HOL_INLINE RingJoint<V> up_ring_joint(const Molecules<V> &x, int32_t before, int32_t slot, V *reach, V slack) {
    constexpr int k = known;
    const AtomRows<V> rows(x, slot);
    JointMemory<V, known> f = {};
    V z_to[known];
    const V w = rows.w();
    decompose(rows, k, w, f.S, f.r, f.m, slack);
    V *const m = rows.multipliers();
    BondRow<V> &to = x.row[before], &from = x.row[slot];
    const V whole_to = w * to.q, whole_from = w * from.q;
    V between = w * dot(to.d, from.d), left_to = whole_to, left_from = whole_from, y_to = to.t, y_from = from.t;
    V error_to = whole_to, error_from = whole_from, error[known];
    HOL_UNROLL_FEW
    for (int a = 0; a < k; ++a) f.y[a] = w * dot(rows.bond(a).d, to.d);
    solve_joint(k, f.r, f.m, f.y, z_to, f.l);
    HOL_UNROLL_FEW
    for (int a = 0; a < k; ++a) {
        left_to = mul_add(-(z_to[a] * f.r[a]), z_to[a], left_to);
        y_to = mul_add(f.l[a], rows.bond(a).t, y_to);
        reach[a] = f.l[a];
        error[a] = (w + x.w[rows.place(a)]) * rows.bond(a).q;
        error_to = mul_add(f.l[a] * f.l[a], error[a], error_to);
        f.y[a] = w * dot(rows.bond(a).d, from.d);
    }
    solve_joint(k, f.r, f.m, f.y, f.z, f.l);
    HOL_UNROLL_FEW
    for (int a = 0; a < k; ++a) {
        const V zr = f.z[a] * f.r[a];
        left_from = mul_add(-zr, f.z[a], left_from);
        between = mul_add(-zr, z_to[a], between);
        y_from = mul_add(-f.l[a], rows.bond(a).t, y_from);
        reach[k + a] = -f.l[a];
        error_from = mul_add(f.l[a] * f.l[a], error[a], error_from);
        f.y[a] = rows.bond(a).t;
        rows.bond(a).r = f.r[a];
        rows.bond(a).E = f.y[a] * f.r[a];  // what siblings.hpp compares with
        HOL_UNROLL_FEW
        for (int b = 0; b < a; ++b) m[pair_of(a, b)] = f.m[pair_of(a, b)];
    }
    solve_joint(k, f.r, f.m, f.y, f.z, f.l);
    HOL_UNROLL_FEW
    for (int a = 0; a < k; ++a) rows.bond(a).t = f.l[a];
    to.t = y_to;
    from.t = y_from;
    return {left_to, left_from, between, error_to, error_from, slack};
}

// From right-hand sides to u of the ring and of the children of its atoms, all in t of the rows.
template <bool bare, class V>
static inline void up_ring(Molecules<V> &x, const Ring<V> &ring) {
    V *reach = ring.reach, *to_last = ring.to_last;
    V taken = {}, coupling = {}, carried = {}, diagonal = {}, last = {}, taken_of_last = {}, y_of_last = {};
    V slack = x.slack, error = {}, kept = {}, slope = {}, diagonal_error = {}, error_of_last = {}, last_error = {};
    const V part = Width<V>::all(-1 / most_lost(x.s.n_bonds)), one = Width<V>::all(1);
    const int32_t first = bare ? 0 : x.s.n_tree, end = x.s.n_bonds - 1;
    for_ring<bare>(x.s, [&](int32_t before, int32_t slot, int k) HOL_FORCED {
        RingJoint<V> joint;
        BondRow<V> &row = x.row[before];
        if (k == 0) {
            const V w = x.w[slot], to = w * row.q, from = w * x.row[slot].q;
            joint = {to, from, w * dot(row.d, x.row[slot].d), to, from, slack};
        } else {
            joint = choose_number<1, most_on_ring>(
                k, [=](auto known) HOL_FORCED { return up_ring_joint<known>(x, before, slot, reach, slack); });
            reach += 2 * k;
            slack = joint.slack;
        }
        if (slot == first) {
            last = joint.before;
            coupling = joint.between;
            diagonal = joint.behind;
            last_error = joint.error_before;
            diagonal_error = joint.error_behind;
            return;
        }
        const V whole = diagonal + joint.before, P = whole - taken, r = one / P, y = row.t + carried;
        error = mul_add(kept, error, bare ? whole : diagonal_error + joint.error_before);
        slack = min(mul_add(part, error, P), slack);
        row.r = r;
        row.t = row.E = y * r;
        if (slot == end) {
            coupling = coupling + joint.between;
            joint.between = V{};
            last = last + joint.behind;
            last_error = last_error + joint.error_behind;
        }
        const V next = joint.between * r, l = coupling * r;
        row.l = next;
        *to_last++ = l;
        taken_of_last = mul_add(l, coupling, taken_of_last);
        y_of_last = mul_add(l, y, y_of_last);
        carried = next * y;
        taken = next * joint.between;
        coupling = l * joint.between;
        diagonal = joint.behind;
        const V more = mul_add(l, error, slope);
        error_of_last = mul_add(l, slope + more, error_of_last);
        slope = next * more;
        kept = next * next;
        diagonal_error = joint.error_behind;
    });
    BondRow<V> &row = x.row[end];
    const V P = last - taken_of_last;
    x.slack = min(mul_add(part, last_error + error_of_last, P), slack);
    row.r = one / P;
    row.t = row.E = (row.t + y_of_last) * row.r;
}

// The same for another right-hand side.
template <bool bare, class V>
static inline void substitute_ring(const Molecules<V> &x, const Ring<V> &ring) {
    const V *reach = ring.reach, *to_last = ring.to_last;
    V carried = {}, y_of_last = {};
    const int32_t first = bare ? 0 : x.s.n_tree;
    for_ring<bare>(x.s, [&](int32_t before, int32_t slot, int k) HOL_FORCED {
        choose_number<0, bare ? 0 : most_on_ring>(k, [&](auto known) HOL_FORCED {
            if constexpr (known > 0) {
                const AtomRows<V> rows(x, slot);
                V y_to = x.row[before].t, y_from = x.row[slot].t;
                for (int a = 0; a < known; ++a) {
                    y_to = mul_add(reach[a], rows.bond(a).t, y_to);
                    y_from = mul_add(reach[known + a], rows.bond(a).t, y_from);
                }
                reach += 2 * known;
                x.row[before].t = y_to;
                x.row[slot].t = y_from;
                substitute_joint<known, true>(rows, known, Memory<V>());
            }
        });
        if (slot == first) return;
        BondRow<V> &row = x.row[before];
        const V y = row.t + carried;
        y_of_last = mul_add(*to_last++, y, y_of_last);
        carried = row.l * y;
        row.t = y * row.r;
    });
    BondRow<V> &row = x.row[x.s.n_bonds - 1];
    row.t = (row.t + y_of_last) * row.r;
}

// A bond's own size and its error per |d|, in squares: tree/siblings.hpp.
template <class V>
struct RingBond {
    V own, error, pull;
    HOL_FORCED explicit RingBond(const BondRow<V> &row)
        : own(mul_add(row.t, row.t, row.E * row.E)), error(row.q * (row.r * row.r)), pull(row.q * own) {}
};

// Looks at the k children of an atom of the ring and the two bonds of the ring. What u and t differ by, E of the rows
// and t, came from around the ring: both count as pulls. minus_per: - per_cancelled2.
template <int k, class V>
HOL_INLINE void look_at_ring_atom(Molecules<V> &x, int32_t before, int32_t slot, const RingBond<V> &to,
                                  const RingBond<V> &from, V minus_per) {
    const int32_t *const child = x.s.child + x.s.child_start[slot];
    V T2 = to.pull + from.pull;
    HOL_UNROLL_FEW
    for (int a = 0; a < k; ++a) T2 = mul_add(x.row[child[a]].q, x.row[child[a]].t * x.row[child[a]].t, T2);
    const V w = x.w[slot], minus_shared = (w * w) * (minus_per * T2);
    V least = min(mul_add(minus_shared, to.error, to.own), mul_add(minus_shared, from.error, from.own));
    HOL_UNROLL_FEW
    for (int a = 0; a < k; ++a) least = min(left_of(x.row[child[a]], -minus_shared), least);
    const MaskOf<V> faint = less(least, V{});
    if (__builtin_expect(!any(faint), 1)) return;
    const V shared = -minus_shared;  // in memory here alone
    for (int a = -2; a < k; ++a)
        doubt_faint_bond(x, a == -2 ? before : a < 0 ? slot : child[a], shared, bits(faint), x.slack);
}

// From u to t of the ring and of its atoms' children. `look`: tests the result, as down_joint() does.
template <bool look, bool bare, class V>
static inline void down_ring(Molecules<V> &x, const Ring<V> &ring) {
    const Schedule &s = x.s;
    const V *reach = ring.reach + 2 * static_cast<int64_t>(s.n_tree - s.child_start[s.n_tree]);
    const V last = x.row[s.n_bonds - 1].t, *to_last = ring.to_last + s.n_core - 1;
    const V minus_per = Width<V>::all(-x.per_cancelled2);
    V behind = last;
    RingBond<V> from(x.row[s.n_bonds - 1]);
    for (int32_t slot = s.n_bonds - 1; slot >= s.n_tree; --slot) {
        const bool first = slot == s.n_tree;
        const int32_t place = first ? s.n_bonds - 1 : slot - 1;
        BondRow<V> &row = x.row[place];
        V before = last;
        if (!first) row.t = before = mul_add(row.l, behind, mul_add(*--to_last, last, row.t));
        const RingBond<V> to(row);
        const int k = bare ? 0 : children_of(s, slot);
        reach -= 2 * k;
        choose_number<0, bare ? 0 : most_on_ring>(k, [&](auto known) HOL_FORCED {
            for (int a = 0; a < known; ++a) {
                BondRow<V> &child = x.row[s.child[s.child_start[slot] + a]];
                child.t = mul_add(reach[a], before, mul_add(reach[known + a], behind, child.t));
            }
            if (look) look_at_ring_atom<known>(x, place, slot, to, from, minus_per);
        });
        from = to;
        behind = before;
    }
}

}  // namespace holonomic::HOL_ISA::graph
