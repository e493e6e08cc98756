// Writes what comes of the multipliers of a block of molecules: values per bond, pulls on atoms, the virial.
#pragma once

#include "core/kernels/molecules/atoms/vectors.hpp"
#include "core/kernels/molecules/molecules.hpp"
#include "core/kernels/molecules/virial.hpp"

namespace holonomic::HOL_ISA::graph {

// Returns G of the atom of a tree at an index: t d of the bonds to its children, less t d of that to its parent.
HOL_INLINE Vector3<double> pull_on(const Molecules<double> &x, int32_t index) {
    const EliminationPlan &s = x.s;
#if HOL_LANES >= 4 && defined(__AVX2__)
    quad g = {};  // rows begin with d, so x, y and z are done at once
    for (int32_t c = s.child_start[index]; c < s.child_start[index + 1]; ++c) {
        const BondRow<double> &row = x.row[s.child[c]];
        g = _mm256_fmadd_pd(_mm256_set1_pd(row.t), _mm256_loadu_pd(&row.d.x), g);
    }
    if (index < s.n_tree) {
        const BondRow<double> &row = x.row[index];
        g = _mm256_fnmadd_pd(_mm256_set1_pd(row.t), _mm256_loadu_pd(&row.d.x), g);
    }
    return {g[0], g[1], g[2]};
#else
    Vector3<double> g = {};
    for (int32_t c = s.child_start[index]; c < s.child_start[index + 1]; ++c)
        g = add_times(g, x.row[s.child[c]].t, x.row[s.child[c]].d);
    return index < s.n_tree ? add_times(g, -x.row[index].t, x.row[index].d) : g;
#endif
}

// Where the results of a linear solve go.
struct LinearOutputs {
    const AtomArray *g;  // or nullptr
    double *lambda, *tension;
    bool add, virial;
};

// Writes value(index) of the atoms of one molecule in these indices.
template <class Value>
HOL_INLINE void write_indices(const Molecules<double> &x, const AtomArray &array, int32_t first, int32_t end,
                              const Value &value) {
    const unsigned char *const shared = x.lane[0].shared;
    if (x.at.layout == rows_in_order && !shared) {
        double *const base = reinterpret_cast<double *>(array.x) + 3 * x.at.first[0];
        for (int32_t index = end; index-- > first;) {
            if (index >= first + rows_ahead) fetch_row<1>(array, 3 * (x.at.first[0] + x.s.atom_of[index - rows_ahead]));
            double *const p = base + 3 * static_cast<int64_t>(x.s.atom_of[index]);
            write_rows(&p, value(index));
        }
        return;
    }
    for (int32_t index = end; index-- > first;) {
        const int32_t atom = x.s.atom_of[index];
        if (!(shared && shared[atom])) write(array, x.at, atom, value(index), 1);
    }
}

// Puts G of the root's or the ring's atoms to pull[index]; to that of their children what the bond above pulls.
template <class V>
HOL_INLINE void pull_top(const Molecules<V> &x, Vector3<V> *pull) {
    const EliminationPlan &s = x.s;
    if (s.type == EliminationPlan::ring) {
        const auto of_bond = [&](int32_t bond_index) HOL_FORCED { return x.row[bond_index].t * x.row[bond_index].d; };
        Vector3<V> before = of_bond(s.n_bonds - 1);
        for (int32_t index = s.n_tree; index < s.n_atoms; ++index) {
            const Vector3<V> behind = of_bond(index);
            put(pull[index], Vector3<V>{} + (behind - before));  // zeros as +0
            put(before, behind);
        }
    } else {
        put(pull[s.n_tree], Vector3<V>{});
    }
    for (int32_t c = s.child_start[s.n_tree]; c < s.n_tree; ++c) {
        const int32_t child = s.child[c], parent = s.parent[child];
        const BondRow<V> &row = x.row[child];
        put(pull[child], add_times(Vector3<V>{}, -row.t, row.d));
        put(pull[parent], add_times(pull[parent], row.t, row.d));
    }
}

// Writes value(bond_index) of the bonds at these indices to out[bond] of the lanes in `which`. To look whether four
// bonds follow each other takes more instructions than it saves, in rings, too.
template <class V, class Value>
HOL_INLINE void write_values(const int32_t *bond_of, const int64_t *first_bond, double *out, unsigned which,
                             int32_t first, int32_t end, const Value &value) {
    double *p[Width<V>::lanes];
    for (int i = 0; i < Width<V>::lanes; ++i) p[i] = out + first_bond[i];
    const bool all = which == (1u << Width<V>::lanes) - 1;
    for (int32_t k = first; k < end; ++k) {
        if (Width<V>::lanes == 1 && k + rows_ahead < end) __builtin_prefetch(p[0] + bond_of[k + rows_ahead], 1, 2);
        const int32_t bond = bond_of[k];
        const V one = value(k);
        if (all) {
            HOL_UNROLL
            for (int i = 0; i < Width<V>::lanes; ++i) p[i][bond] = Width<V>::get(one, i);
        } else {
            for (int i = 0; i < Width<V>::lanes; ++i)
                if (which >> i & 1) p[i][bond] = Width<V>::get(one, i);
        }
    }
}

template <class V, class Value>
HOL_INLINE void write_values(const int32_t *bond_of, const MoleculeLane *lane, double *out, unsigned which,
                             int32_t first, int32_t end, const Value &value) {
    int64_t first_bond[Width<V>::lanes];
    for (int i = 0; i < Width<V>::lanes; ++i) first_bond[i] = lane[i].first_bond;
    write_values<V>(bond_of, first_bond, out, which, first, end, value);
}

// Writes factor t of the bonds at these indices, zeros as +0. with_length: |d| is the factor.
template <bool with_length, class V>
HOL_INLINE void write_bonds(const Molecules<V> &x, double factor, double *out, unsigned which, int32_t first,
                            int32_t end) {
    const V f = Width<V>::all(factor);
    write_values<V>(x.s.bond_of, x.lane, out, which, first, end, [&](int32_t k) HOL_FORCED {
        const BondRow<V> &row = x.row[k];
        return mul_add(row.t, with_length ? sqrt(row.q) : f, V{});
    });
}
// Writes those of all bonds.
template <bool with_length, class V>
HOL_NOINLINE void write_bonds(const Molecules<V> &x, double factor, double *out, unsigned which) {
    write_bonds<with_length>(x, factor, out, which, 0, x.s.n_bonds);
}

// Counts the virial of all bonds, in the lanes of `which`.
template <class V>
HOL_NOINLINE void add_pulls_to_virial(const Molecules<V> &x, unsigned which, Tally &tally) {
    const BondRow<V> *const row = x.row;
    add_virial<V>(
        0, x.s.n_bonds, [=](int32_t k) HOL_FORCED { return row[k].d; }, [=](int32_t k) HOL_FORCED { return row[k].t; },
        1, which, tally);
}

// Returns the lanes in which all multipliers are finite, and products of bonds can't have overflowed or underflowed.
template <class V>
HOL_INLINE MaskOf<V> finite_solution(const Molecules<V> &x) {
    V sum = {}, sum_of_squares = {}, least = Width<V>::all(1);
    for (int32_t k = 0; k < x.s.n_bonds; ++k) {
        sum = mul_add(x.row[k].t, V{}, sum);  // 0, and NaN once one is not finite
        sum_of_squares = sum_of_squares + x.row[k].q;
        least = min(x.row[k].q, least);
    }
    return finite(sum) & ordinary_squares(least, sum_of_squares);
}

}  // namespace holonomic::HOL_ISA::graph
