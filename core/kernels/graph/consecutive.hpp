// Molecules of a number of atoms that the compiler knows, whose rows x y z stand one behind the other: 3 n doubles of
// each lane, four at a time.
#ifndef HOLONOMIC_KERNELS_GRAPH_CONSECUTIVE_HPP
#define HOLONOMIC_KERNELS_GRAPH_CONSECUTIVE_HPP

#include "core/kernels/graph/atoms.hpp"

namespace holonomic {
namespace HOL_ISA {
namespace graph {

#if HOL_LANES >= 4 && defined(__AVX2__)
// Element e of four lanes; what is left of the last row of four is read and written element by element.
template <int n>
HOL_INLINE void read_elements(const double *const *p, quad *e) {
    HOL_UNROLL
    for (int j = 0; j < n / 4; ++j) {
        HOL_UNROLL
        for (int i = 0; i < 4; ++i) e[4 * j + i] = _mm256_loadu_pd(p[i] + 4 * j);
        transpose(e + 4 * j);
    }
    HOL_UNROLL
    for (int c = n / 4 * 4; c < n; ++c) e[c] = quad{p[0][c], p[1][c], p[2][c], p[3][c]};
}

template <int n>
HOL_INLINE void write_elements(double *const *p, quad *e) {
    HOL_UNROLL
    for (int j = 0; j < n / 4; ++j) {
        transpose(e + 4 * j);
        HOL_UNROLL
        for (int i = 0; i < 4; ++i) _mm256_storeu_pd(p[i] + 4 * j, e[4 * j + i]);
    }
    HOL_UNROLL
    for (int c = n / 4 * 4; c < n; ++c) {
        HOL_UNROLL
        for (int i = 0; i < 4; ++i) p[i][c] = e[c][i];
    }
}

// Adds element e, used up, to r, and factor times it to v, unless v[0] is nullptr.
template <int n>
HOL_INLINE void add_elements(double *const *r, double *const *v, double factor, quad *e) {
    const quad f = _mm256_set1_pd(factor);
    HOL_UNROLL
    for (int j = 0; j < n / 4; ++j) {
        transpose(e + 4 * j);
        HOL_UNROLL
        for (int i = 0; i < 4; ++i) _mm256_storeu_pd(r[i] + 4 * j, _mm256_loadu_pd(r[i] + 4 * j) + e[4 * j + i]);
        if (!v) continue;
        HOL_UNROLL
        for (int i = 0; i < 4; ++i)
            _mm256_storeu_pd(v[i] + 4 * j, _mm256_fmadd_pd(f, e[4 * j + i], _mm256_loadu_pd(v[i] + 4 * j)));
    }
    HOL_UNROLL
    for (int c = n / 4 * 4; c < n; ++c) {
        HOL_UNROLL
        for (int i = 0; i < 4; ++i) {
            r[i][c] += e[c][i];
            if (v) v[i][c] = mul_add(factor, e[c][i], v[i][c]);
        }
    }
}
#endif

#if HOL_LANES == 8 && defined(__AVX512F__)
template <int n>
HOL_INLINE void halves(const vec *e, quad *low, quad *high) {
    HOL_UNROLL
    for (int c = 0; c < n; ++c) {
        low[c] = _mm512_castpd512_pd256(e[c]);
        high[c] = _mm512_extractf64x4_pd(e[c], 1);
    }
}
#endif

template <int n>
HOL_INLINE void read_elements(const double *const *p, Vector3<vec> *a) {
    vec *const e = &a->x;
#if HOL_LANES == 4 && defined(__AVX2__)
    read_elements<n>(p, reinterpret_cast<quad *>(e));
#elif HOL_LANES == 8 && defined(__AVX512F__)
    quad low[n], high[n];
    read_elements<n>(p, low);
    read_elements<n>(p + 4, high);
    HOL_UNROLL
    for (int c = 0; c < n; ++c) e[c] = _mm512_insertf64x4(_mm512_castpd256_pd512(low[c]), high[c], 1);
#else
    for (int c = 0; c < n; ++c)
        for (int i = 0; i < W; ++i) e[c][i] = p[i][c];
#endif
}
template <int n>
HOL_INLINE void read_elements(const double *const *p, Vector3<double> *a) {
    HOL_UNROLL
    for (int k = 0; k < n / 3; ++k) a[k] = {p[0][3 * k], p[0][3 * k + 1], p[0][3 * k + 2]};
}

template <int n>
HOL_INLINE void write_elements(double *const *p, Vector3<vec> *a) {
    vec *const e = &a->x;
#if HOL_LANES == 4 && defined(__AVX2__)
    write_elements<n>(p, reinterpret_cast<quad *>(e));
#elif HOL_LANES == 8 && defined(__AVX512F__)
    quad low[n], high[n];
    halves<n>(e, low, high);
    write_elements<n>(p, low);
    write_elements<n>(p + 4, high);
#else
    for (int c = 0; c < n; ++c)
        for (int i = 0; i < W; ++i) p[i][c] = e[c][i];
#endif
}
template <int n>
HOL_INLINE void write_elements(double *const *p, Vector3<double> *a) {
    HOL_UNROLL
    for (int k = 0; k < n / 3; ++k) {
        p[0][3 * k] = a[k].x;
        p[0][3 * k + 1] = a[k].y;
        p[0][3 * k + 2] = a[k].z;
    }
}

template <int n>
HOL_INLINE void add_elements(double *const *r, double *const *v, double factor, Vector3<vec> *a) {
    vec *const e = &a->x;
#if HOL_LANES == 4 && defined(__AVX2__)
    add_elements<n>(r, v, factor, reinterpret_cast<quad *>(e));
#elif HOL_LANES == 8 && defined(__AVX512F__)
    quad low[n], high[n];
    halves<n>(e, low, high);
    add_elements<n>(r, v, factor, low);
    add_elements<n>(r + 4, v ? v + 4 : nullptr, factor, high);
#else
    for (int c = 0; c < n; ++c)
        for (int i = 0; i < W; ++i) {
            r[i][c] += e[c][i];
            if (v) v[i][c] = mul_add(factor, e[c][i], v[i][c]);
        }
#endif
}
template <int n>
HOL_INLINE void add_elements(double *const *r, double *const *v, double factor, Vector3<double> *a) {
    const double *const e = &a->x;
    HOL_UNROLL
    for (int c = 0; c < n; ++c) {
        r[0][c] += e[c];
        if (v) v[0][c] = mul_add(factor, e[c], v[0][c]);
    }
}

// The rows of molecules of n atoms.
template <Layout layout, int n, class V>
HOL_INLINE double *row_of(const AtomArray &array, const Atoms<V> &at, int i) {
    double *const x = reinterpret_cast<double *>(array.x);
    return layout == rows_adjacent ? x + 3 * at.first[0] + 3 * n * i : x + 3 * at.first[i];
}

// The atoms 0 .. n - 1 of all lanes.
template <Layout layout, int n, class V>
HOL_INLINE void read_all(const AtomArray &array, const Atoms<V> &at, Vector3<V> *atoms) {
    if (layout == rows_in_order || layout == rows_adjacent) {
        const double *p[Width<V>::lanes];
        HOL_UNROLL
        for (int i = 0; i < at.lanes; ++i) p[i] = row_of<layout, n>(array, at, i);
        read_elements<3 * n>(p, atoms);
        return;
    }
    HOL_UNROLL
    for (int k = 0; k < n; ++k) atoms[k] = read<layout>(array, at, k);
}

template <Layout layout, int n, class V>
HOL_NOINLINE void write_some(const AtomArray &array, const Atoms<V> &at, const Vector3<V> *atoms, unsigned which) {
    for (int k = 0; k < n; ++k) write<layout == rows_adjacent ? rows_in_order : layout>(array, at, k, atoms[k], which);
}

// The same in the lanes of `which`; `atoms` is used up.
template <Layout layout, int n, class V>
HOL_INLINE void write_all(const AtomArray &array, const Atoms<V> &at, Vector3<V> *atoms, unsigned which) {
    if ((layout == rows_in_order || layout == rows_adjacent) && __builtin_expect(which == (1u << at.lanes) - 1, 1)) {
        double *p[Width<V>::lanes];
        HOL_UNROLL
        for (int i = 0; i < at.lanes; ++i) p[i] = row_of<layout, n>(array, at, i);
        write_elements<3 * n>(p, atoms);
        return;
    }
    write_some<layout, n>(array, at, atoms, which);
}

template <Layout layout, int n, class V>
HOL_NOINLINE void move_some(const PositionsCall &call, const Atoms<V> &at, const Vector3<V> *shift, unsigned which) {
    constexpr Layout anywhere = layout == rows_adjacent ? rows_in_order : layout;
    const V per_dt = Width<V>::all(1 / call.dt);
    for (int k = 0; k < n; ++k) {
        write<anywhere>(call.r, at, k, read<anywhere>(call.r, at, k) + shift[k], which);
        if (call.v.x) write<anywhere>(call.v, at, k, add_times(read<anywhere>(call.v, at, k), per_dt, shift[k]), which);
    }
}

// Moves the atoms of the lanes in `which` by `shift`, which is used up, and their velocities with them. Where rows
// stand in order the moves are transposed, once, and not what they are added to.
template <Layout layout, int n, class V>
HOL_INLINE void move_all(const PositionsCall &call, const Atoms<V> &at, Vector3<V> *shift, unsigned which) {
    if ((layout == rows_in_order || layout == rows_adjacent) && __builtin_expect(which == (1u << at.lanes) - 1, 1)) {
        double *r[Width<V>::lanes], *v[Width<V>::lanes];
        HOL_UNROLL
        for (int i = 0; i < at.lanes; ++i) r[i] = row_of<layout, n>(call.r, at, i);
        if (!call.v.x) return add_elements<3 * n>(r, nullptr, 0, shift);
        HOL_UNROLL
        for (int i = 0; i < at.lanes; ++i) v[i] = row_of<layout, n>(call.v, at, i);
        return add_elements<3 * n>(r, v, 1 / call.dt, shift);
    }
    Vector3<V> copy[n];
    HOL_UNROLL
    for (int k = 0; k < n; ++k) copy[k] = shift[k];
    move_some<layout, n>(call, at, copy, which);
}

// Three values per bond, in the order of the bonds.
template <Layout layout, class V>
HOL_INLINE void write_three(double *out, const Atoms<V> &at, const Vector3<V> &value, unsigned which) {
    if (__builtin_expect(which == (1u << at.lanes) - 1, 1)) {
        double *p[Width<V>::lanes];
        HOL_UNROLL
        for (int i = 0; i < at.lanes; ++i) p[i] = layout == rows_adjacent ? out + at.bond[0] + 3 * i : out + at.bond[i];
        return write_rows(p, value);
    }
    for (int i = 0; i < at.lanes; ++i) {
        if (!(which >> i & 1)) continue;
        double *const p = out + at.bond[i];
        p[0] = Width<V>::get(value.x, i);
        p[1] = Width<V>::get(value.y, i);
        p[2] = Width<V>::get(value.z, i);
    }
}

}  // namespace graph
}  // namespace HOL_ISA
}  // namespace holonomic
#endif
