// Rows and columns of rows.hpp in twice the precision, as in twice.hpp.
#pragma once

#include "core/kernels/molecules/sparse_ldl/rows.hpp"
#include "core/kernels/molecules/twice.hpp"

namespace holonomic::HOL_ISA::graph {

HOL_INLINE Pair<Row> product_of(const Row &a, const Row &b) {
#if HOL_HAS_FMA
    const Row p = a * b;
    return {p, multiply_add(a, b, -p)};
#else
    return two_product<Row>(a, b);
#endif
}
template <class V>
HOL_INLINE Pair<RowInLanes<V>> product_of(const RowInLanes<V> &a, const RowInLanes<V> &b) {
    const Pair<V> x = two_product<V>(a.x, b.x), y = two_product<V>(a.y, b.y), z = two_product<V>(a.z, b.z);
    return {{x.hi, y.hi, z.hi, V{}}, {x.lo, y.lo, z.lo, V{}}};
}
template <class R>
HOL_INLINE Pair<R> product_of(const R &s, const Pair<R> &a) {
    const Pair<R> p = product_of(s, a.hi);
    return {p.hi, multiply_add(s, a.lo, p.lo)};
}
template <class R>
HOL_INLINE Pair<R> product_of(const Pair<R> &a, const Pair<R> &b) {
    const Pair<R> p = product_of(a.hi, b.hi);
    return {p.hi, multiply_add(a.hi, b.lo, multiply_add(a.lo, b.hi, p.lo))};
}

// The sums of the elements of the columns' rows; products of columns.
template <class V>
HOL_INLINE Pair<Columns<V>> sums_of_pairs(const Pair<RowOf<V>> (&p)[at_once<V>]) {
    RowOf<V> hi[at_once<V>], lo[at_once<V>];
    HOL_UNROLL
    for (int i = 0; i < at_once<V>; ++i) {
        hi[i] = p[i].hi;
        lo[i] = p[i].lo;
    }
    const Turned<V> high = turned(hi), low = turned(lo);
    typedef Pair<Columns<V>> Sum;
    return add_pairs(Sum{high.x, low.x}, add_pairs(Sum{high.y, low.y}, Sum{high.z, low.z}));
}
template <class V>
HOL_INLINE Pair<Columns<V>> columns_product(const Pair<Columns<V>> &a, const Pair<Columns<V>> &b) {
    if constexpr (at_once<V> == 4)
        return product_of(a, b);
    else
        return multiply_pairs(a, b);
}

}  // namespace holonomic::HOL_ISA::graph
