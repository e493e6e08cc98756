// Vectors of all atoms of a block of molecules: from the caller's arrays to the atoms' indices, and back. Each way is
// compiled once, with a loop for each layout, and what is done with the vectors knows nothing of where they came from.
// Atoms are taken in the order of the caller's arrays; where their rows follow each other, four are twelve doubles of
// each lane.
#pragma once

#include "core/kernels/molecules/atoms/consecutive.hpp"
#include "core/plan/elimination.hpp"

namespace holonomic::HOL_ISA::graph {

// Where the vector of index s stands: in a working array, or as three members, one behind the other, of a row per
// index.
template <class V>
struct ByIndex {
    V *first;
    int64_t stride;
    explicit ByIndex(Vector3<V> *a) : first(&a->x), stride(3) {}
    template <class Row>
    ByIndex(Row *, V *member) : first(member), stride(sizeof(Row) / sizeof(V)) {}
    HOL_FORCED Vector3<V> &operator[](int64_t index) const {
        return *reinterpret_cast<Vector3<V> *>(first + index * stride);
    }
    HOL_FORCED void put(int64_t index, const Vector3<V> &a) const {
        V *const to = first + index * stride;
        to[0] = a.x;
        to[1] = a.y;
        to[2] = a.z;
    }
};

constexpr int atoms_at_once = 4;

// The rows of the atoms from number `first` on, of lanes whose rows stand in order.
template <class V>
HOL_INLINE void rows_from(const AtomArray &array, const Atoms<V> &at, int64_t first, double **p) {
    double *const base = reinterpret_cast<double *>(array.x) + 3 * first;
    HOL_UNROLL
    for (int i = 0; i < at.lanes; ++i) p[i] = base + 3 * at.first[i];
}
// Calls body(first, p) for groups of four atoms of lanes whose rows stand in order; returns the first atom left.
template <class V, class Body>
HOL_INLINE int32_t for_groups(const AtomArray &array, const Atoms<V> &at, int32_t n, const Body &body) {
    int32_t k = 0;
    for (; k + atoms_at_once <= n; k += atoms_at_once) {
        double *p[Width<V>::lanes];
        rows_from(array, at, k, p);
        body(k, p);
    }
    return k;
}
// Calls body(k, p) for the atoms first .. n - 1 of packed arrays.
template <class V, class Body>
HOL_INLINE void for_rows(const AtomArray &array, const Atoms<V> &at, int32_t first, int32_t n, const Body &body) {
    double *const base = reinterpret_cast<double *>(array.x);
    if (at.layout == rows_in_order) {
        for (int32_t k = first; k < n; ++k) {
            double *p[Width<V>::lanes];
            rows_from(array, at, k, p);
            body(k, p);
        }
        return;
    }
    const int64_t *list[Width<V>::lanes];
    HOL_UNROLL
    for (int i = 0; i < at.lanes; ++i) list[i] = at.list[i];
    for (int32_t k = first; k < n; ++k) {
        double *p[Width<V>::lanes];
        HOL_UNROLL
        for (int i = 0; i < at.lanes; ++i) p[i] = base + 3 * list[i][k];
        body(k, p);
    }
}

// Reads the vectors of n atoms; index_of has their indices.
template <class V>
HOL_NOINLINE void read_vectors(const AtomArray &array, const Atoms<V> &at, const int32_t *index_of, int32_t n,
                               const ByIndex<V> to) {
    if (at.layout == elements) {
        for (int32_t k = 0; k < n; ++k) to[index_of[k]] = read(array, at, k);
        return;
    }
    int32_t first = 0;
    if (at.layout == rows_in_order)
        first = for_groups(array, at, n, [&](int32_t k, double **p) HOL_FORCED {
            Vector3<V> a[atoms_at_once];
            read_elements<3 * atoms_at_once>(p, a);
            HOL_UNROLL
            for (int j = 0; j < atoms_at_once; ++j) to.put(index_of[k + j], a[j]);
        });
    for_rows(array, at, first, n, [&](int32_t k, double **p) HOL_FORCED {
        Vector3<V> a;
        read_rows(p, a);
        to.put(index_of[k], a);
    });
}

// What is written of a block, and how.
template <class V>
struct Written {
    unsigned which;              // lanes
    const unsigned char *fixed;  // [n] atoms that are left out, or nullptr
    const MoleculeLane *lane;    // whose atoms may belong to others, too, and are left out then; or nullptr
    bool add = false;            // to what is there
    int32_t first = 0;           // of the lanes' atoms
    unsigned right = 0;          // lanes that stay as they are

    unsigned lanes_of(int32_t atom) const {
        unsigned left = fixed && fixed[atom] ? 0 : which;
        for (int i = 0; lane && i < Width<V>::lanes; ++i)
            if (lane[i].shared && lane[i].shared[first + atom]) left &= ~(1u << i);
        return left;
    }
    bool all() const {
        bool all = which == all_of<V> && !fixed;
        for (int i = 0; lane && i < Width<V>::lanes; ++i) all = all && !lane[i].shared;
        return all;
    }
    bool all_but_right() const { return right != 0 && (which | right) == all_of<V> && !fixed && !lane; }
};

// Writes the vectors of n atoms, from[index].
template <class V, class From>
HOL_NOINLINE void write_vectors(const AtomArray &array, const Atoms<V> &at, const int32_t *index_of, int32_t n,
                                const From from, const Written<V> what) {
    if (!what.all() || at.layout == elements) {
        for (int32_t k = 0; k < n; ++k) {
            const unsigned which = what.lanes_of(k);
            if (!which) continue;
            const Vector3<V> a = from[index_of[k]];
            write(array, at, k, what.add ? read(array, at, k) + a : a, which);
        }
        return;
    }
    int32_t first = 0;
    if (at.layout == rows_in_order)
        first = for_groups(array, at, n, [&](int32_t k, double **p) HOL_FORCED {
            Vector3<V> a[atoms_at_once];
            HOL_UNROLL
            for (int j = 0; j < atoms_at_once; ++j) a[j] = from[index_of[k + j]];
            if (what.add)
                add_elements<3 * atoms_at_once>(p, nullptr, 0, a);
            else
                write_elements<3 * atoms_at_once>(p, a);
        });
    for_rows(array, at, first, n, [&](int32_t k, double **p) HOL_FORCED {
        Vector3<V> a = from[index_of[k]], before;
        if (what.add) {
            read_rows(p, before);
            a = before + a;
        }
        write_rows(p, a);
    });
}

// The displacement of the atom at an index: w times what pulls it, zeros as +0.
template <class V>
struct Displacements {
    ByIndex<V> pull;
    const V *w;
    HOL_FORCED Vector3<V> operator[](int64_t index) const { return add_times(Vector3<V>{}, w[index], pull[index]); }
};
// Moves n atoms by moves[index], and their velocities with them.
template <class V, class Moves>
HOL_NOINLINE void move_vectors(const PositionsCall &call, const Atoms<V> &at, const int32_t *index_of, int32_t n,
                               const Moves moves, const Written<V> what) {
    const double per_dt = 1 / call.dt;
    const V factor = Width<V>::all(per_dt);
    const auto move_rows = [&](int32_t first, const auto &move_of) HOL_FORCED {
        for_rows(call.r, at, first, n, [&](int32_t k, double **p) HOL_FORCED {
            const Vector3<V> a = move_of(k);
            Vector3<V> before;
            read_rows(p, before);
            write_rows(p, before + a);
        });
        if (!call.v.x) return;
        for_rows(call.v, at, first, n, [&](int32_t k, double **p) HOL_FORCED {
            Vector3<V> before;
            read_rows(p, before);
            write_rows(p, add_times(before, factor, move_of(k)));
        });
    };
    if (what.all_but_right() && at.layout != elements) {  // these move by -0, which leaves every bit: no lane is masked
        const MaskOf<V> moved = Width<V>::of_bits(what.which);
        const V still = Width<V>::all(-0.0);
        return move_rows(0, [&](int32_t k) HOL_FORCED {
            const Vector3<V> a = moves[index_of[k]];
            return Vector3<V>{select(moved, a.x, still), select(moved, a.y, still), select(moved, a.z, still)};
        });
    }
    if (!what.all() || at.layout == elements) {
        for (int32_t k = 0; k < n; ++k) {
            const unsigned which = what.lanes_of(k);
            if (!which) continue;
            const Vector3<V> a = moves[index_of[k]];
            write(call.r, at, k, read(call.r, at, k) + a, which);
            if (call.v.x) write(call.v, at, k, add_times(read(call.v, at, k), factor, a), which);
        }
        return;
    }
    int32_t first = 0;
    if (at.layout == rows_in_order)
        first = for_groups(call.r, at, n, [&](int32_t k, double **r) HOL_FORCED {
            double *v[Width<V>::lanes];
            Vector3<V> a[atoms_at_once];
            HOL_UNROLL
            for (int j = 0; j < atoms_at_once; ++j) a[j] = moves[index_of[k + j]];
            if (!call.v.x) return add_elements<3 * atoms_at_once>(r, nullptr, 0, a);
            rows_from(call.v, at, k, v);
            add_elements<3 * atoms_at_once>(r, v, per_dt, a);
        });
    move_rows(first, [&](int32_t k) HOL_FORCED { return moves[index_of[k]]; });
}

}  // namespace holonomic::HOL_ISA::graph
