// What loops over a network go through: strands and nodes in lanes, parts of a thread, and vectors of their sites and
// bond indices.
#pragma once

#include "core/kernels/arithmetic/width.hpp"
#include "core/kernels/molecules/scratch.hpp"
#include "core/plan/sparse_ldl.hpp"

namespace holonomic::HOL_ISA::graph {

// Vectors x y z of all sites or of all bonds.
struct Net3 {
    double *x, *y, *z;
    template <class V>
    HOL_FORCED Vector3<V> get(int64_t i) const {
        return {load_any<V>(x + i), load_any<V>(y + i), load_any<V>(z + i)};
    }
    template <class V>
    HOL_FORCED void set(int64_t i, const Vector3<V> &a) const {
        store_any(x + i, a.x);
        store_any(y + i, a.y);
        store_any(z + i, a.z);
    }
    // The first of n has this number.
    static Net3 take(Memory<double> &memory, int64_t n, int64_t first = 0) {
        Net3 a;
        a.x = memory.values(in_fours(n)) - first;
        a.y = memory.values(in_fours(n)) - first;
        a.z = memory.values(in_fours(n)) - first;
        return a;
    }
};

// Equally long strands of a bundle, one per lane: bond k at bond index + k step, the atom behind it at site + k step.
struct NetStrands {
    int32_t length, bond_index, site, strand, step;
};

// Nodes with as many own unknowns, one per lane: unknown i at unknown + i step.
struct NetNodes {
    int32_t node, n_own, unknown, step;
};

// Numbers of the bonds that a list has.
template <class V>
HOL_INLINE V gather(const double *values, const int32_t *bond_index) {
    V a = {};
    for (int i = 0; i < Width<V>::lanes; ++i) Width<V>::set(a, i, values[bond_index[i]]);
    return a;
}

template <class V>
HOL_INLINE Vector3<V> gather(const Net3 &values, const int32_t *bond_index) {
    return {gather<V>(values.x, bond_index), gather<V>(values.y, bond_index), gather<V>(values.z, bond_index)};
}

// What a thread works on at a time, so little that it stays in cache: some bundles, with the indices of their bonds and
// the sites between the ends; or, after these parts, the *rest*: all sites of nodes and of trees, and trees' bonds.
struct NetPart {
    int32_t share, first_bundle, end_bundle, first_site, end_site, first_index, end_index;
    double *buffer;  // of the thread: a vector for each bond

    static constexpr int values_of_place = 3;
    Net3 of_sites() const { return vector(first_site); }
    Net3 by_bond_index() const { return vector(first_index); }

private:
    // There are no more sites than bonds between the ends.
    Net3 vector(int32_t first) const {
        Memory<double> memory = {buffer};
        return Net3::take(memory, end_index - first_index, first);
    }
};

}  // namespace holonomic::HOL_ISA::graph
