// Reads a block of molecules: bond vectors and right-hand sides at their places, from the roots down, so that every
// atom is read once.
#ifndef HOLONOMIC_KERNELS_GRAPH_LOAD_HPP
#define HOLONOMIC_KERNELS_GRAPH_LOAD_HPP

#include "core/kernels/graph/linear.hpp"

namespace holonomic {
namespace HOL_ISA {
namespace graph {

// What a right-hand side b of a bond from atom i to atom j is made of:
// squares: |v_j - v_i|^2;  pulls: d.(w_j f_j - w_i f_i);  rates: d.(v_j - v_i);  given: half of what is given for the
// bond.
enum RightHandSide { squares = 1, pulls = 2, rates = 4, given = 8 };

template <Layout layout, int terms, class V>
struct Loader {
    Linear<V> &z;

    // The atom at a slot, kept for the bonds below it.
    HOL_INLINE void read_atom(const Loader &me, int32_t slot, Vector3<V> &r, Vector3<V> &v, Vector3<V> &f) {
        const int32_t atom = me.z.x.s.atom_of[slot];
        r = read<layout>(*me.z.x.r, me.z.x.at, atom);
        if (terms & (squares | rates)) v = read<layout>(*me.z.x.in.v, me.z.x.at, atom);
        if (terms & pulls) f = read<layout>(*me.z.x.in.f, me.z.x.at, atom);
    }
    HOL_INLINE void keep_atom(const Loader &me, int32_t slot, const Vector3<V> &r, const Vector3<V> &v,
                              const Vector3<V> &f) {
        me.z.equations.r[slot] = r;
        if (terms & (squares | rates)) me.z.equations.velocity[slot] = v;
        if (terms & pulls) me.z.equations.force[slot] = f;
    }

    // The bond to an atom r, v, f from the atom in slot `from`; `row` gets d, q and t.
    HOL_INLINE void make_row(const Loader &me, int32_t place, int32_t from, V w, const Vector3<V> &r,
                             const Vector3<V> &v, const Vector3<V> &f) {
        const Equations<V> &e = me.z.equations;
        BondRow<V> &row = me.z.x.row[place];
        Vector3<V> d = r - e.r[from], unused = {};
        take_image<false>(*me.z.x.box, d, unused);
        V b = {};
        if (terms & squares) {
            const Vector3<V> dv = v - e.velocity[from];
            b = dot(dv, dv);
        }
        if (terms & rates) {
            b = dot(d, v - e.velocity[from]);
            if (me.z.x.in.strain) b = b + stretching(me.z.x.in.strain, d);
        }
        if (terms & pulls) {
            const V w0 = me.z.x.w[from];
            const Vector3<V> f0 = e.force[from];
            const Vector3<V> df = {mul_add(w, f.x, -(w0 * f0.x)), mul_add(w, f.y, -(w0 * f0.y)),
                                   mul_add(w, f.z, -(w0 * f0.z))};
            b = mul_add(d.z, df.z, mul_add(d.y, df.y, mul_add(d.x, df.x, b)));
        }
        if (terms & given) b = given_value(me, place);
        row.d = d;
        row.q = dot(d, d);
        row.t = b;
    }

    HOL_INLINE V given_value(const Loader &me, int32_t place) {
        V b = {};
        for (int i = 0; i < Width<V>::lanes; ++i)
            Width<V>::set(b, i, 0.5 * me.z.x.in.rhs[me.z.x.lane[i].first_bond + me.z.x.s.bond_of[place]]);
        if (me.z.equations.given) me.z.equations.given[place] = b;
        return b;
    }

    __attribute__((noinline)) void load() const {
        const Schedule &s = z.x.s;
        const bool keep_all = s.type == Schedule::graph || (terms & rates);
        for (int32_t slot = s.n_atoms - 1; slot >= 0; --slot) {
            const bool leaf = s.child_start[slot + 1] == s.child_start[slot];
            Vector3<V> r, v = {}, f = {};
            read_atom(*this, slot, r, v, f);
            if (!leaf || keep_all || slot >= s.n_tree) keep_atom(*this, slot, r, v, f);
            if (slot >= s.n_tree) continue;
            const V w = z.x.w[slot];
            make_row(*this, slot, s.parent[slot], w, r, v, f);
            BondRow<V> &row = z.x.row[slot];
            if (leaf) row.E = w * row.q;
        }
        load_core_bonds();
    }

    // The atoms that trees hang from, and the bonds between them.
    void load_core() const {
        for (int32_t slot = z.x.s.n_atoms - 1; slot >= z.x.s.n_tree; --slot) {
            Vector3<V> r, v = {}, f = {};
            read_atom(*this, slot, r, v, f);
            keep_atom(*this, slot, r, v, f);
        }
        load_core_bonds();
    }

    void load_core_bonds() const {
        const Schedule &s = z.x.s;
        const Equations<V> &e = z.equations;
        for (int32_t p = 0; p < s.n_core; ++p) {
            const int32_t to = s.to[p];
            make_row(*this, s.n_tree + p, s.from[p], z.x.w[to], e.r[to],
                     terms & (squares | rates) ? e.velocity[to] : Vector3<V>{},
                     terms & pulls ? e.force[to] : Vector3<V>{});
        }
    }
};

}  // namespace graph
}  // namespace HOL_ISA
}  // namespace holonomic
#endif
