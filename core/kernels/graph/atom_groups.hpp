// Reads and writes atoms of a block of molecules in the order of the caller's arrays, four at a time. Where rows follow
// each other, four atoms are twelve doubles of each lane.
#ifndef HOLONOMIC_KERNELS_GRAPH_ATOM_GROUPS_HPP
#define HOLONOMIC_KERNELS_GRAPH_ATOM_GROUPS_HPP

#include "core/kernels/graph/consecutive.hpp"

namespace holonomic {
namespace HOL_ISA {
namespace graph {

// Finds where atom k of each lane stands, for rows in order.
template <class V>
HOL_INLINE void rows_from(const AtomArray &array, const Atoms<V> &at, int64_t k, double **p) {
    double *const base = reinterpret_cast<double *>(array.x) + 3 * k;
    HOL_UNROLL
    for (int i = 0; i < at.lanes; ++i) p[i] = base + 3 * at.first[i];
}

// Reads atoms first .. first + count - 1, local numbers; count is four or one.
template <Layout layout, int count, class V>
HOL_INLINE void read_group(const AtomArray &array, const Atoms<V> &at, int64_t first, Vector3<V> *a) {
    if (layout == rows_in_order && count == 4) {
        double *p[Width<V>::lanes];
        rows_from(array, at, first, p);
        return read_elements<3 * count>(p, a);
    }
    HOL_UNROLL
    for (int j = 0; j < count; ++j) a[j] = read<layout>(array, at, first + j);
}

// Writes them in the lanes of `which`; `a` is used up.
template <Layout layout, int count, class V>
HOL_INLINE void write_group(const AtomArray &array, const Atoms<V> &at, int64_t first, Vector3<V> *a, unsigned which) {
    if (layout == rows_in_order && count == 4 && __builtin_expect(which == (1u << at.lanes) - 1, 1)) {
        double *p[Width<V>::lanes];
        rows_from(array, at, first, p);
        return write_elements<3 * count>(p, a);
    }
    for (int j = 0; j < count; ++j) write<layout>(array, at, first + j, a[j], which);
}

// Calls body(first, count) for the numbers below n, with the constant 4 as long as there are four, then with 1.
template <class Body>
HOL_INLINE void for_groups(int32_t n, const Body &body) {
    int32_t k = 0;
    for (; k + 4 <= n; k += 4) body(k, Constant<int, 4>{});
    for (; k < n; ++k) body(k, Constant<int, 1>{});
}

// Returns whether so many numbers of a list follow each other.
template <int count>
HOL_INLINE bool follow_each_other(const int32_t *list) {
    for (int j = 1; j < count; ++j)
        if (list[j] != list[0] + j) return false;
    return true;
}

}  // namespace graph
}  // namespace HOL_ISA
}  // namespace holonomic
#endif
