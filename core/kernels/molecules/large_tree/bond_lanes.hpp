// Bonds of one molecule in lanes: W rows of BondRow<double>, wherever they stand, are gathered, and their changeable
// half is put back. Each lane does what a single one would, so that the digits do not depend on which bonds share a
// vector.
#ifndef HOLONOMIC_KERNELS_MOLECULES_LARGE_TREE_BOND_LANES_HPP
#define HOLONOMIC_KERNELS_MOLECULES_LARGE_TREE_BOND_LANES_HPP

#include "core/kernels/molecules/molecules.hpp"

namespace holonomic {
namespace HOL_ISA {
namespace graph {

// Four doubles from each of W places, and back.
HOL_INLINE void read_four(const double *const *p, vec *e) {
#if HOL_LANES == 4 && defined(__AVX2__)
    HOL_UNROLL
    for (int i = 0; i < 4; ++i) e[i] = _mm256_loadu_pd(p[i]);
    transpose(e);
#else
    for (int c = 0; c < 4; ++c) {
        vec a = {};
        for (int i = 0; i < W; ++i) a[i] = p[i][c];
        e[c] = a;
    }
#endif
}
HOL_INLINE void write_four(double *const *p, const vec *e) {
#if HOL_LANES == 4 && defined(__AVX2__)
    vec m[4] = {e[0], e[1], e[2], e[3]};
    transpose(m);
    HOL_UNROLL
    for (int i = 0; i < 4; ++i) _mm256_storeu_pd(p[i], m[i]);
#else
    for (int i = 0; i < W; ++i)
        for (int c = 0; c < 4; ++c) p[i][c] = e[c][i];
#endif
}
// The same of a single place.
HOL_INLINE void read_four(const double *const *p, double *e) {
    HOL_UNROLL
    for (int c = 0; c < 4; ++c) e[c] = p[0][c];
}
HOL_INLINE void write_four(double *const *p, const double *e) {
    HOL_UNROLL
    for (int c = 0; c < 4; ++c) p[0][c] = e[c];
}

static_assert(sizeof(BondRow<double>) == 8 * sizeof(double), "");

// d, q of the bonds at these places; E, t, l, r; and what of these has changed back.
template <class V>
HOL_INLINE void gather_vectors(const BondRow<double> *row, const int32_t *place, BondRow<V> &to) {
    const double *p[Width<V>::lanes];
    HOL_UNROLL
    for (int i = 0; i < Width<V>::lanes; ++i) p[i] = &row[place[i]].d.x;
    read_four(p, &to.d.x);
}
template <class V>
HOL_INLINE void gather_values(const BondRow<double> *row, const int32_t *place, BondRow<V> &to) {
    const double *p[Width<V>::lanes];
    HOL_UNROLL
    for (int i = 0; i < Width<V>::lanes; ++i) p[i] = &row[place[i]].E;
    read_four(p, &to.E);
}
template <class V>
HOL_INLINE void scatter_vectors(BondRow<double> *row, const int32_t *place, const BondRow<V> &from) {
    double *p[Width<V>::lanes];
    HOL_UNROLL
    for (int i = 0; i < Width<V>::lanes; ++i) p[i] = &row[place[i]].d.x;
    write_four(p, &from.d.x);
}
template <class V>
HOL_INLINE void scatter_values(BondRow<double> *row, const int32_t *place, const BondRow<V> &from) {
    double *p[Width<V>::lanes];
    HOL_UNROLL
    for (int i = 0; i < Width<V>::lanes; ++i) p[i] = &row[place[i]].E;
    write_four(p, &from.E);
}

template <class V>
HOL_INLINE V gather_numbers(const double *values, const int32_t *place) {
    V a = {};
    HOL_UNROLL
    for (int i = 0; i < Width<V>::lanes; ++i) Width<V>::set(a, i, values[place[i]]);
    return a;
}

}  // namespace graph
}  // namespace HOL_ISA
}  // namespace holonomic
#endif
