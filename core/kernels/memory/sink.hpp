// Writing a block: values per bond and vectors per atom, transposed back into the caller's layout.
#ifndef HOLONOMIC_KERNELS_MEMORY_SINK_HPP
#define HOLONOMIC_KERNELS_MEMORY_SINK_HPP

#include "core/kernels/memory/block.hpp"

namespace holonomic {
namespace HOL_ISA {

// Writes factor times a value per bond of the lanes in `which` into the caller's array per bond; zeros as +0.
static inline void store_bonds(const Block &block, const vec *value, vec factor, mask which, double *out) {
    const unsigned chosen = bits(which & block.in_use());
    double *p[W];
    for (int i = 0; i < block.lanes; ++i) p[i] = out + block.first_bond[i];
    long k0 = 0;
    if (chosen == (1u << W) - 1)
        for (; k0 + W <= block.n_min; k0 += W) {
            vec m[W];
            for (int b = 0; b < W; ++b) m[b] = mul_add(factor, value[k0 + b], vec{});
            transpose(m);
            for (int i = 0; i < W; ++i) store(p[i] + k0, m[i]);
        }
    for (int i = 0; i < block.lanes; ++i)
        if (chosen >> i & 1)
            for (long k = k0; k < block.len[i]; ++k) p[i][k] = mul_add(factor[i], value[k][i], 0.0);
}

enum Update { write_, add_ };

// Writes W consecutive atoms from atom k0 on, given component by component (value[3 W], transposed in place), of all
// lanes.
template <Update update>
HOL_INLINE void store_chunk(long k0, vec *value, const Packed &out) {
    HOL_UNROLL
    for (int j = 0; j < 3; ++j) {
        transpose(value + j * W);
        for (int i = 0; i < W; ++i) {
            double *p = out.lane[i] + 3 * k0 + j * W;
            store(p, update == add_ ? load(p) + value[j * W + i] : value[j * W + i]);
        }
    }
}

// The same where lanes may end, or be left out.
template <Update update>
HOL_INLINE void store_ragged(const Block &block, long k0, vec *value, unsigned chosen, const Packed &out) {
    for (int j = 0; j < 3; ++j) transpose(value + j * W);
    for (int i = 0; i < block.lanes; ++i) {
        if (!(chosen >> i & 1)) continue;
        double *p = out.lane[i] + 3 * k0;
        long left = 3 * (block.len[i] + 1 - k0);
        for (int j = 0; j < 3 && left > 0; ++j, left -= W, p += W) {
            const vec x = value[j * W + i];
            if (left >= W)
                store(p, update == add_ ? load(p) + x : x);
            else
                for (long e = 0; e < left; ++e) p[e] = update == add_ ? p[e] + x[e] : x[e];
        }
    }
}

}  // namespace HOL_ISA
}  // namespace holonomic
#endif
