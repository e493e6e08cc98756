// The way down a block of chains: multipliers, and what they do to the atoms, stored as they are found.
#ifndef HOLONOMIC_KERNELS_ELIMINATE_SUBSTITUTE_HPP
#define HOLONOMIC_KERNELS_ELIMINATE_SUBSTITUTE_HPP

#include "core/kernels/eliminate/chain.hpp"
#include "core/kernels/memory/prefetch.hpp"
#include "core/kernels/memory/pulls.hpp"

namespace holonomic {
namespace HOL_ISA {

// The backward sweep, and what it gives written at once: G (see store_pulls_from) to `out`, and factor t to
// value_out[bond]; either may be absent. For blocks in which all lanes are used and good, and can't overflow (calm()).
template <Update update>
HOL_NOINLINE void substitute_and_store(const Block &block, const System &s, const Packed &out, double *value_out,
                                       vec factor) {
    const long full = block.n_min / W * W;
    vec t = {};
    vec3 after = {};  // t d of the bond behind
    if (full < block.n) {
        backward(full, block.n, s.t, s.L);
        t = s.t[full];
        after = scaled_bond(s.D[full], t);
    } else {
        s.L[block.n] = vec{};
    }
    // Bonds full .. n-1 and the atoms behind them.
    for (long k0 = full + 1; out.lane[0] && k0 <= block.n; k0 += W) {
        vec value[3 * W] = {};
        for (long a = 0; a < W && k0 + a <= block.n; ++a) {
            const long k = k0 + a;
            const vec3 left = scaled_bond(s.D[k - 1], s.t[k - 1]);
            const vec3 right = k < block.n ? scaled_bond(s.D[k], s.t[k]) : vec3{};
            value[3 * a] = right.x - left.x;
            value[3 * a + 1] = right.y - left.y;
            value[3 * a + 2] = right.z - left.z;
        }
        store_ragged<update>(block, k0, value, (1u << W) - 1, out);
    }
    if (value_out)
        for (int i = 0; i < W; ++i)
            for (long k = full; k < block.len[i]; ++k)
                value_out[block.first_bond[i] + k] = mul_add(factor[i], s.t[k][i], 0.0);
    for (long k0 = full - W; k0 >= 0; k0 -= W) {
        vec value[3 * W], bond_value[W];
        HOL_UNROLL
        for (long b = W - 1; b >= 0; --b) {
            const long k = k0 + b;
            t = mul_add(s.L[k + 1], t, s.t[k]);
            bond_value[b] = mul_add(factor, t, vec{});  // zeros as +0
            const vec3 p = scaled_bond(s.D[k], t);
            value[3 * b] = after.x - p.x;
            value[3 * b + 1] = after.y - p.y;
            value[3 * b + 2] = after.z - p.z;
            after = p;
        }
        if (out.lane[0]) {
            if (update == write_ && block.ahead) fetch_ahead(out.lane[0], k0, block.ahead);
            store_chunk<update>(k0 + 1, value, out);
        }
        if (value_out) {
            transpose(bond_value);
            for (int i = 0; i < W; ++i) store(value_out + block.first_bond[i] + k0, bond_value[i]);
        }
    }
    if (!out.lane[0]) return;
    for (int i = 0; i < W; ++i) {
        double *const p = out.lane[i];
        p[0] = update == add_ ? p[0] + after.x[i] : after.x[i];
        p[1] = update == add_ ? p[1] + after.y[i] : after.y[i];
        p[2] = update == add_ ? p[2] + after.z[i] : after.z[i];
    }
}

}  // namespace HOL_ISA
}  // namespace holonomic
#endif
