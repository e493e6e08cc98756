// The equations of a molecule with one ring, once the trees that hang from it are eliminated. The bonds of the ring are
// a chain of all but the last one, and that one: LDL^T, each row coupled to the next one and, by fill, to the last. It
// subtracts. That it may is shown by another one beside it, of the matrix with what rounding may do to it taken off its
// diagonal, many times over: `margin` is negative where a pivot of that is not positive (theory (57b)).
//
// Bond p of the ring, at bond index n_tree + p, points from index n_tree + p to the next one: the bond *behind* this
// atom, as p - 1 is the one *before* it.
#pragma once

#include "core/kernels/arithmetic/thresholds.hpp"
#include "core/kernels/molecules/tree/joint.hpp"

namespace holonomic::HOL_ISA::graph {

template <class V>
struct RingLinear {
    V *to_last;  // [n_core] what the last row gets of y of each, and each of the last one's t
    V *reach;  // for every atom of the ring: the same of its children with the bond before it, then with the one behind
    static int64_t values(const EliminationPlan &s) { return s.n_core + 2 * static_cast<int64_t>(s.n_tree); }
};

// What an atom gives to the diagonal elements of the bonds before and behind it, and to what couples them.
template <class V>
struct RingShare {
    V before, behind, between;
};
// And what a rounding of all that these are made of does to them.
template <class V>
struct RingJoint {
    RingShare<V> share, error;
    V margin;
};

// L D L^T of the rows of a ring, one after the other; the last one last.
template <class V>
struct RingPivots {
    V diagonal, coupling, taken, last, taken_of_last;  // coupling: of the row to the last one
    V to_next, to_last;                                // of the row eliminated last, over its pivot
    void start(const RingShare<V> &joint) { *this = {joint.behind, joint.between, V{}, joint.before, V{}, V{}, V{}}; }
    HOL_FORCED V whole(const RingShare<V> &joint) const { return diagonal + joint.before; }
    HOL_FORCED V pivot(const RingShare<V> &joint) const { return whole(joint) - taken; }
    V last_pivot() const { return last - taken_of_last; }
    // Takes the row, with 1 / pivot, from the next one and the last one. is_end: these two are the same.
    HOL_FORCED void eliminate(const RingShare<V> &joint, const V &r, bool is_end) {
        V between = joint.between;
        if (is_end) {
            coupling = coupling + between;
            between = V{};
            last = last + joint.behind;
        }
        to_next = between * r;
        to_last = coupling * r;
        taken_of_last = mul_add(to_last, coupling, taken_of_last);
        taken = to_next * between;
        coupling = to_last * between;
        diagonal = joint.behind;
    }
};

HOL_INLINE int32_t children_of(const EliminationPlan &s, int32_t index) {
    return s.child_start[index + 1] - s.child_start[index];
}
// Calls body(before, index, k) for the atoms of the ring: the index of the bond before it, its index, which is that
// of the one behind, and its number of children; bare: none has any.
template <bool bare, class Body>
HOL_INLINE void for_ring(const EliminationPlan &s, const Body &body) {
    int32_t before = s.n_bonds - 1;
    for (int32_t index = bare ? 0 : s.n_tree; index < s.n_atoms; ++index) {
        body(before, index, bare ? 0 : children_of(s, index));
        before = index;
    }
}

// Eliminates the children of an atom of the ring, as up_joint() does, for two bonds in place of one.
template <int known, class V>
HOL_INLINE RingJoint<V> up_ring_joint(const Molecules<V> &x, int32_t before, int32_t index, V *reach, V margin) {
    constexpr int k = known;
    const AtomRows<V> rows(x, index);
    JointMemory<V, known> f = {};
    V z_to[known];
    const V w = rows.w();
    decompose(rows, k, w, f.S, f.r, f.m, margin);
    V *const m = rows.multipliers();
    BondRow<V> &to = x.row[before], &from = x.row[index];
    const V whole_to = w * to.q, whole_from = w * from.q;
    V between = w * dot(to.d, from.d), left_to = whole_to, left_from = whole_from, y_to = to.t, y_from = from.t;
    V error_to = whole_to, error_from = whole_from, error_between = {}, error[known];
    HOL_UNROLL_FEW
    for (int a = 0; a < k; ++a) f.y[a] = w * dot(rows.bond(a).d, to.d);
    solve_joint(k, f.r, f.m, f.y, z_to, f.l);
    HOL_UNROLL_FEW
    for (int a = 0; a < k; ++a) {
        left_to = mul_add(-(z_to[a] * f.r[a]), z_to[a], left_to);
        y_to = mul_add(f.l[a], rows.bond(a).t, y_to);
        reach[a] = f.l[a];
        // E of the child may be small, as the difference of what its own children leave.
        const V own = x.w[rows.bond_index(a)] * rows.bond(a).q;
        error[a] = mul_add(w, rows.bond(a).q, own * min(own / rows.bond(a).E, Width<V>::all(1 / least_part)));
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
        error_between = mul_add(reach[a] * f.l[a], error[a], error_between);
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
    return {{left_to, left_from, between}, {error_to, error_from, error_between}, margin};
}

// From right-hand sides to u of the ring and of the children of its atoms, all in t of the rows.
template <bool bare, class V>
static inline void up_ring(Molecules<V> &x, const RingLinear<V> &ring) {
    V *reach = ring.reach, *to_last = ring.to_last;
    RingPivots<V> pivots = {}, lowered = {};
    V carried = {}, y_of_last = {}, margin = x.margin;
    const V part = Width<V>::all(-1 / most_roundings(x.s.n_bonds)), left = Width<V>::all(1) + part,
            least = Width<V>::all(-least_lowered_part), one = Width<V>::all(1);
    const int32_t first = bare ? 0 : x.s.n_tree, end = x.s.n_bonds - 1;
    for_ring<bare>(x.s, [&](int32_t before, int32_t index, int k) HOL_FORCED {
        RingShare<V> joint, low;
        BondRow<V> &row = x.row[before];
        if (k == 0) {
            const V w = x.w[index];
            joint = {w * row.q, w * x.row[index].q, w * dot(row.d, x.row[index].d)};
            low = {left * joint.before, left * joint.behind, joint.between};
        } else {
            const RingJoint<V> whole_joint = choose_number<1, most_on_ring>(
                k, [=](auto known) HOL_FORCED { return up_ring_joint<known>(x, before, index, reach, margin); });
            reach += 2 * k;
            margin = whole_joint.margin;
            joint = whole_joint.share;
            const RingShare<V> &error = whole_joint.error;
            low = {mul_add(part, error.before, joint.before), mul_add(part, error.behind, joint.behind),
                   mul_add(part, error.between, joint.between)};
        }
        if (index == first) {
            pivots.start(joint);
            lowered.start(low);
            return;
        }
        const V low_P = lowered.pivot(low), r = one / pivots.pivot(joint), y = row.t + carried;
        margin = min(mul_add(least, pivots.whole(joint), low_P), margin);
        row.r = r;
        row.t = row.E = y * r;
        lowered.eliminate(low, one / low_P, index == end);
        pivots.eliminate(joint, r, index == end);
        row.l = pivots.to_next;
        *to_last++ = pivots.to_last;
        y_of_last = mul_add(pivots.to_last, y, y_of_last);
        carried = pivots.to_next * y;
    });
    BondRow<V> &row = x.row[end];
    x.margin = min(mul_add(least, pivots.last, lowered.last_pivot()), margin);
    row.r = one / pivots.last_pivot();
    row.t = row.E = (row.t + y_of_last) * row.r;
}

// The same for another right-hand side, of forces and velocities or of Newton's method. to_next(row): the multiplier of
// a row of the ring in the one behind it. joint(rows, known): substitutes the children of an atom.
template <bool bare, class Rows, class V, class System, class ToNext, class Joint>
HOL_INLINE void substitute_ring(const System &x, const V *reach, const V *to_last, const ToNext &to_next,
                                const Joint &joint) {
    V carried = {}, y_of_last = {};
    const int32_t first = bare ? 0 : x.s.n_tree;
    for_ring<bare>(x.s, [&](int32_t before, int32_t index, int k) HOL_FORCED {
        choose_number<0, bare ? 0 : most_on_ring>(k, [&](auto known) HOL_FORCED {
            if constexpr (known > 0) {
                const Rows rows(x, index);
                V y_to = x.row[before].t, y_from = x.row[index].t;
                for (int a = 0; a < known; ++a) {
                    y_to = mul_add(reach[a], rows.bond(a).t, y_to);
                    y_from = mul_add(reach[known + a], rows.bond(a).t, y_from);
                }
                reach += 2 * known;
                x.row[before].t = y_to;
                x.row[index].t = y_from;
                joint(rows, known);
            }
        });
        if (index == first) return;
        auto &row = x.row[before];
        const V y = row.t + carried;
        y_of_last = mul_add(*to_last++, y, y_of_last);
        carried = to_next(row) * y;
        row.t = y * row.r;
    });
    auto &row = x.row[x.s.n_bonds - 1];
    row.t = (row.t + y_of_last) * row.r;
}
template <bool bare, class V>
static inline void substitute_ring(const Molecules<V> &x, const RingLinear<V> &ring) {
    substitute_ring<bare, AtomRows<V>, V>(
        x, ring.reach, ring.to_last, [](const BondRow<V> &row) HOL_FORCED { return row.l; },
        [](const AtomRows<V> &rows, auto known)
            HOL_FORCED { substitute_joint<known, true>(rows, known, Memory<V>()); });
}

// A bond's own size and its error per |d|, in squares: tree/siblings.hpp.
template <class V>
struct RingBond {
    V own, error, pull;
    HOL_FORCED explicit RingBond(const BondRow<V> &row)
        : own(mul_add(row.t, row.t, row.E * row.E)), error(row.q * (row.r * row.r)), pull(row.q * own) {}
};

// Looks at the k children of an atom of the ring and the two bonds of the ring. What u and t differ by, E of the rows
// and t, came from around the ring: both count as pulls.
template <int k, class V>
HOL_INLINE void look_at_ring_atom(Molecules<V> &x, int32_t before, int32_t index, const RingBond<V> &to,
                                  const RingBond<V> &from) {
    const int32_t *const child = x.s.child + x.s.child_start[index];
    V T2 = to.pull + from.pull;
    HOL_UNROLL_FEW
    for (int a = 0; a < k; ++a) T2 = mul_add(x.row[child[a]].q, x.row[child[a]].t * x.row[child[a]].t, T2);
    const V w = x.w[index], shared = (w * w) * (x.per_cancelled2 * T2);
    V least = min(mul_add(-shared, to.error, to.own), mul_add(-shared, from.error, from.own));
    HOL_UNROLL_FEW
    for (int a = 0; a < k; ++a) least = min(left_of(x.row[child[a]], shared), least);
    const MaskOf<V> cancelling = less(least, V{});
    if (__builtin_expect(!any(cancelling), 1)) return;
    for (int a = -2; a < k; ++a) {
        const int32_t bond_index = a == -2 ? before : a < 0 ? index : child[a];
        flag_cancelling_bond(x, x.row[bond_index], bond_index, shared, bits(cancelling), x.margin);
    }
}

// From u to t of the ring and of its atoms' children. `look`: tests the result, as down_joint() does.
template <bool look, bool bare, class V>
static inline void down_ring(Molecules<V> &x, const RingLinear<V> &ring) {
    const EliminationPlan &s = x.s;
    const V *reach = ring.reach + 2 * static_cast<int64_t>(s.n_tree - s.child_start[s.n_tree]);
    const V last = x.row[s.n_bonds - 1].t, *to_last = ring.to_last + s.n_core - 1;
    V behind = last;
    RingBond<V> from(x.row[s.n_bonds - 1]);
    for (int32_t index = s.n_bonds - 1; index >= s.n_tree; --index) {
        const bool first = index == s.n_tree;
        const int32_t bond_index = first ? s.n_bonds - 1 : index - 1;
        BondRow<V> &row = x.row[bond_index];
        V before = last;
        if (!first) row.t = before = mul_add(row.l, behind, mul_add(*--to_last, last, row.t));
        const RingBond<V> to(row);
        const int k = bare ? 0 : children_of(s, index);
        reach -= 2 * k;
        choose_number<0, bare ? 0 : most_on_ring>(k, [&](auto known) HOL_FORCED {
            for (int a = 0; a < known; ++a) {
                BondRow<V> &child = x.row[s.child[s.child_start[index] + a]];
                child.t = mul_add(reach[a], before, mul_add(reach[known + a], behind, child.t));
            }
            if (look) look_at_ring_atom<known>(x, bond_index, index, to, from);
        });
        from = to;
        behind = before;
    }
}

}  // namespace holonomic::HOL_ISA::graph
