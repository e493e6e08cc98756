// Reading and writing the atoms of a block of molecules in the caller's arrays, one atom of every lane at a time: where
// packed rows x y z stand one behind the other or where a list says, by whole rows; in any other layout by elements.
#ifndef HOLONOMIC_KERNELS_GRAPH_ATOMS_HPP
#define HOLONOMIC_KERNELS_GRAPH_ATOMS_HPP

#include "core/kernels/call.hpp"
#include "core/kernels/graph/width.hpp"

namespace holonomic {
namespace HOL_ISA {
namespace graph {

// rows_adjacent: rows in order, and the molecules one behind the other.
enum Layout { rows_in_order, rows_listed, elements, rows_adjacent };

// Rows x y z of four lanes, from and to memory; of row i the element behind z is not touched.
#if HOL_LANES >= 4 && defined(__AVX2__)
typedef double quad __attribute__((vector_size(32)));

HOL_INLINE void transpose_quads(quad *m) {
    const quad a = _mm256_unpacklo_pd(m[0], m[1]), b = _mm256_unpackhi_pd(m[0], m[1]);
    const quad c = _mm256_unpacklo_pd(m[2], m[3]), d = _mm256_unpackhi_pd(m[2], m[3]);
    m[0] = _mm256_permute2f128_pd(a, c, 0x20);
    m[1] = _mm256_permute2f128_pd(b, d, 0x20);
    m[2] = _mm256_permute2f128_pd(a, c, 0x31);
    m[3] = _mm256_permute2f128_pd(b, d, 0x31);
}

HOL_INLINE void read_rows(const double *const *p, quad &x, quad &y, quad &z) {
    const __m256i three = _mm256_setr_epi64x(-1, -1, -1, 0);
    quad row[4];
    HOL_UNROLL
    for (int i = 0; i < 4; ++i) row[i] = _mm256_maskload_pd(p[i], three);
    transpose_quads(row);
    x = row[0];
    y = row[1];
    z = row[2];
}

HOL_INLINE void write_rows(double *const *p, quad x, quad y, quad z) {
    const quad even = _mm256_unpacklo_pd(x, y), odd = _mm256_unpackhi_pd(x, y);
    HOL_UNROLL
    for (int i = 0; i < 4; ++i) {
        const quad pair = i % 2 ? odd : even;
        _mm_storeu_pd(p[i], i < 2 ? _mm256_castpd256_pd128(pair) : _mm256_extractf128_pd(pair, 1));
        p[i][2] = z[i];
    }
}
#endif

HOL_INLINE void read_rows(const double *const *p, Vector3<vec> &a) {
#if HOL_LANES == 4 && defined(__AVX2__)
    read_rows(p, a.x, a.y, a.z);
#elif HOL_LANES == 8 && defined(__AVX512F__)
    quad x[2], y[2], z[2];
    for (int h = 0; h < 2; ++h) read_rows(p + 4 * h, x[h], y[h], z[h]);
    a.x = _mm512_insertf64x4(_mm512_castpd256_pd512(x[0]), x[1], 1);
    a.y = _mm512_insertf64x4(_mm512_castpd256_pd512(y[0]), y[1], 1);
    a.z = _mm512_insertf64x4(_mm512_castpd256_pd512(z[0]), z[1], 1);
#else
    for (int i = 0; i < W; ++i) {
        a.x[i] = p[i][0];
        a.y[i] = p[i][1];
        a.z[i] = p[i][2];
    }
#endif
}
HOL_INLINE void read_rows(const double *const *p, Vector3<double> &a) { a = {p[0][0], p[0][1], p[0][2]}; }

HOL_INLINE void write_rows(double *const *p, const Vector3<vec> &a) {
#if HOL_LANES == 4 && defined(__AVX2__)
    write_rows(p, a.x, a.y, a.z);
#elif HOL_LANES == 8 && defined(__AVX512F__)
    write_rows(p, _mm512_castpd512_pd256(a.x), _mm512_castpd512_pd256(a.y), _mm512_castpd512_pd256(a.z));
    write_rows(p + 4, _mm512_extractf64x4_pd(a.x, 1), _mm512_extractf64x4_pd(a.y, 1), _mm512_extractf64x4_pd(a.z, 1));
#else
    for (int i = 0; i < W; ++i) {
        p[i][0] = a.x[i];
        p[i][1] = a.y[i];
        p[i][2] = a.z[i];
    }
#endif
}
HOL_INLINE void write_rows(double *const *p, const Vector3<double> &a) {
    p[0][0] = a.x;
    p[0][1] = a.y;
    p[0][2] = a.z;
}

// Which atoms the lanes hold; lanes without a molecule repeat the first one and are never written.
template <class V>
struct Atoms {
    static constexpr int lanes = Width<V>::lanes;
    const int64_t *list[lanes];  // or nullptr
    int64_t first[lanes];        // offset of the first atom in rows of three doubles, or its number
    int64_t bond[lanes];         // the first bond in arrays per bond
    Atoms(const MoleculeLane *lane, int used) {
        for (int i = 0; i < lanes; ++i) {
            const MoleculeLane &one = lane[i < used ? i : 0];
            list[i] = one.atoms;
            first[i] = one.first_atom;
            bond[i] = one.first_bond;
        }
    }
    // To the next block of molecules that follow each other, of so many atoms and bonds.
    HOL_INLINE void advance(Atoms &a, int64_t n_atoms, int64_t n_bonds) {
        HOL_UNROLL
        for (int i = 0; i < lanes; ++i) {
            a.first[i] += lanes * n_atoms;
            a.bond[i] += lanes * n_bonds;
        }
    }
    HOL_INLINE int64_t number(const Atoms &a, int i, int64_t k) { return a.list[i] ? a.list[i][k] : a.first[i] + k; }
};

template <class T>
HOL_INLINE double element(const char *p) {
    return static_cast<double>(*reinterpret_cast<const T *>(p));
}

// Atom k (local number) of all lanes.
template <Layout layout, class V>
HOL_INLINE Vector3<V> read(const AtomArray &array, const Atoms<V> &at, int64_t k) {
    Vector3<V> a = {};
    if (layout == elements) {
        for (int i = 0; i < at.lanes; ++i) {
            const int64_t offset = Atoms<V>::number(at, i, k) * array.stride;
            const char *const p[3] = {array.x + offset, array.y + offset, array.z ? array.z + offset : nullptr};
            V *const component[3] = {&a.x, &a.y, &a.z};
            for (int c = 0; c < 3; ++c)
                if (p[c])
                    Width<V>::set(*component[c], i, array.is_float ? element<float>(p[c]) : element<double>(p[c]));
        }
        return a;
    }
    const double *const base = reinterpret_cast<const double *>(array.x) + (layout == rows_in_order ? 3 * k : 0);
    const double *p[Width<V>::lanes];
    HOL_UNROLL
    for (int i = 0; i < at.lanes; ++i) p[i] = base + 3 * (layout == rows_listed ? at.list[i][k] : at.first[i]);
    read_rows(p, a);
    return a;
}

template <class T>
HOL_INLINE void put(char *p, double x) {
    *reinterpret_cast<T *>(p) = static_cast<T>(x);
}

// One atom of one lane, in any layout.
HOL_INLINE void write_one(const AtomArray &array, int64_t number, const Vector3<double> &a) {
    const double value[3] = {a.x, a.y, a.z};
    char *const p[3] = {array.x, array.y, array.z};
    for (int c = 0; c < 3; ++c) {
        if (!p[c]) continue;
        if (array.is_float)
            put<float>(p[c] + number * array.stride, value[c]);
        else
            put<double>(p[c] + number * array.stride, value[c]);
    }
}

// Atom k of the lanes in `which`, a bit per lane.
template <Layout layout, class V>
HOL_INLINE void write(const AtomArray &array, const Atoms<V> &at, int64_t k, const Vector3<V> &a, unsigned which) {
    if (layout != elements && __builtin_expect(which == (1u << at.lanes) - 1, 1)) {
        double *const base = reinterpret_cast<double *>(array.x) + (layout == rows_in_order ? 3 * k : 0);
        double *p[Width<V>::lanes];
        HOL_UNROLL
        for (int i = 0; i < at.lanes; ++i) p[i] = base + 3 * (layout == rows_listed ? at.list[i][k] : at.first[i]);
        write_rows(p, a);
        return;
    }
    for (int i = 0; i < at.lanes; ++i)
        if (which >> i & 1)
            write_one(array, Atoms<V>::number(at, i, k),
                      {Width<V>::get(a.x, i), Width<V>::get(a.y, i), Width<V>::get(a.z, i)});
}

// How a call's arrays can be read together.
template <class V>
HOL_INLINE Layout layout_of(const Atoms<V> &at, bool packed) {
    if (!packed) return elements;
    bool lists = true, none = true;
    for (int i = 0; i < at.lanes; ++i) {
        lists = lists && at.list[i];
        none = none && !at.list[i];
    }
    return none ? rows_in_order : lists ? rows_listed : elements;
}

}  // namespace graph
}  // namespace HOL_ISA
}  // namespace holonomic
#endif
