// Down the chains of a block that have lists of atoms. What needs more than plain arithmetic goes the general
// way, which copies such chains into staging buffers.
#pragma once

#include "core/kernels/arithmetic/image.hpp"
#include "core/kernels/eliminate/chain.hpp"
#include "core/kernels/memory/atom_rows.hpp"
#include "core/kernels/memory/load.hpp"
#include "core/kernels/memory/outputs.hpp"

namespace holonomic::HOL_ISA {

// As substitute_and_store() (substitute.hpp), to the lists.
template <Update update>
HOL_NOINLINE void substitute_and_scatter(const Block &block, const ChainSystem &s, const AtomLists &at, double *out,
                                         double *value_out, vec factor) {
    vec t = {}, values[W];
    vec3 after = {};
    const auto pull = [&](long k, const vec3 &before) HOL_FORCED {
        if (out) scatter<update>(out, at, k, after - before);
    };
    const auto bond = [&](long k) HOL_FORCED {
        t = mul_add(s.L[k + 1], t, s.t[k]);
        const vec3 p = t * s.D[k];
        pull(k + 1, p);
        after = p;
        return mul_add(factor, t, vec{});  // zeros as +0
    };
    const long full = block.n / W * W;
    for (long k = block.n - 1; k >= full; --k) {
        const vec value = bond(k);
        for (int i = 0; value_out && i < W; ++i) value_out[block.first_bond[i] + k] = value[i];
    }
    for (long k0 = full - W; k0 >= 0; k0 -= W) {
        HOL_UNROLL
        for (long b = W - 1; b >= 0; --b) values[b] = bond(k0 + b);
        if (!value_out) continue;
        store_values<false>(block, k0, values, all_lanes, value_out);
    }
    if (out) scatter<update>(out, at, 0, after);
}

}  // namespace holonomic::HOL_ISA
