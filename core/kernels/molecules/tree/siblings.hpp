// A multiplier may be a small difference of large terms where bonds meet at an atom of a tree: if its bond is not
// pulled itself, but a sibling or the parent is. The products d.d' at atom i are right to a rounding of |d| |d'|. So
// with the sum T of the tensions |t| |d| around the atom, t_c is right to a few roundings of
//
//     w_i |d_c| T r_c,   r_c = 1 / pivot,
//
// beside what its scale |A^-1| S (docs/theory.md) allows. That scale is at least
//   - |t_c|;
//   - |y_c| r_c, as c and the bonds below it are pulled by y_c, and r_c <= (A^-1)_cc;
//   - S_c / A_cc, where S_c are the terms of its right-hand side in absolute values.
// A bond is `cancelling` if none of these is large enough. The first two are always looked at, the third if they don't
// do.
#pragma once

#include "core/kernels/atom.hpp"
#include "core/kernels/molecules/tree/many.hpp"

namespace holonomic::HOL_ISA::graph {

// The bonds of an atom, each at its index: those to its children, and the one above. known: as in NewtonAtom, not for
// atoms of a core.
// tree_batch/sweeps.hpp has the same for atoms in lanes.
template <class V, int known = 0>
struct AtomRows {
    const Molecules<V> &x;
    const int32_t index, first, *const child;

    AtomRows(const Molecules<V> &m, int32_t s) : x(m), index(s), first(m.s.child_start[s]), child(m.s.child + first) {}
    HOL_FORCED V w() const { return x.w[index]; }
    HOL_FORCED int32_t bond_index(int a) const { return known > 0 && Width<V>::lanes > 1 ? first + a : child[a]; }
    HOL_FORCED BondRow<V> &bond(int a) const { return x.row[bond_index(a)]; }
    HOL_FORCED BondRow<V> &above() const { return x.row[index]; }
    // Of a child with the bond above; of a single one by the rule of product_of().
    HOL_FORCED V product(int a, int k) const {
        return k == 1 ? product_of(x, bond_index(0), index) : dot(bond(a).d, above().d);
    }
    HOL_FORCED V *multipliers() const { return x.pair + x.s.pair_start[index]; }
};

// Returns the square of that part of the error which all bonds at an atom share.
template <class V, class Rows>
HOL_INLINE V shared_error(const Rows &x, int k) {
    const BondRow<V> &e = x.above();
    V T2 = e.q * (e.t * e.t);
    if (k > most_decomposed) {
        const V *const kept = x.multipliers();
        return kept[of_rounding] * (x.x.per_cancelled2 * (T2 + kept[of_pulls]));
    }
    HOL_UNROLL_FEW
    for (int a = 0; a < k; ++a) {
        const BondRow<V> &row = x.bond(a);
        T2 = mul_add(row.q, row.t * row.t, T2);
    }
    const V w = x.w();
    return (w * w) * (x.x.per_cancelled2 * T2);
}

// Returns a bond's own size less the error, in squares. It is negative if the bond is cancelling.
template <class V>
HOL_INLINE V left_of(const BondRow<V> &row, const V &shared) {
    return mul_add(-shared, row.q * (row.r * row.r), mul_add(row.t, row.t, row.E * row.E));
}

// Returns the lanes in which a bond at this atom is cancelling, the one above it or one of its k children. E of the
// rows is y r.
template <class V, class Rows>
HOL_INLINE MaskOf<V> cancelling_bonds(const Rows &x, int k) {
    const V shared = shared_error<V>(x, k);
    V least = left_of(x.above(), shared);
    HOL_UNROLL_FEW
    for (int a = 0; a < k; ++a) least = min(left_of(x.bond(a), shared), least);
    return less(least, V{});
}

// Returns the terms of a right-hand side in absolute values: of a bond d between two atoms, given by their numbers in
// the caller's arrays and their inverse masses.
HOL_NOINLINE double terms_of(const Inputs &in, const double *d, const int64_t *number, const double *w) {
    double sum = 0, v[2][3] = {};
    for (int e = 0; e < 2; ++e) {
        double f[3] = {};
        if (in.v->x) read_atom(*in.v, number[e], v[e]);
        if (in.f && in.f->x) read_atom(*in.f, number[e], f);
        for (int c = 0; c < 3; ++c) sum += w[e] * __builtin_fabs(d[c] * f[c]);
        for (int c = 0; c < 3 && in.rates; ++c) sum += __builtin_fabs(d[c] * v[e][c]);
    }
    for (int a = 0, e = 0; a < 3 && in.strain; ++a)
        for (int b = a; b < 3; ++b, ++e) sum += __builtin_fabs(in.strain[e] * d[a] * d[b]);
    for (int c = 0; c < 3 && !in.rates; ++c) sum += (v[1][c] - v[0][c]) * (v[1][c] - v[0][c]);
    return sum;
}

// Those of a bond at an index, in one lane.
template <class V>
double terms_of(const Molecules<V> &x, const BondRow<V> &row, int32_t bond_index, int lane) {
    if (x.in.rhs) return __builtin_fabs(0.5 * x.in.rhs[x.lane[lane].first_bond + x.s.bond_of[bond_index]]);
    const double d[3] = {Width<V>::get(row.d.x, lane), Width<V>::get(row.d.y, lane), Width<V>::get(row.d.z, lane)};
    int32_t end[2];
    ends_of(x.s, bond_index, end[0], end[1]);
    const int64_t number[2] = {x.at.number(lane, x.s.atom_of[end[0]]), x.at.number(lane, x.s.atom_of[end[1]])};
    const double w[2] = {Width<V>::get(x.w[end[0]], lane), Width<V>::get(x.w[end[1]], lane)};
    return terms_of(x.in, d, number, w);
}

// Looks again at a bond in the lanes of `which`. Slack becomes negative where it is cancelling all the same.
template <class V>
HOL_NOINLINE void flag_cancelling_bond(const Molecules<V> &x, const BondRow<V> &row, int32_t bond_index,
                                       const V &shared, unsigned which, V &margin) {
    const V left = left_of(row, shared);
    int32_t from, to;
    ends_of(x.s, bond_index, from, to);
    const V A = (x.w[from] + x.w[to]) * row.q;
    for (unsigned rest = which & bits(less(left, V{})); rest; rest &= rest - 1) {
        const int i = __builtin_ctz(rest);
        const double own = terms_of(x, row, bond_index, i) / Width<V>::get(A, i);
        if (!(Width<V>::get(left, i) + own * own >= 0)) Width<V>::set(margin, i, -1);
    }
}
// The same for all bonds of an atom of a tree.
template <class V>
HOL_NOINLINE void flag_cancelling_bonds(const Molecules<V> &x, int32_t index, int k, unsigned which, V &margin) {
    const int32_t *const child = x.s.child + x.s.child_start[index];
    const V shared = shared_error<V>(AtomRows<V>(x, index), k);
    for (int a = -1; a < k; ++a) {
        const int32_t bond_index = a < 0 ? index : child[a];
        flag_cancelling_bond(x, x.row[bond_index], bond_index, shared, which, margin);
    }
}

}  // namespace holonomic::HOL_ISA::graph
