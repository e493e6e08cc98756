// Proves in lanes that the multipliers of molecules with cycles need no correction, by the bound of flat_proof.hpp on
// what they leave of the equations (theory (55a)). The part of trees needs no factors: an atom with k children adds at
// most 1 + k times w |d| |d'| to |L| P |L^T| for two of its bonds, because no eliminated child makes their products
// larger.
#pragma once

#include "core/kernels/molecules/cycles/core_matrix.hpp"
#include "core/kernels/molecules/cycles/residual.hpp"

namespace holonomic::HOL_ISA::graph {

// The bound must be no more than this times an equation's terms, both in roundings. This is a part of the 16 + sqrt(n)
// roundings of the scale that count as right (tests/oracle/molecules/README.md), and no more than in trees
// (siblings.hpp).
HOL_INLINE double most_backward(int32_t n_bonds) {
    const double part = 0.5 * (16 + __builtin_sqrt(static_cast<double>(n_bonds)));
    return part < most_cancelled ? part : most_cancelled;
}
// A pivot below this part of its diagonal element may come of bonds that depend on each other.
constexpr double least_proven_pivot = 1e-6;

// Of an atom: a = w (f + G), or v + w G where right-hand sides are rates; what a was made of, in absolute values; and
// the part of the bound that the atom gives per |d|.
template <class V>
struct Pulled {
    Vector3<V> a, input;
    V bound;
};

// Of a bond, in the same memory as its unrounded vector, which is found later.
template <class V>
struct Backward {
    V size, tension, R;  // |d|, |t| |d|, of the core |L| P |L^T| |t|
};

// Returns whether the proof is likely to succeed in all lanes of a block, so that it pays to try: with a few dozen
// bonds, half of them in trees at least. In strips of triangles it never succeeds.
HOL_INLINE bool worth_a_proof(const Schedule &s) { return s.n_bonds <= 64 && 2 * s.n_core <= s.n_bonds; }

template <class V>
HOL_INLINE Vector3<V> absolute(const Vector3<V> &a) {
    return {abs(a.x), abs(a.y), abs(a.z)};
}

template <class V>
HOL_INLINE void find_core_bound(const Molecules<V> &x, const CoreMatrix<V> &core, Backward<V> *bond) {
    const Schedule &s = x.s;
    const BondRow<V> *const row = x.row + s.n_tree;
    for (int32_t p = s.n_core - 1; p >= 0; --p) {
        V sum = abs(row[p].t);
        for (int32_t e = s.column_start[p]; e < s.column_start[p + 1]; ++e)
            sum = mul_add(abs(core.entry[e]), abs(row[s.row[e]].t), sum);
        const V all = row[p].E * sum;
        bond[s.n_tree + p].R = all;
        for (int32_t e = s.column_start[p]; e < s.column_start[p + 1]; ++e) {
            V &R = bond[s.n_tree + s.row[e]].R;
            R = mul_add(abs(core.entry[e]), all, R);
        }
    }
}

template <class V>
HOL_INLINE Pulled<V> pulled(const Molecules<V> &x, const Equations<V> &e, const Backward<V> *bond, int32_t slot) {
    Vector3<V> g = {};
    V sum = {};
    for_bonds_of<V>(x.s, slot, [&](int32_t place, auto sign) HOL_FORCED {
        g = add_times(g, sign * x.row[place].t, x.row[place].d);
        sum = sum + bond[place].tension;
    });
    const V w = x.w[slot];
    const int32_t children = x.s.child_start[slot + 1] - x.s.child_start[slot];
    const Vector3<V> input = e.input_of(slot, w);
    return {add_times(input, w, g), absolute(input), (Width<V>::all(1.0 + children) * w) * sum};
}

// Returns the lanes in which the bound holds for the solution in t of the rows. E of the core's rows are their pivots.
template <class V>
HOL_NOINLINE MaskOf<V> proven_lanes(const Molecules<V> &x, const CoreMatrix<V> &core, const Equations<V> &e, V least) {
    const Schedule &s = x.s;
    static_assert(sizeof(Pulled<V>) == 7 * sizeof(V) && sizeof(Backward<V>) <= sizeof(Pair3<V>), "");
    Pulled<V> *const atom = reinterpret_cast<Pulled<V> *>(e.a);
    Backward<V> *const bond = reinterpret_cast<Backward<V> *>(e.d);
    for (int32_t k = 0; k < s.n_bonds; ++k) {
        bond[k].size = sqrt(x.row[k].q);
        bond[k].tension = abs(x.row[k].t) * bond[k].size;
        bond[k].R = V{};
    }
    find_core_bound(x, core, bond);
    for (int32_t slot = 0; slot < s.n_atoms; ++slot) atom[slot] = pulled(x, e, bond, slot);
    const V most = Width<V>::all(most_backward(s.n_bonds));
    for (int32_t k = 0; k < s.n_bonds; ++k) {
        int32_t from, to;
        ends_of(s, k, from, to);
        const Pulled<V> &i = atom[from], &j = atom[to];
        const Vector3<V> &d = x.row[k].d;
        V terms = abs(dot(d, i.a)) + abs(dot(d, j.a)) + dot(absolute(d), i.input + j.input);
        if (e.velocity) {
            const Vector3<V> dv = e.velocity[to] - e.velocity[from];
            terms = terms + dot(dv, dv);
        }
        if (e.given) terms = terms + abs(e.given[k]);
        least = min(mul_add(most, terms, -mul_add(bond[k].size, i.bound + j.bound, bond[k].R)), least);
        if (k < s.n_tree) continue;
        const V whole = (x.w[from] + x.w[to]) * x.row[k].q;
        least = min(mul_add(Width<V>::all(-least_proven_pivot), whole, x.row[k].E), least);
    }
    return less_equal(V{}, least);
}

}  // namespace holonomic::HOL_ISA::graph
