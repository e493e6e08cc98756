// A block of molecules of one shape: what is known of their atoms and bonds while they are solved.
#pragma once

#include "core/kernels/arithmetic/thresholds.hpp"
#include "core/kernels/arithmetic/vector3.hpp"
#include "core/kernels/atom.hpp"
#include "core/kernels/molecules/atoms/layout.hpp"
#include "core/kernels/molecules/image.hpp"
#include "core/plan/elimination.hpp"

namespace holonomic::HOL_ISA::graph {

// A bond at its index (core/plan/elimination.hpp).
template <class V>
struct BondRow {
    Vector3<V> d;
    V q;  // d.d
    V E;  // inverse mass that what hangs on the bond offers along it, times q; of the core: the pivot
    V t;  // right-hand side y, then u, then the solution
    V l;  // what the bond above gets of y, and this one of its t
    V r;  // 1 / pivot
};

// What right-hand sides are made of; absent ones are nullptr, or arrays without x.
struct Inputs {
    const AtomArray *v, *f;
    const double *rhs;
    bool rates;                      // d.(v_j - v_i) instead of |v_j - v_i|^2
    const double *strain = nullptr;  // added to rates: arithmetic/vector3.hpp
};

template <class V>
struct Molecules {
    const EliminationPlan &s;
    const MoleculeLane *lane;  // of all lanes; those without a molecule repeat the first one
    int used;                  // lanes with a molecule
    Atoms<V> at;
    const Box *box;
    const AtomArray *r;  // of the bond vectors, for what is computed anew
    V *w;                // [n_atoms] by index
    BondRow<V> *row;     // [n_bonds] by bond index
    V *pair;             // [n_pairs] multipliers among the children of an atom
    V margin;            // negative where plain products do not do
    Inputs in;
    double per_cancelled2 = 1 / (most_cancelled * most_cancelled);  // 1 / most_cancelled2()

    MaskOf<V> in_use() const { return Width<V>::first(used); }
};

// Lanes in which squares of bonds are ordinary (call.hpp), from the least and from a sum of all, or the largest. For
// products of n of them, largest^n.
template <class V>
HOL_INLINE MaskOf<V> ordinary_squares(const V &least, const V &largest, double most = most_ordinary_square) {
    return less(largest, Width<V>::all(most)) & less(Width<V>::all(1 / most), least);
}

// Of large molecules all pivots and their reciprocals are below this, or their units are not ordinary: segments of arms
// do products of six.
constexpr double most_ordinary_pivot = 0x1p120;
constexpr double most_of_three = most_ordinary_square * most_ordinary_square * most_ordinary_square;

// A vector component by component: as a structure gcc copies it as memory (docs/development/trials.md).
template <class V>
HOL_INLINE void put(Vector3<V> &to, const Vector3<V> &a) {
    to.x = a.x;
    to.y = a.y;
    to.z = a.z;
}

// Inverse masses by index.
template <class V>
HOL_INLINE void masses_by_index(const EliminationPlan &s, const MoleculeLane *lane, V *w) {
    for (int32_t index = 0; index < s.n_atoms; ++index)
        for (int i = 0; i < Width<V>::lanes; ++i) Width<V>::set(w[index], i, lane[i].w[s.atom_of[index]]);
}

// Finds the indices at the two ends of a bond. It points from the first to the second.
HOL_INLINE void ends_of(const EliminationPlan &s, int32_t bond_index, int32_t &from, int32_t &to) {
    from = bond_index < s.n_tree ? s.parent[bond_index] : s.from[bond_index - s.n_tree];
    to = bond_index < s.n_tree ? bond_index : s.to[bond_index - s.n_tree];
}

// Finds a bond vector of one lane, with the low word that the difference of the coordinates leaves.
template <class V>
HOL_INLINE void exact_bond(const Molecules<V> &x, int lane, int32_t bond_index, Vector3<double> &d,
                           Vector3<double> &lo) {
    int32_t from, to;
    ends_of(x.s, bond_index, from, to);
    Vector3<double> a, b;
    read_atom(*x.r, x.at.number(lane, x.s.atom_of[from]), &a.x);
    read_atom(*x.r, x.at.number(lane, x.s.atom_of[to]), &b.x);
    unrounded_bond(*x.box, a, b, d, lo);
}

template <class V>
HOL_NOINLINE V dots_anew(const Molecules<V> &x, int32_t a, int32_t b, unsigned which, V g) {
    for (unsigned left = which; left; left &= left - 1) {
        const int i = __builtin_ctz(left);
        Vector3<double> d[2], low[2];
        exact_bond(x, i, a, d[0], low[0]);
        exact_bond(x, i, b, d[1], low[1]);
        Width<V>::set(g, i, dot_compensated(d[0], low[0], d[1], low[1]));
    }
    return g;
}

template <class V>
HOL_INLINE MaskOf<V> nearly_orthogonal(const V &g, const V &p, const V &q) {
    return less(Width<V>::all(1 / (small_cosine * small_cosine)) * (g * g), p * q);
}

// Returns d . d' of two bonds, by the rule above.
template <class V>
HOL_INLINE V product_of(const Molecules<V> &x, int32_t a, int32_t b) {
    const BondRow<V> &p = x.row[a], &q = x.row[b];
    const V g = dot(p.d, q.d);
    const MaskOf<V> small = nearly_orthogonal(g, p.q, q.q);
    if (__builtin_expect(any(small), 0)) return dots_anew(x, a, b, bits(small), g);
    return g;
}

}  // namespace holonomic::HOL_ISA::graph
