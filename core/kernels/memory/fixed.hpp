// Small molecules of one kind over consecutive atoms: the same arithmetic as for any block, with the number of bonds
// known to the compiler, so that everything stays in registers. What needs more than plain arithmetic, and the last
// molecules of a unit, behind which nothing may be read, are left to the general path.
#ifndef HOLONOMIC_KERNELS_MEMORY_FIXED_HPP
#define HOLONOMIC_KERNELS_MEMORY_FIXED_HPP

#include "core/kernels/arithmetic/vector3.hpp"
#include "core/kernels/memory/block.hpp"
#include "core/kernels/memory/sink.hpp"
#include "core/kernels/memory/terms.hpp"

namespace holonomic {
namespace HOL_ISA {

constexpr int largest_molecule = 5;

// Vectors of W molecules' atoms, rounded up to what is transposed at a time.
template <int N>
constexpr int vectors_of = (3 * (N + 1) + W - 1) / W *W;

// The atoms of W molecules: element 3 a + c is component c of atom a. Up to W - 1 doubles behind each are read.
template <int N>
HOL_INLINE void load_molecules(const double *p, vec *elements) {
    HOL_UNROLL
    for (int j = 0; j < vectors_of<N> / W; ++j) {
        HOL_UNROLL
        for (int i = 0; i < W; ++i) elements[j * W + i] = load(p + 3 * (N + 1) * i + j * W);
        transpose(elements + j * W);
    }
}

// Bonds D[k] of W molecules and their right-hand sides t[k], rounded as load_chunk() does.
template <int N, int terms, bool uniform>
HOL_INLINE void load_molecules(const Block &block, const double *r, const double *v, const double *f, vec3 *D, vec *t) {
    vec e[vectors_of<N>], p[3 * N], *const d = &D[0].x;
    load_molecules<N>(r, e);
    HOL_UNROLL
    for (int c = 0; c < 3 * N; ++c) d[c] = e[c + 3] - e[c];
    if (terms == none_) return;
    if (terms & velocity_squared) {
        load_molecules<N>(v, e);
        HOL_UNROLL
        for (int c = 0; c < 3 * N; ++c) {
            const vec dv = e[c + 3] - e[c];
            p[c] = square<terms>(block.mass, dv);
        }
    }
    if (terms & force_difference) {
        load_molecules<N>(f, e);
        HOL_UNROLL
        for (int c = 0; c < 3 * N; ++c) {
            const vec df = uniform ? e[c + 3] - e[c] : block.w[c / 3 + 1] * e[c + 3] - block.w[c / 3] * e[c];
            p[c] = product<terms>(d[c], vec{}, df, p[c]);
        }
    }
    HOL_UNROLL
    for (int k = 0; k < N; ++k) t[k] = (p[3 * k] + p[3 * k + 1]) + p[3 * k + 2];
}

// Writes the atoms of W molecules, elements as above, transposed in place.
template <int N, Update update>
HOL_INLINE void store_elements(vec *value, double *out) {
    constexpr int elements = 3 * (N + 1), full = elements / W, rest = elements % W;
    HOL_UNROLL
    for (int j = 0; j < full; ++j) transpose(value + j * W);
    for (int i = 0; i < W; ++i)  // in the order of the addresses: faster from memory
        for (int j = 0; j < full; ++j) {
            double *p = out + elements * i + j * W;
            store(p, update == add_ ? load(p) + value[j * W + i] : value[j * W + i]);
        }
    HOL_UNROLL
    for (int e = 0; e < rest; ++e)
        for (int i = 0; i < W; ++i) {
            double &p = out[elements * i + full * W + e];
            p = update == add_ ? p + value[full * W + e][i] : value[full * W + e][i];
        }
}

// G of the atoms of W molecules.
template <int N, Update update>
HOL_INLINE void store_pulls(const vec3 *D, const vec *t, double *out) {
    vec value[vectors_of<N>];
    vec3 before = {};
    HOL_UNROLL
    for (int k = 0; k <= N; ++k) {
        const vec3 after = k < N ? times(t[k], D[k]) : vec3{}, g = minus(after, before);
        value[3 * k] = g.x;
        value[3 * k + 1] = g.y;
        value[3 * k + 2] = g.z;
        before = after;
    }
    store_elements<N, update>(value, out);
}

// Writes factor times a value per bond of W molecules; zeros as +0. Rows of W elements, the rest of which the next
// molecule's row overwrites, as long as they stay inside.
template <int N>
HOL_INLINE void store_multipliers(const vec *t, vec factor, double *out) {
    constexpr int whole = N < W ? N : W;
    vec row[W] = {};
    HOL_UNROLL
    for (int k = 0; k < whole; ++k) row[k] = mul_add(factor, t[k], vec{});
    if (N == 1) return store(out, row[0]);
    transpose(row);
    HOL_UNROLL
    for (int i = 0; i < W; ++i) {
        if (N * i + W <= N * W)
            store(out + N * i, row[i]);
        else
            for (int k = 0; k < whole; ++k) out[N * i + k] = row[i][k];
    }
    HOL_UNROLL
    for (int k = whole; k < N; ++k) {
        const vec value = mul_add(factor, t[k], vec{});
        for (int i = 0; i < W; ++i) out[N * i + k] = value[i];
    }
}

// Whether W molecules from `first` on may be done here: W atoms behind them can be read, or need not be.
HOL_INLINE bool molecules_left(const Unit &unit, int64_t first) {
    const int64_t n = unit.lanes[0].n_bonds;
    return W == 1 ? first < unit.count : (unit.count - first - W) * (n + 1) >= W;
}

}  // namespace HOL_ISA
}  // namespace holonomic
#endif
