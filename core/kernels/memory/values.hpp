// Values per bond, into the caller's arrays: the only place that writes them for chains.
#ifndef HOLONOMIC_KERNELS_MEMORY_VALUES_HPP
#define HOLONOMIC_KERNELS_MEMORY_VALUES_HPP

#include "core/kernels/memory/block.hpp"

namespace holonomic::HOL_ISA {

// Writes the values of the bonds k0 .. k0 + W - 1 of the chosen lanes; value[W] is transposed in place. ragged: lanes
// may end there.
template <bool ragged>
HOL_INLINE void store_values(const Block &block, long k0, vec *value, unsigned chosen, double *out) {
    transpose(value);
    for (int i = 0; i < (ragged ? block.lanes : W); ++i) {
        double *const p = out + block.first_bond[i] + k0;
        if (ragged && !(chosen >> i & 1)) continue;
        if (!ragged || k0 + W <= block.len[i])
            store(p, value[i]);
        else
            for (long k = k0; k < block.len[i]; ++k) p[k - k0] = value[i][k - k0];
    }
}

// Writes factor times a value per bond, for the bonds first .. n - 1 of the lanes in `which`; zeros as +0.
static inline void store_bonds(const Block &block, const vec *value, vec factor, mask which, double *out,
                               long first = 0) {
    const unsigned chosen = bits(which & block.in_use());
    vec m[W];
    long k0 = first;
    if (chosen == all_lanes)
        for (; k0 + W <= block.n_min; k0 += W) {
            for (int b = 0; b < W; ++b) m[b] = mul_add(factor, value[k0 + b], vec{});
            store_values<false>(block, k0, m, chosen, out);
        }
    for (; k0 < block.n; k0 += W) {
        for (int b = 0; b < W; ++b) m[b] = k0 + b < block.n ? mul_add(factor, value[k0 + b], vec{}) : vec{};
        store_values<true>(block, k0, m, chosen, out);
    }
}

}  // namespace holonomic::HOL_ISA
#endif
