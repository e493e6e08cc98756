// Reads and writes the atoms of a block of molecules in the caller's arrays, one atom of every lane at a time. It takes
// whole rows if packed rows x y z stand one behind the other, or where a list says. In any other layout it takes single
// elements.
#ifndef HOLONOMIC_KERNELS_GRAPH_ATOMS_HPP
#define HOLONOMIC_KERNELS_GRAPH_ATOMS_HPP

#include "core/kernels/call.hpp"
#include "core/kernels/graph/width.hpp"
#include "core/kernels/isa/choose.hpp"
#include "core/kernels/memory/atom_rows.hpp"

namespace holonomic {
namespace HOL_ISA {
namespace graph {

// rows_adjacent: rows in order, and the molecules one behind the other.
enum Layout { rows_in_order, rows_listed, elements, rows_adjacent };

// A single molecule's, as memory/atom_rows.hpp has those of W.
HOL_INLINE void read_rows(const double *const *p, Vector3<double> &a) { a = {p[0][0], p[0][1], p[0][2]}; }

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
    // Goes on to the next block of molecules that follow each other, of so many atoms and bonds.
    HOL_FORCED void advance(int64_t n_atoms, int64_t n_bonds) {
        HOL_UNROLL
        for (int i = 0; i < lanes; ++i) {
            first[i] += lanes * n_atoms;
            bond[i] += lanes * n_bonds;
        }
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
            if (p[c]) Width<V>::set(*component[c], i, array.is_float ? element<float>(p[c]) : element<double>(p[c]));
    }
}

// Reads atom k (local number) of all lanes.
template <Layout layout, class V>
HOL_INLINE Vector3<V> read(const AtomArray &array, const Atoms<V> &at, int64_t k) {
    Vector3<V> a = {};
    if (layout == elements) {
        read_anywhere(array, at, k, a);
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

// Writes one atom of one lane, in any layout.
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

template <class V>
HOL_NOINLINE void write_anywhere(const AtomArray &array, const Atoms<V> &at, int64_t k, const Vector3<V> &a,
                                 unsigned which) {
    for (int i = 0; i < at.lanes; ++i)
        if (which >> i & 1)
            write_one(array, at.number(i, k), {Width<V>::get(a.x, i), Width<V>::get(a.y, i), Width<V>::get(a.z, i)});
}

// Writes atom k of the lanes in `which`, a bit per lane.
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
    const Vector3<V> copy = a;  // what is passed by its address stays in memory
    write_anywhere(array, at, k, copy, which);
}

// Returns how a call's arrays can be read together.
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

// Calls f with that layout as a constant.
template <class V, class F>
HOL_INLINE auto with_layout(const Atoms<V> &at, bool packed, F f) {
    switch (layout_of(at, packed)) {
        case rows_in_order:
            return f(Constant<Layout, rows_in_order>{});
        case rows_listed:
            return f(Constant<Layout, rows_listed>{});
        default:
            return f(Constant<Layout, elements>{});
    }
}

}  // namespace graph
}  // namespace HOL_ISA
}  // namespace holonomic
#endif
