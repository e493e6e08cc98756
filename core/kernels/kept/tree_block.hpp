// Where the factors of a block of trees, or of rings with trees, are kept.
#pragma once

#include "core/kernels/molecules/linear.hpp"

namespace holonomic::HOL_ISA::graph {

// What is kept of a bond at its index, as BondRow has it.
template <class V>
struct KeptBond {
    Vector3<V> d;
    V l, r;
    V alone;     // times y: its multiplier if nothing else were pulled (tree/siblings.hpp)
    V q, error;  // d.d, and q r^2
};

// y of a bond, then u, then the solution; y alone.
template <class V>
struct KeptValue {
    V t, own;
};

template <class V>
struct KeptTrees {
    double *lanes;  // the first one: which lanes are kept, bit by bit
    KeptBond<V> *bond;
    V *w, *pair, *to_last, *reach;  // as in Molecules and Ring

    // Number of doubles.
    static constexpr int64_t of_bond = sizeof(KeptBond<V>) / sizeof(V);
    static int64_t doubles(const EliminationPlan &s) {
        const int64_t of_ring = s.type == EliminationPlan::ring ? RingLinear<V>::values(s) : 0;
        return most_lanes + Width<V>::lanes * (of_bond * s.n_bonds + s.n_atoms + s.n_pairs + of_ring);
    }
    KeptTrees(const EliminationPlan &s, double *block) : lanes(block) {
        Memory<V> memory = {block + most_lanes};
        bond = reinterpret_cast<KeptBond<V> *>(memory.values(of_bond * s.n_bonds));
        w = memory.values(s.n_atoms);
        pair = memory.values(s.n_pairs);
        to_last = memory.values(s.type == EliminationPlan::ring ? s.n_core : 0);
        reach = memory.values(0);
    }

    // From an elimination that is done.
    void keep(const TreeLinear<V> &z, unsigned good) const {
        const EliminationPlan &s = z.x.s;
        lanes[0] = static_cast<double>(good);
        for (int32_t k = 0; k < s.n_bonds; ++k) {
            const BondRow<V> &row = z.x.row[k];
            bond[k] = {row.d, row.l, row.r, row.r, row.q, row.q * (row.r * row.r)};
        }
        copy(z.x.w, s.n_atoms, w);
        copy(z.x.pair, s.n_pairs, pair);
        if (s.type == EliminationPlan::ring) {
            copy(z.ring.to_last, s.n_core, to_last);
            copy(z.ring.reach, 2 * static_cast<int64_t>(s.n_tree), reach);
        }
        for (int32_t index = 0; index < s.n_tree; ++index) {
            const int32_t first = s.child_start[index], end = s.child_start[index + 1];
            if (end - first <= most_decomposed) continue;
            const Matrix3<V> B = kept_matrix(pair + s.pair_start[index]);
            for (int32_t c = first; c < end; ++c) {
                KeptBond<V> &row = bond[c];
                row.alone = row.r * mul_add(-row.r, dot(row.d, B * row.d), Width<V>::all(1));
            }
        }
    }

private:
    static void copy(const V *from, int64_t n, V *to) {
        for (int64_t i = 0; i < n; ++i) to[i] = from[i];
    }
};

}  // namespace holonomic::HOL_ISA::graph
