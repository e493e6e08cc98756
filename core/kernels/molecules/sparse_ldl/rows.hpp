// Vectors in space by sparse LDL^T. Of one molecule (V = double) they are rows of four doubles, x y z and one more: x,
// y and z are done at once, and four rows are turned into lanes of four where a number of each is wanted. Of W
// molecules (V = vec) they are four vectors of lanes. Both do the same in the same order, so that no digit depends on
// which.
#pragma once

#include "core/kernels/isa/choose.hpp"
#include "core/kernels/molecules/atoms/vectors.hpp"
#include "core/kernels/molecules/image.hpp"

namespace holonomic::HOL_ISA::graph {

typedef double Row __attribute__((vector_size(32)));
typedef long long RowBits __attribute__((vector_size(32)));

template <class V>
struct RowInLanes {
    V x, y, z, more;
};

// Columns<V>: a number of each of the columns that are worked on at a time.
template <class V>
struct RowKind {
    typedef RowInLanes<V> Row;
    typedef V Columns;
    static constexpr int at_once = 1;
};
template <>
struct RowKind<double> {
    typedef graph::Row Row;
    typedef graph::Row Columns;
    static constexpr int at_once = 4;
};
template <class V>
using RowOf = typename RowKind<V>::Row;
template <class V>
using Columns = typename RowKind<V>::Columns;
template <class V>
constexpr int at_once = RowKind<V>::at_once;

template <class V>
struct Rows {
    V *start;  // [n][4], aligned to 32
    HOL_FORCED RowOf<V> &operator[](int64_t k) const { return *reinterpret_cast<RowOf<V> *>(start + 4 * k); }
    HOL_FORCED RowOf<V> &at_four_times(int32_t k) const { return *reinterpret_cast<RowOf<V> *>(start + k); }
    HOL_FORCED Rows from(int64_t first) const { return {start + 4 * first}; }
    HOL_FORCED ByIndex<V> by_index() const { return ByIndex<V>(reinterpret_cast<RowInLanes<V> *>(start), start); }
};

HOL_INLINE Row in_row(double a) { return Row{a, a, a, a}; }
HOL_INLINE Row row_of(const Vector3<double> &a) { return Row{a.x, a.y, a.z, 0}; }
HOL_INLINE Vector3<double> vector_of(const Row &a) { return {a[0], a[1], a[2]}; }
HOL_INLINE double more_of(const Row &a) { return a[3]; }
HOL_INLINE void set_more(Row &a, double more) { a[3] = more; }
// x, y and z alone where that is less work.
HOL_INLINE void set_vector(Row &a, const Row &b) { a = b; }
HOL_INLINE double component(const Row &a, int c, int) { return a[c]; }
HOL_INLINE Row absolute(const Row &a) {
    return reinterpret_cast<Row>(reinterpret_cast<RowBits>(a) & (RowBits{} + 0x7fffffffffffffffLL));
}
// Less x, y and z; the fourth is added.
HOL_INLINE Row opposite(const Row &a) {
    const RowBits sign = {INT64_MIN, INT64_MIN, INT64_MIN, 0};
    return reinterpret_cast<Row>(reinterpret_cast<RowBits>(a) ^ sign);
}

// a b + c, in one rounding or two as mul_add().
HOL_INLINE Row multiply_add(const Row &a, const Row &b, const Row &c) {
#if defined(__AVX2__) && HOL_HAS_FMA
    return _mm256_fmadd_pd(a, b, c);
#else
    return Row{mul_add(a[0], b[0], c[0]), mul_add(a[1], b[1], c[1]), mul_add(a[2], b[2], c[2]),
               mul_add(a[3], b[3], c[3])};
#endif
}
HOL_INLINE Row larger(const Row &a, const Row &b) {
#if defined(__AVX2__)
    return _mm256_max_pd(a, b);
#else
    return Row{max(a[0], b[0]), max(a[1], b[1]), max(a[2], b[2]), max(a[3], b[3])};
#endif
}
HOL_INLINE Row smaller(const Row &a, const Row &b) {
#if defined(__AVX2__)
    return _mm256_min_pd(a, b);
#else
    return Row{min(a[0], b[0]), min(a[1], b[1]), min(a[2], b[2]), min(a[3], b[3])};
#endif
}
HOL_INLINE Row root_of(const Row &a) {
#if defined(__AVX2__)
    return _mm256_sqrt_pd(a);
#else
    return Row{__builtin_sqrt(a[0]), __builtin_sqrt(a[1]), __builtin_sqrt(a[2]), __builtin_sqrt(a[3])};
#endif
}
HOL_INLINE Row round_row(const Row &a) {
#if defined(__AVX2__)
    return _mm256_round_pd(a, _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC);
#else
    return Row{round(a[0]), round(a[1]), round(a[2]), 0};
#endif
}

// The same in lanes. The fourth counts in sums alone.
template <class V>
HOL_INLINE RowInLanes<V> in_row(const V &a) {
    return {a, a, a, a};
}
template <class V>
HOL_INLINE RowInLanes<V> row_of(const Vector3<V> &a) {
    return {a.x, a.y, a.z, V{}};
}
template <class V>
HOL_INLINE Vector3<V> vector_of(const RowInLanes<V> &a) {
    return {a.x, a.y, a.z};
}
template <class V>
HOL_INLINE V more_of(const RowInLanes<V> &a) {
    return a.more;
}
template <class V>
HOL_INLINE void set_more(RowInLanes<V> &a, const V &more) {
    a.more = more;
}
template <class V>
HOL_INLINE void set_vector(RowInLanes<V> &a, const RowInLanes<V> &b) {
    a.x = b.x;
    a.y = b.y;
    a.z = b.z;
}
template <class V>
HOL_INLINE double component(const RowInLanes<V> &a, int c, int lane) {
    return Width<V>::get(c == 0 ? a.x : c == 1 ? a.y : a.z, lane);
}
template <class V>
HOL_INLINE RowInLanes<V> operator+(const RowInLanes<V> &a, const RowInLanes<V> &b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z, a.more + b.more};
}
template <class V>
HOL_INLINE RowInLanes<V> operator-(const RowInLanes<V> &a, const RowInLanes<V> &b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z, V{}};
}
template <class V>
HOL_INLINE RowInLanes<V> operator-(const RowInLanes<V> &a) {
    return {-a.x, -a.y, -a.z, V{}};
}
template <class V>
HOL_INLINE RowInLanes<V> operator*(const RowInLanes<V> &a, const RowInLanes<V> &b) {
    return {a.x * b.x, a.y * b.y, a.z * b.z, V{}};
}
template <class V>
HOL_INLINE RowInLanes<V> absolute(const RowInLanes<V> &a) {
    return {abs(a.x), abs(a.y), abs(a.z), V{}};
}
template <class V>
HOL_INLINE RowInLanes<V> opposite(const RowInLanes<V> &a) {
    return {-a.x, -a.y, -a.z, a.more};
}
template <class V>
HOL_INLINE RowInLanes<V> multiply_add(const RowInLanes<V> &a, const RowInLanes<V> &b, const RowInLanes<V> &c) {
    return {mul_add(a.x, b.x, c.x), mul_add(a.y, b.y, c.y), mul_add(a.z, b.z, c.z), mul_add(a.more, b.more, c.more)};
}
template <class V>
HOL_INLINE RowInLanes<V> larger(const RowInLanes<V> &a, const RowInLanes<V> &b) {
    return {max(a.x, b.x), max(a.y, b.y), max(a.z, b.z), V{}};
}
// Of columns; those of one molecule are rows.
template <class V>
HOL_INLINE V multiply_add(const V &a, const V &b, const V &c) {
    return mul_add(a, b, c);
}
template <class V>
HOL_INLINE V absolute(const V &a) {
    return abs(a);
}
template <class V>
HOL_INLINE V larger(const V &a, const V &b) {
    return max(a, b);
}
template <class V>
HOL_INLINE V smaller(const V &a, const V &b) {
    return min(a, b);
}
template <class V>
HOL_INLINE V root_of(const V &a) {
    return sqrt(a);
}

// Of the columns at work: the same number of each, one of each from where these indices say, one put in the place of
// column i, the largest and the smallest, their sum, and the lanes in which that of column i is positive, or not
// negative.
template <class V>
HOL_INLINE Columns<V> all_columns(double a) {
    if constexpr (at_once<V> == 4)
        return Row{a, a, a, a};
    else
        return Width<V>::all(a);
}
template <class V>
HOL_INLINE Columns<V> gathered(const V *of, const int32_t *k) {
    if constexpr (at_once<V> == 4)
        return Row{of[k[0]], of[k[1]], of[k[2]], of[k[3]]};
    else
        return of[*k];
}
template <class V>
HOL_INLINE V largest_of(const Columns<V> &a) {
    if constexpr (at_once<V> == 4)
        return max(max(a[0], a[1]), max(a[2], a[3]));
    else
        return a;
}
template <class V>
HOL_INLINE V smallest_of(const Columns<V> &a) {
    if constexpr (at_once<V> == 4)
        return min(min(a[0], a[1]), min(a[2], a[3]));
    else
        return a;
}
HOL_INLINE double largest_component(const Row &a) { return largest_of<double>(a); }
template <class V>
HOL_INLINE V largest_component(const RowInLanes<V> &a) {
    return max(max(a.x, a.y), a.z);
}
template <class V>
HOL_INLINE V sum_of_columns(const Columns<V> &a) {
    if constexpr (at_once<V> == 4)
        return (a[0] + a[1]) + (a[2] + a[3]);
    else
        return a;
}
template <class V>
HOL_INLINE void put(Columns<V> &a, int i, const V &one) {
    if constexpr (at_once<V> == 4)
        a[i] = one;
    else
        a = one;
}
template <class V>
HOL_INLINE unsigned positive(const Columns<V> &a, int i) {
    if constexpr (at_once<V> == 4)
        return a[i] > 0;
    else
        return bits(less(V{}, a));
}
template <class V>
HOL_INLINE unsigned not_negative(const Columns<V> &a, int i) {
    if constexpr (at_once<V> == 4)
        return a[i] >= 0;
    else
        return bits(less_equal(V{}, a));
}
template <class V>
HOL_INLINE bool all_positive(const Columns<V> &a) {
#if defined(__AVX2__)
    if constexpr (at_once<V> == 4) return _mm256_movemask_pd(_mm256_cmp_pd(a, Row{}, _CMP_GT_OQ)) == 15;
#endif
    unsigned all = positive<V>(a, 0);
    for (int i = 1; i < at_once<V>; ++i) all &= positive<V>(a, i);
    return all == all_of<V>;
}

// The sums of the elements of the columns' rows.
HOL_INLINE Row sums_of(const Row (&p)[4]) {
#if defined(__AVX2__)
    const __m256d ab = _mm256_hadd_pd(p[0], p[1]), cd = _mm256_hadd_pd(p[2], p[3]);
    return _mm256_permute2f128_pd(ab, cd, 0x20) + _mm256_permute2f128_pd(ab, cd, 0x31);
#else
    Row sum = {};
    for (int i = 0; i < 4; ++i) sum[i] = (p[i][0] + p[i][1]) + (p[i][2] + p[i][3]);
    return sum;
#endif
}
template <class V>
HOL_INLINE V sums_of(const RowInLanes<V> (&p)[1]) {
    return (p[0].x + p[0].y) + p[0].z;
}

// x, y and z of the columns' rows.
template <class V>
struct Turned {
    Columns<V> x, y, z;
};
HOL_INLINE Turned<double> turned(const Row &a, const Row &b, const Row &c, const Row &d) {
#if defined(__AVX2__)
    const __m256d xz = _mm256_unpacklo_pd(a, b), yw = _mm256_unpackhi_pd(a, b), xz2 = _mm256_unpacklo_pd(c, d),
                  yw2 = _mm256_unpackhi_pd(c, d);
    return {_mm256_permute2f128_pd(xz, xz2, 0x20), _mm256_permute2f128_pd(yw, yw2, 0x20),
            _mm256_permute2f128_pd(xz, xz2, 0x31)};
#else
    return {Row{a[0], b[0], c[0], d[0]}, Row{a[1], b[1], c[1], d[1]}, Row{a[2], b[2], c[2], d[2]}};
#endif
}
HOL_INLINE Turned<double> turned(const Row (&p)[4]) { return turned(p[0], p[1], p[2], p[3]); }
template <class V>
HOL_INLINE Turned<V> turned(const RowInLanes<V> (&p)[1]) {
    return {p[0].x, p[0].y, p[0].z};
}

}  // namespace holonomic::HOL_ISA::graph
