// Atoms of one molecule in lanes, with the bonds to their children and the ones above.
#ifndef HOLONOMIC_KERNELS_MOLECULES_LARGE_TREE_ATOM_LANES_HPP
#define HOLONOMIC_KERNELS_MOLECULES_LARGE_TREE_ATOM_LANES_HPP

#include "core/kernels/molecules/large_tree/bond_lanes.hpp"

namespace holonomic {
namespace HOL_ISA {
namespace graph {

// AtomRows of as many atoms as V has lanes, with k children each, worked on in copies of their bonds.
template <int k, class V>
struct AtomLanes {
    static constexpr int lanes = Width<V>::lanes, pairs = k * (k - 1) / 2;
    const Molecules<double> &x;
    const int32_t *const slot;
    int32_t child[k][lanes];
    mutable BondRow<V> bonds[k], top;
    mutable V pair[pairs + 1];
    V mass;

    HOL_FORCED V w() const { return mass; }
    HOL_FORCED BondRow<V> &bond(int a) const { return bonds[a]; }
    HOL_FORCED BondRow<V> &above() const { return top; }
    HOL_FORCED V *multipliers() const { return pair; }
    HOL_FORCED V product(int a, int) const {
        const V g = dot(bonds[a].d, top.d);
        if (k > 1) return g;
        const MaskOf<V> small = nearly_orthogonal(g, bonds[0].q, top.q);
        if (__builtin_expect(any(small), 0)) return products_anew(x, child[0], slot, bits(small), g);
        return g;
    }
    HOL_NOINLINE V products_anew(const Molecules<double> &x, const int32_t *child, const int32_t *slot, unsigned which,
                                 V g) {
        for (; which; which &= which - 1) {
            const int i = __builtin_ctz(which);
            Width<V>::set(g, i, dots_anew(x, child[i], slot[i], 1, Width<V>::get(g, i)));
        }
        return g;
    }

    HOL_FORCED AtomLanes(const Molecules<double> &m, const int32_t *s) : x(m), slot(s) {
        HOL_UNROLL
        for (int i = 0; i < lanes; ++i) {
            const int32_t *const list = m.s.child + m.s.child_start[s[i]];
            HOL_UNROLL
            for (int a = 0; a < k; ++a) child[a][i] = list[a];
        }
    }
    HOL_FORCED void read_values() const {
        HOL_UNROLL
        for (int a = 0; a < k; ++a) gather_values(x.row, child[a], bonds[a]);
    }
    HOL_FORCED void read_bonds() {
        HOL_UNROLL
        for (int a = 0; a < k; ++a) gather_vectors(x.row, child[a], bonds[a]);
        read_values();
        gather_vectors(x.row, slot, top);
        gather_values(x.row, slot, top);
        mass = gather_numbers<V>(x.w, slot);
    }
    HOL_FORCED void read_pairs() const {
        if (k == 1) return;
        HOL_UNROLL
        for (int i = 0; i < lanes; ++i) {
            HOL_UNROLL
            for (int p = 0; p < pairs; ++p) Width<V>::set(pair[p], i, x.pair[x.s.pair_start[slot[i]] + p]);
        }
    }
    HOL_FORCED void write_pairs() const {
        if (k == 1) return;
        HOL_UNROLL
        for (int i = 0; i < lanes; ++i) {
            HOL_UNROLL
            for (int p = 0; p < pairs; ++p) x.pair[x.s.pair_start[slot[i]] + p] = Width<V>::get(pair[p], i);
        }
    }
    HOL_FORCED void write_values() const {
        HOL_UNROLL
        for (int a = 0; a < k; ++a) scatter_values(x.row, child[a], bonds[a]);
    }
};

}  // namespace graph
}  // namespace HOL_ISA
}  // namespace holonomic
#endif
