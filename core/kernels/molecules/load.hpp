// Reads a block of molecules: each atom once, then bond vectors and right-hand sides at their indices.
#pragma once

#include "core/kernels/memory/packed.hpp"
#include "core/kernels/molecules/atoms/vectors.hpp"
#include "core/kernels/molecules/linear.hpp"

namespace holonomic::HOL_ISA::graph {

// Terms (memory/packed.hpp) of the right-hand side b of a bond from atom i to atom j, as they are called here:
// squares: |v_j - v_i|^2;  pulls: d.(w_j f_j - w_i f_i);  rates: d.(v_j - v_i);  given: half of the bond's given value.
constexpr int squares = velocity_squared, pulls = force_difference, rates = rate;

template <class V>
struct Loader {
    TreeLinear<V> &z;
    const int terms;

    bool has(int wanted) const { return (terms & wanted) != 0; }

    void read_atoms(const AtomArray &array, ByIndex<V> to) const {
        read_vectors(array, z.x.at, z.x.s.index_of, z.x.s.n_atoms, to);
    }

    // b + d.(w f - w0 f0)
    HOL_STATIC V with_pull(const Vector3<V> &d, V w0, const Vector3<V> &f0, V w, const Vector3<V> &f, V b) {
        const Vector3<V> df = difference(w, f, w0, f0);
        return mul_add(d.z, df.z, mul_add(d.y, df.y, mul_add(d.x, df.x, b)));
    }

    // Makes d, q and t of the bond between the atoms at two indices. `rhs_terms`: the terms.
    HOL_FORCED void make_row(int rhs_terms, int32_t bond_index, int32_t from, int32_t to) const {
        BondRow<V> &row = z.x.row[bond_index];
        Vector3<V> d = z.r[to] - z.r[from], unused = {};
        take_image<false>(*z.x.box, d, unused);
        V b = {};
        if (rhs_terms & squares) {
            const Vector3<V> dv = z.v[to] - z.v[from];
            b = dot(dv, dv);
        }
        if (rhs_terms & rates) {
            b = dot(d, z.v[to] - z.v[from]);
            if (z.x.in.strain) b = b + stretching(z.x.in.strain, d);
        }
        if (rhs_terms & pulls) b = with_pull(d, z.x.w[from], z.f[from], z.x.w[to], z.f[to], b);
        if (rhs_terms & given) b = given_value(bond_index);
        row.d = d;
        row.q = dot(d, d);
        row.t = b;
    }

    HOL_FORCED V given_value(int32_t bond_index) const {
        V b = {};
        for (int i = 0; i < Width<V>::lanes; ++i)
            Width<V>::set(b, i, 0.5 * z.x.in.rhs[z.x.lane[i].first_bond + z.x.s.bond_of[bond_index]]);
        return b;
    }

    // Of a tree at the level of forces nothing but the rows is needed later. The atoms are kept in these, too, r and v
    // in the row of the bond above it, in d and in q, E, t. That is less memory, and of molecules of a hundred bonds
    // what fits into the first-level cache. A bond is made from its two rows when those below it have been made.
    void read_atoms_to_rows() const {
        BondRow<V> *const row = z.x.row;
        read_atoms(*z.x.r, ByIndex<V>(row, &row->d.x));
        if (has(squares)) read_atoms(*z.x.in.v, ByIndex<V>(row, &row->q));
        if (has(pulls)) read_atoms(*z.x.in.f, ByIndex<V>(z.r));
    }

    template <bool has_v, bool has_f>
    __attribute__((noinline)) void make_rows_in_place() const {
        const EliminationPlan &s = z.x.s;
        const V *const mass = z.x.w;
        const Vector3<V> *const f = z.r;
        for (int32_t index = 0; index < s.n_tree; ++index) {
            const int32_t parent = s.parent[index];
            const BondRow<V> &from = z.x.row[parent];
            BondRow<V> &row = z.x.row[index];
            const V w = mass[index];
            Vector3<V> d = row.d - from.d, unused = {};
            take_image<false>(*z.x.box, d, unused);
            V b = {};
            if (has_v) {
                const Vector3<V> dv = {row.q - from.q, row.E - from.E, row.t - from.t};
                b = dot(dv, dv);
            }
            if (has_f) b = with_pull(d, mass[parent], f[parent], w, f[index], b);
            row.d = d;
            row.q = dot(d, d);
            row.E = w * row.q;  // of a leaf
            row.t = b;
        }
    }

    __attribute__((noinline)) void load() const {
        const EliminationPlan &s = z.x.s;
        if (!has(rates | given) && s.type == EliminationPlan::tree) {
            read_atoms_to_rows();
            return choose([&](auto v, auto f) { make_rows_in_place<v, f>(); }, has(squares), has(pulls));
        }
        read_atoms(*z.x.r, ByIndex<V>(z.r));
        if (has(squares | rates)) read_atoms(*z.x.in.v, ByIndex<V>(z.v));
        if (has(pulls)) read_atoms(*z.x.in.f, ByIndex<V>(z.f));
        if (terms == rates) return make_rows<rates>();
        if (terms == given) return make_rows<given>();
        choose([&](auto v, auto f) { make_rows<(v ? squares : 0) | (f ? pulls : 0)>(); }, has(squares), has(pulls));
    }

    template <int rhs_terms>
    __attribute__((noinline)) void make_rows() const {
        const EliminationPlan &s = z.x.s;
        for (int32_t index = 0; index < s.n_tree; ++index) {
            make_row(rhs_terms, index, s.parent[index], index);
            BondRow<V> &row = z.x.row[index];
            row.E = z.x.w[index] * row.q;  // of a leaf
        }
        for (int32_t p = 0; p < s.n_core; ++p) make_row(rhs_terms, s.n_tree + p, s.from[p], s.to[p]);
    }
};

}  // namespace holonomic::HOL_ISA::graph
