// Columns: doubles x, y and z in arrays of their own. Molecules of few atoms, one behind the other, are read from there
// to lanes and written back without a copy: each component is a row of its own.
#pragma once

#include "core/kernels/arithmetic/vector3.hpp"
#include "core/kernels/call.hpp"
#include "core/kernels/memory/elements.hpp"

namespace holonomic::HOL_ISA {

struct Columns {
    double *component[3];
    explicit Columns(const AtomArray &a)
        : component{reinterpret_cast<double *>(a.x), reinterpret_cast<double *>(a.y), reinterpret_cast<double *>(a.z)} {
    }
    explicit operator bool() const { return component[0] != nullptr; }
};

HOL_INLINE bool is_in_columns(const AtomArray &a) {
    return !a.is_float && a.z && a.stride == static_cast<int64_t>(sizeof(double));
}

// Whether all arrays of a call are such.
HOL_INLINE bool reads_columns(const ForcesCall &call) {
    return is_in_columns(call.r) && (!call.v.x || is_in_columns(call.v)) && (!call.f.x || is_in_columns(call.f)) &&
           (!call.g.x || is_in_columns(call.g));
}
HOL_INLINE bool reads_columns(const VelocitiesCall &call) { return is_in_columns(call.r) && is_in_columns(call.v); }
HOL_INLINE bool reads_columns(const PositionsCall &call) {
    return is_in_columns(call.r) && is_in_columns(call.r_ref) && (!call.v.x || is_in_columns(call.v)) && !call.guess;
}

// Where the atom `first` of W molecules of n atoms has a component.
template <int n>
HOL_INLINE void rows_of_column(double *column, int64_t first, double **p) {
    HOL_UNROLL
    for (int i = 0; i < W; ++i) p[i] = column + first + n * i;
}

// Reads or writes the n atoms of W molecules, the first of which is atom `first`. What is written is used up.
template <int n>
HOL_INLINE void read_columns(const Columns &from, int64_t first, vec3 *atoms) {
    HOL_UNROLL
    for (int c = 0; c < 3; ++c) {
        double *p[W];
        rows_of_column<n>(from.component[c], first, p);
#if HOL_ELEMENTS
        vec e[n];
        read_elements<n>(p, e);
        HOL_UNROLL
        for (int k = 0; k < n; ++k) (&atoms[k].x)[c] = e[k];
#else
        for (int k = 0; k < n; ++k) {
            vec e = {};
            for (int i = 0; i < W; ++i) e[i] = p[i][k];
            (&atoms[k].x)[c] = e;
        }
#endif
    }
}

template <int n>
HOL_INLINE void write_columns(const Columns &to, int64_t first, const vec3 *atoms) {
    HOL_UNROLL
    for (int c = 0; c < 3; ++c) {
        double *p[W];
        rows_of_column<n>(to.component[c], first, p);
#if HOL_ELEMENTS
        vec e[n];
        HOL_UNROLL
        for (int k = 0; k < n; ++k) e[k] = (&atoms[k].x)[c];
        write_elements<n>(p, e);
#else
        for (int k = 0; k < n; ++k)
            for (int i = 0; i < W; ++i) p[i][k] = (&atoms[k].x)[c][i];
#endif
    }
}

// A single molecule.
template <int n>
HOL_INLINE void read_columns(const Columns &from, int64_t first, Vector3<double> *atoms) {
    for (int k = 0; k < n; ++k)
        atoms[k] = {from.component[0][first + k], from.component[1][first + k], from.component[2][first + k]};
}
template <int n>
HOL_INLINE void write_columns(const Columns &to, int64_t first, const Vector3<double> *atoms) {
    for (int k = 0; k < n; ++k) {
        to.component[0][first + k] = atoms[k].x;
        to.component[1][first + k] = atoms[k].y;
        to.component[2][first + k] = atoms[k].z;
    }
}

}  // namespace holonomic::HOL_ISA
