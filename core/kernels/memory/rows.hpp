// Rows: W doubles of one lane as they stand in memory, and their transposition into lanes.
#ifndef HOLONOMIC_KERNELS_MEMORY_ROWS_HPP
#define HOLONOMIC_KERNELS_MEMORY_ROWS_HPP

#include "core/kernels/arithmetic/vector3.hpp"
#include "core/kernels/memory/block.hpp"

namespace holonomic::HOL_ISA {

// Returns where W + 1 atoms can be read from atom k of a vector [len+1][3] on. If some lie past its end, that is
// buffer[3 W + 3], padded with zeros.
HOL_INLINE const double *window(const double *p, long k, long len, bool roomy, double *buffer) {
    if (__builtin_expect(roomy || k + W <= len, 1)) return p + 3 * k;
    const long left = len - k + 1 > 0 ? 3 * (len - k + 1) : 0;
    for (long i = 0; i < 3 * W + 3; ++i) buffer[i] = i < left ? p[3 * k + i] : 0.0;
    return buffer;
}

// Puts values along the lanes into out[n]. It reads rows[lane][k] while all lanes have one (k < count + more), and
// calls value(lane, k) from there on.
template <class Value>
HOL_INLINE void interleave(const double *const *rows, const long *count, long more, long n, vec *out,
                           const Value &value) {
    long full = n, k = 0;
    for (int i = 0; i < W; ++i) full = !rows[i] ? 0 : count[i] + more < full ? count[i] + more : full;
    for (; k + W <= full; k += W) {
        vec m[W];
        for (int i = 0; i < W; ++i) m[i] = load(rows[i] + k);
        transpose(m);
        for (int a = 0; a < W; ++a) out[k + a] = m[a];
    }
    for (; k < n; ++k)
        for (int i = 0; i < W; ++i) out[k][i] = value(i, k);
}

// The atoms k0 .. k0 + W - 1 of all lanes, from pointers to atom k0.
HOL_INLINE void load_atoms(const double *const *p, vec3 *atoms) {
    vec *const elements = &atoms->x;
    HOL_UNROLL
    for (int j = 0; j < 3; ++j) {
        vec e[W];
        HOL_UNROLL
        for (int i = 0; i < W; ++i) e[i] = load(p[i] + W * j);
        transpose(e);
        HOL_UNROLL
        for (int i = 0; i < W; ++i) elements[j * W + i] = e[i];
    }
}

HOL_INLINE vec3 load_atom(const Packed &p) {
    vec3 a = {};
    for (int i = 0; i < W; ++i) {
        a.x[i] = p.lane[i][0];
        a.y[i] = p.lane[i][1];
        a.z[i] = p.lane[i][2];
    }
    return a;
}

// The atoms k0 + 1 .. k0 + W where lanes may end. Vectors behind an end have any value.
HOL_NOINLINE void load_ragged_atoms(const Block &block, const Packed &p, long k0, vec3 *atoms) {
    double buffer[W][3 * W + 3];
    const double *from[W];
    for (int i = 0; i < W; ++i) from[i] = window(p.lane[i], k0, block.len[i], block.roomy, buffer[i]) + 3;
    load_atoms(from, atoms + k0 + 1);
}

}  // namespace holonomic::HOL_ISA
#endif
