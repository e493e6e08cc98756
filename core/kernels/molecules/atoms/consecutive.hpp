// Molecules of a number of atoms that the compiler knows, whose rows x y z stand one behind the other: 3 n doubles of
// each lane, four at a time.
#pragma once

#include "core/kernels/isa/choose.hpp"
#include "core/kernels/memory/columns.hpp"
#include "core/kernels/molecules/atoms/layout.hpp"

namespace holonomic::HOL_ISA::graph {

#if HOL_NEON || (HOL_LANES >= 4 && defined(__AVX2__))
using HOL_ISA::read_elements;
using HOL_ISA::write_elements;
#endif
#if HOL_LANES >= 4 && defined(__AVX2__)
using HOL_ISA::read_pair;

// Adds element e, used up, to r, and factor times it to v; either may be nullptr.
template <int n>
HOL_INLINE void add_elements(double *const *r, double *const *v, double factor, quad *e) {
    const quad f = _mm256_set1_pd(factor);
    HOL_UNROLL
    for (int j = 0; j < n / 4; ++j) {
        transpose(e + 4 * j);
        if (r) {
            HOL_UNROLL
            for (int i = 0; i < 4; ++i) _mm256_storeu_pd(r[i] + 4 * j, _mm256_loadu_pd(r[i] + 4 * j) + e[4 * j + i]);
        }
        if (!v) continue;
        HOL_UNROLL
        for (int i = 0; i < 4; ++i)
            _mm256_storeu_pd(v[i] + 4 * j, _mm256_fmadd_pd(f, e[4 * j + i], _mm256_loadu_pd(v[i] + 4 * j)));
    }
    for_each_left<n>(
        e,
        [&](int i, int c, double2 x) HOL_FORCED {
            if (r) _mm_storeu_pd(r[i] + c, _mm_loadu_pd(r[i] + c) + x);
            if (v) _mm_storeu_pd(v[i] + c, mul_add(double2{factor, factor}, x, _mm_loadu_pd(v[i] + c)));
        },
        [&](int i, int c, double x) HOL_FORCED {
            if (r) r[i][c] += x;
            if (v) v[i][c] = mul_add(factor, x, v[i][c]);
        });
}
#elif HOL_NEON
template <int n>
HOL_INLINE void add_elements(double *const *r, double *const *v, double factor, vec *e) {
    for_each_pair<n>(
        e,
        [&](int i, int c, vec x) HOL_FORCED {
            if (r) store(r[i] + c, load(r[i] + c) + x);
            if (v) store(v[i] + c, mul_add(splat(factor), x, load(v[i] + c)));
        },
        [&](int i, int c, double x) HOL_FORCED {
            if (r) r[i][c] += x;
            if (v) v[i][c] = mul_add(factor, x, v[i][c]);
        });
}
#endif

template <int n>
HOL_INLINE void read_elements(const double *const *p, Vector3<vec> *a) {
    vec *const e = &a->x;
#if HOL_ELEMENTS
    read_elements<n>(p, e);
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
#if HOL_ELEMENTS
    write_elements<n>(p, e);
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
#if HOL_ELEMENTS
    add_elements<n>(r, v, factor, e);
#else
    for (int c = 0; c < n; ++c)
        for (int i = 0; i < W; ++i) {
            if (r) r[i][c] += e[c][i];
            if (v) v[i][c] = mul_add(factor, e[c][i], v[i][c]);
        }
#endif
}
template <int n>
HOL_INLINE void add_elements(double *const *r, double *const *v, double factor, Vector3<double> *a) {
    const double *const e = &a->x;
    HOL_UNROLL
    for (int c = 0; c < n; ++c) {
        if (r) r[0][c] += e[c];
        if (v) v[0][c] = mul_add(factor, e[c], v[0][c]);
    }
}

// Of columns, from atom `first` of the block on.
template <int n, class V>
HOL_INLINE void move_columns(const PositionsCall &call, int64_t first, const Vector3<V> *shift) {
    const V per_dt = Width<V>::all(1 / call.dt);
    Vector3<V> a[n];
    read_columns<n>(Columns(call.r), first, a);
    HOL_UNROLL
    for (int k = 0; k < n; ++k) a[k] = a[k] + shift[k];
    write_columns<n>(Columns(call.r), first, a);
    if (!call.v.x) return;
    read_columns<n>(Columns(call.v), first, a);
    HOL_UNROLL
    for (int k = 0; k < n; ++k) a[k] = add_times(a[k], per_dt, shift[k]);
    write_columns<n>(Columns(call.v), first, a);
}

// Reading and writing that is compiled into what works on the atoms: for molecules one behind the other, for rows in
// order and for lists. anywhere: a call, which finds the layout. in_columns: adjacent, but x, y and z apart; the lanes'
// layout is `elements` then.
enum Inlined { adjacent, in_order, listed, in_columns, anywhere };

// Where atom k of a molecule of n stands.
template <Inlined where, int n, class V>
HOL_INLINE double *row_of(const AtomArray &array, const Atoms<V> &at, int i, int k = 0) {
    double *const x = reinterpret_cast<double *>(array.x);
    return where == listed     ? x + 3 * at.list[i][k]
           : where == adjacent ? x + 3 * at.first[0] + 3 * (n * i + k)
                               : x + 3 * at.first[i] + 3 * k;
}
template <Inlined where, int n, class V>
HOL_INLINE void rows_of_all(const AtomArray &array, const Atoms<V> &at, double **p, int k = 0) {
    HOL_UNROLL
    for (int i = 0; i < at.lanes; ++i) p[i] = row_of<where, n>(array, at, i, k);
}

template <int n, class V>
HOL_NOINLINE void read_some(const AtomArray &array, const Atoms<V> &at, Vector3<V> *atoms) {
    for (int k = 0; k < n; ++k) atoms[k] = read(array, at, k);
}

// The atoms 0 .. n - 1 of all lanes.
template <Inlined where, int n, class V>
HOL_INLINE void read_all(const AtomArray &array, const Atoms<V> &at, Vector3<V> *atoms) {
    double *p[Width<V>::lanes];
    if (where == anywhere) {
        Vector3<V> read[n];
        read_some<n>(array, at, read);
        HOL_UNROLL
        for (int k = 0; k < n; ++k) atoms[k] = read[k];
    } else if (where == in_columns) {
        read_columns<n>(Columns(array), at.first[0], atoms);
    } else if (where == listed) {
        HOL_UNROLL
        for (int k = 0; k < n; ++k) {
            rows_of_all<where, n>(array, at, p, k);
            read_rows(p, atoms[k]);
        }
    } else {
        rows_of_all<where, n>(array, at, p);
        read_elements<3 * n>(p, atoms);
    }
}

template <int n, class V>
HOL_NOINLINE void write_some(const AtomArray &array, const Atoms<V> &at, const Vector3<V> *atoms, unsigned which) {
    for (int k = 0; k < n; ++k) write(array, at, k, atoms[k], which);
}
template <int n, class V>
HOL_INLINE void write_copy(const AtomArray &array, const Atoms<V> &at, const Vector3<V> *atoms, unsigned which) {
    Vector3<V> copy[n];
    HOL_UNROLL
    for (int k = 0; k < n; ++k) copy[k] = atoms[k];
    write_some<n>(array, at, copy, which);
}

// The same in the lanes of `which`; `atoms` is used up.
template <Inlined where, int n, class V>
HOL_INLINE void write_all(const AtomArray &array, const Atoms<V> &at, Vector3<V> *atoms, unsigned which) {
    if (where == anywhere || __builtin_expect(which != all_of<V>, 0)) return write_copy<n>(array, at, atoms, which);
    if (where == in_columns) return write_columns<n>(Columns(array), at.first[0], atoms);
    double *p[Width<V>::lanes];
    if (where == listed) {
        HOL_UNROLL
        for (int k = 0; k < n; ++k) {
            rows_of_all<where, n>(array, at, p, k);
            write_rows(p, atoms[k]);
        }
    } else {
        rows_of_all<where, n>(array, at, p);
        write_elements<3 * n>(p, atoms);
    }
}

template <int n, class V>
HOL_NOINLINE void move_some(const PositionsCall &call, const Atoms<V> &at, const Vector3<V> *shift, unsigned which) {
    const V per_dt = Width<V>::all(1 / call.dt);
    if (at.layout == rows_listed && which == all_of<V>) {
        for (int k = 0; k < n; ++k) {
            double *p[Width<V>::lanes];
            Vector3<V> a;
            rows_of_all<listed, n>(call.r, at, p, k);
            read_rows(p, a);
            write_rows(p, a + shift[k]);
            if (!call.v.x) continue;
            rows_of_all<listed, n>(call.v, at, p, k);
            read_rows(p, a);
            write_rows(p, add_times(a, per_dt, shift[k]));
        }
        return;
    }
    for (int k = 0; k < n; ++k) {
        write(call.r, at, k, read(call.r, at, k) + shift[k], which);
        if (call.v.x) write(call.v, at, k, add_times(read(call.v, at, k), per_dt, shift[k]), which);
    }
}

// Moves the atoms of the lanes in `which` by `shift`, which is used up, and their velocities with them. Where rows
// stand in order the moves are transposed, once, and not what they are added to.
template <Inlined where, int n, class V>
HOL_INLINE void move_all(const PositionsCall &call, const Atoms<V> &at, Vector3<V> *shift, unsigned which) {
    if (where == listed || where == anywhere || __builtin_expect(which != all_of<V>, 0)) {
        Vector3<V> copy[n];
        HOL_UNROLL
        for (int k = 0; k < n; ++k) copy[k] = shift[k];
        return move_some<n>(call, at, copy, which);
    }
    if (where == in_columns) return move_columns<n>(call, at.first[0], shift);
    double *r[Width<V>::lanes], *v[Width<V>::lanes];
    rows_of_all<where, n>(call.r, at, r);
    if (!call.v.x) return add_elements<3 * n>(r, nullptr, 0, shift);
    rows_of_all<where, n>(call.v, at, v);
    add_elements<3 * n>(r, v, 1 / call.dt, shift);
}

// Three values per bond, in the order of the bonds.
template <Inlined where, class V>
HOL_INLINE void write_three(double *out, const Atoms<V> &at, const Vector3<V> &value, unsigned which) {
    if (__builtin_expect(which == all_of<V>, 1)) {
        double *p[Width<V>::lanes];
        HOL_UNROLL
        for (int i = 0; i < at.lanes; ++i)
            p[i] = where == adjacent || where == in_columns ? out + at.bond[0] + 3 * i : out + at.bond[i];
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

// Calls body(where), a constant, for a block that is full or not: what is worth code of its own are full ones of
// packed arrays.
template <class V, class Body>
HOL_INLINE auto where_atoms_are(const Atoms<V> &at, const Body &body) {
    if constexpr (!small_set) {
        if (at.layout == rows_in_order) return body(Constant<Inlined, in_order>{});
        if (at.lanes > 1 && at.layout == rows_listed) return body(Constant<Inlined, listed>{});
    }
    return body(Constant<Inlined, anywhere>{});
}

}  // namespace holonomic::HOL_ISA::graph
