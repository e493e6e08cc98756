// Reads a block of molecules: each atom once, then bond vectors and right-hand sides at their places.
#ifndef HOLONOMIC_KERNELS_GRAPH_LOAD_HPP
#define HOLONOMIC_KERNELS_GRAPH_LOAD_HPP

#include "core/kernels/graph/atom_groups.hpp"
#include "core/kernels/graph/linear.hpp"

namespace holonomic {
namespace HOL_ISA {
namespace graph {

// The terms of the right-hand side b of a bond from atom i to atom j:
// squares: |v_j - v_i|^2;  pulls: d.(w_j f_j - w_i f_i);  rates: d.(v_j - v_i);  given: half of the bond's given value.
enum RightHandSide { squares = 1, pulls = 2, rates = 4, given = 8 };

template <Layout layout, int terms, class V>
struct Loader {
    Linear<V> &z;

    // Reads atoms first .. first + count - 1, in the caller's order, to their slots.
    template <int count>
    HOL_FORCED void read_atoms(int32_t first) const {
        const Molecules<V> &x = z.x;
        const Equations<V> &e = z.equations;
        const int32_t *const slot = x.s.slot_of + first;
        Vector3<V> a[count] = {};
        const auto take = [&](const AtomArray &array, Vector3<V> *to) HOL_FORCED {
            read_group<layout, count>(array, x.at, first, a);
            HOL_UNROLL
            for (int j = 0; j < count; ++j) to[slot[j]] = a[j];
        };
        take(*x.r, e.r);
        if (terms & (squares | rates)) take(*x.in.v, e.velocity);
        if (terms & pulls) take(*x.in.f, e.force);
    }
    HOL_FORCED void read_atom(int32_t slot) const { read_atoms<1>(z.x.s.atom_of[slot]); }

    // b + d.(w f - w0 f0)
    HOL_STATIC V with_pull(const Vector3<V> &d, V w0, const Vector3<V> &f0, V w, const Vector3<V> &f, V b) {
        const Vector3<V> df = {mul_add(w, f.x, -(w0 * f0.x)), mul_add(w, f.y, -(w0 * f0.y)),
                               mul_add(w, f.z, -(w0 * f0.z))};
        return mul_add(d.z, df.z, mul_add(d.y, df.y, mul_add(d.x, df.x, b)));
    }

    // Makes d, q and t of the bond between the atoms in two slots.
    HOL_FORCED void make_row(int32_t place, int32_t from, int32_t to) const {
        const Equations<V> &e = z.equations;
        BondRow<V> &row = z.x.row[place];
        Vector3<V> d = e.r[to] - e.r[from], unused = {};
        take_image<false>(*z.x.box, d, unused);
        V b = {};
        if (terms & squares) {
            const Vector3<V> dv = e.velocity[to] - e.velocity[from];
            b = dot(dv, dv);
        }
        if (terms & rates) {
            b = dot(d, e.velocity[to] - e.velocity[from]);
            if (z.x.in.strain) b = b + stretching(z.x.in.strain, d);
        }
        if (terms & pulls) b = with_pull(d, z.x.w[from], e.force[from], z.x.w[to], e.force[to], b);
        if (terms & given) b = given_value(place);
        row.d = d;
        row.q = dot(d, d);
        row.t = b;
    }

    HOL_FORCED V given_value(int32_t place) const {
        V b = {};
        for (int i = 0; i < Width<V>::lanes; ++i)
            Width<V>::set(b, i, 0.5 * z.x.in.rhs[z.x.lane[i].first_bond + z.x.s.bond_of[place]]);
        if (z.equations.given) z.equations.given[place] = b;
        return b;
    }

    // Of a tree at the level of forces nothing but the rows is needed later. The atoms are kept in these, too, each in
    // the row of the bond above it: r in d, v in q, E, t, and f in l, r and a value elsewhere. That is half the memory,
    // and of molecules of a hundred bonds what fits into the first-level cache. A bond is made from its two rows when
    // those below it have been made.
    static constexpr bool fits_rows = !(terms & (rates | given));

    template <int count>
    HOL_FORCED void read_atoms_to_rows(int32_t first) const {
        const Molecules<V> &x = z.x;
        const int32_t *const slot = x.s.slot_of + first;
        V *const rest = &z.equations.r->x;
        Vector3<V> a[count] = {};
        read_group<layout, count>(*x.r, x.at, first, a);
        HOL_UNROLL
        for (int j = 0; j < count; ++j) x.row[slot[j]].d = a[j];
        if (terms & squares) {
            read_group<layout, count>(*x.in.v, x.at, first, a);
            HOL_UNROLL
            for (int j = 0; j < count; ++j) {
                BondRow<V> &row = x.row[slot[j]];
                row.q = a[j].x;
                row.E = a[j].y;
                row.t = a[j].z;
            }
        }
        if (terms & pulls) {
            read_group<layout, count>(*x.in.f, x.at, first, a);
            HOL_UNROLL
            for (int j = 0; j < count; ++j) {
                BondRow<V> &row = x.row[slot[j]];
                row.l = a[j].x;
                row.r = a[j].y;
                rest[slot[j]] = a[j].z;
            }
        }
    }

    HOL_FORCED void make_row_in_place(int32_t slot, int32_t parent) const {
        const BondRow<V> &from = z.x.row[parent];
        BondRow<V> &row = z.x.row[slot];
        const V *const rest = &z.equations.r->x;
        const V w = z.x.w[slot];
        Vector3<V> d = row.d - from.d, unused = {};
        take_image<false>(*z.x.box, d, unused);
        V b = {};
        if (terms & squares) {
            const Vector3<V> dv = {row.q - from.q, row.E - from.E, row.t - from.t};
            b = dot(dv, dv);
        }
        if (terms & pulls)
            b = with_pull(d, z.x.w[parent], {from.l, from.r, rest[parent]}, w, {row.l, row.r, rest[slot]}, b);
        row.d = d;
        row.q = dot(d, d);
        row.E = w * row.q;  // of a leaf
        row.t = b;
    }

    __attribute__((noinline)) void load() const {
        const Schedule &s = z.x.s;
        if (fits_rows && s.type == Schedule::tree) {
            for_groups(s.n_atoms, [&](int32_t first, auto number) HOL_FORCED { read_atoms_to_rows<number>(first); });
            for (int32_t slot = 0; slot < s.n_tree; ++slot) make_row_in_place(slot, s.parent[slot]);
            return;
        }
        for_groups(s.n_atoms, [&](int32_t first, auto number) HOL_FORCED { read_atoms<number>(first); });
        for (int32_t slot = 0; slot < s.n_tree; ++slot) {
            make_row(slot, s.parent[slot], slot);
            BondRow<V> &row = z.x.row[slot];
            row.E = z.x.w[slot] * row.q;  // of a leaf
        }
        load_core_bonds();
    }

    // Reads the atoms that trees hang from, and makes the bonds between them.
    void load_core() const {
        for (int32_t slot = z.x.s.n_atoms - 1; slot >= z.x.s.n_tree; --slot) read_atom(slot);
        load_core_bonds();
    }

    void load_core_bonds() const {
        const Schedule &s = z.x.s;
        for (int32_t p = 0; p < s.n_core; ++p) make_row(s.n_tree + p, s.from[p], s.to[p]);
    }
};

}  // namespace graph
}  // namespace HOL_ISA
}  // namespace holonomic
#endif
