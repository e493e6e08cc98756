// Reads and writes the atoms of a block of molecules in the caller's arrays, one atom of every lane at a time: whole
// rows x y z of packed arrays, or single elements in any other layout. The layout is looked up as the program runs, so
// that what reads and writes is compiled once.
#pragma once

#include "core/kernels/arithmetic/width.hpp"
#include "core/kernels/call.hpp"
#include "core/kernels/memory/atom_rows.hpp"

namespace holonomic::HOL_ISA::graph {

// Of all arrays of a call. rows_in_order: a molecule's atoms stand one behind the other; rows_listed: where lists say.
enum Layout { rows_in_order, rows_listed, elements };

// A single molecule's, as memory/atom_rows.hpp has those of W.
HOL_INLINE void read_rows(const double *const *p, Vector3<double> &a) { a = {p[0][0], p[0][1], p[0][2]}; }

HOL_INLINE void write_rows(double *const *p, const Vector3<double> &a) {
    p[0][0] = a.x;
    p[0][1] = a.y;
    p[0][2] = a.z;
}

// Atoms of one large molecule stand anywhere: the rows of so many are fetched ahead.
constexpr int32_t rows_ahead = 48;
template <int for_writing = 0>
HOL_INLINE void fetch_row(const AtomArray &array, int64_t element) {
    const double *const p = reinterpret_cast<const double *>(array.x) + element;
    __builtin_prefetch(p, for_writing, 2);
    __builtin_prefetch(p + 2, for_writing, 2);  // it may begin at the end of a line
}

// Which atoms the lanes hold; lanes without a molecule repeat the first one and are never written.
template <class V>
struct Atoms {
    static constexpr int lanes = Width<V>::lanes;
    const int64_t *list[lanes];  // or nullptr
    int64_t first[lanes];        // offset of the first atom in rows of three doubles, or its number
    int64_t bond[lanes];         // the first bond in arrays per bond
    Layout layout;
    // packed: all arrays of the call are.
    Atoms(const MoleculeLane *lane, int used, bool packed) {
        bool lists = packed, none = packed;
        for (int i = 0; i < lanes; ++i) {
            const MoleculeLane &one = lane[i < used ? i : 0];
            list[i] = one.atoms;
            first[i] = one.first_atom;
            bond[i] = one.first_bond;
            lists = lists && one.atoms;
            none = none && !one.atoms;
        }
        layout = none ? rows_in_order : lists ? rows_listed : elements;
    }
    // Goes on to the next block of molecules that follow each other, of so many atoms and bonds.
    HOL_FORCED void advance(int64_t n_atoms, int64_t n_bonds) {
        HOL_UNROLL
        for (int i = 0; i < lanes; ++i) {
            first[i] += lanes * n_atoms;
            bond[i] += lanes * n_bonds;
        }
    }
    // Those from local atom k on.
    Atoms from(int64_t k) const {
        Atoms rest = *this;
        for (int i = 0; i < lanes; ++i)
            if (list[i])
                rest.list[i] += k;
            else
                rest.first[i] += k;
        return rest;
    }
    HOL_FORCED int64_t number(int i, int64_t k) const { return list[i] ? list[i][k] : first[i] + k; }
};

template <class T>
HOL_INLINE double element(const char *p) {
    return static_cast<double>(*reinterpret_cast<const T *>(p));
}

// In any layout. Out of line: wherever atoms are read it would be the larger part of the code.
template <class V>
HOL_NOINLINE void read_anywhere(const AtomArray &array, const Atoms<V> &at, int64_t k, Vector3<V> &a) {
    a = Vector3<V>{};
    for (int i = 0; i < at.lanes; ++i) {
        const int64_t offset = at.number(i, k) * array.stride;
        const char *const p[3] = {array.x + offset, array.y + offset, array.z ? array.z + offset : nullptr};
        V *const component[3] = {&a.x, &a.y, &a.z};
        for (int c = 0; c < 3; ++c)
            if (p[c])
                Width<V>::set(*component[c], i, holds_floats(array) ? element<float>(p[c]) : element<double>(p[c]));
    }
}

// Where atom k (local number) of each lane stands in an array of rows.
template <class V>
HOL_INLINE void rows_of_atom(const AtomArray &array, const Atoms<V> &at, int64_t k, double **p) {
    double *const base = reinterpret_cast<double *>(array.x);
    HOL_UNROLL
    for (int i = 0; i < at.lanes; ++i) p[i] = base + 3 * (at.layout == rows_listed ? at.list[i][k] : at.first[i] + k);
}

// Reads atom k of all lanes.
template <class V>
HOL_INLINE Vector3<V> read(const AtomArray &array, const Atoms<V> &at, int64_t k) {
    Vector3<V> a = {};
    if (__builtin_expect(at.layout == elements, 0)) {
        read_anywhere(array, at, k, a);
        return a;
    }
    double *p[Width<V>::lanes];
    rows_of_atom(array, at, k, p);
    read_rows(p, a);
    return a;
}

template <class T>
HOL_INLINE void put(char *p, double x) {
    *reinterpret_cast<T *>(p) = static_cast<T>(x);
}

// Writes one atom of one lane, in any layout.
HOL_INLINE void write_one(const AtomArray &array, int64_t number, const Vector3<double> &a) {
    const double value[3] = {a.x, a.y, a.z};
    char *const p[3] = {array.x, array.y, array.z};
    for (int c = 0; c < 3; ++c) {
        if (!p[c]) continue;
        if (holds_floats(array))
            put<float>(p[c] + number * array.stride, value[c]);
        else
            put<double>(p[c] + number * array.stride, value[c]);
    }
}

template <class V>
HOL_NOINLINE void write_anywhere(const AtomArray &array, const Atoms<V> &at, int64_t k, const Vector3<V> &a,
                                 unsigned which) {
    for (int i = 0; i < at.lanes; ++i)
        if (which >> i & 1)
            write_one(array, at.number(i, k), {Width<V>::get(a.x, i), Width<V>::get(a.y, i), Width<V>::get(a.z, i)});
}

// Writes atom k of the lanes in `which`, a bit per lane.
template <class V>
HOL_INLINE void write(const AtomArray &array, const Atoms<V> &at, int64_t k, const Vector3<V> &a, unsigned which) {
    if (__builtin_expect(at.layout != elements && which == all_of<V>, 1)) {
        double *p[Width<V>::lanes];
        rows_of_atom(array, at, k, p);
        return write_rows(p, a);
    }
    // What is passed by its address stays in memory. NOLINTNEXTLINE(performance-unnecessary-copy-initialization)
    const Vector3<V> copy = a;
    write_anywhere(array, at, k, copy, which);
}

}  // namespace holonomic::HOL_ISA::graph
