// Down the chains of a block whose lanes lie in rows.
#pragma once

#include "core/kernels/eliminate/chain.hpp"
#include "core/kernels/eliminate/one_lane.hpp"
#include "core/kernels/memory/outputs.hpp"
#include "core/kernels/memory/prefetch.hpp"

namespace holonomic::HOL_ISA {

// The backward sweep, which writes at once what it finds: G (see store_pulls) to `out`, and factor t to
// value_out[bond]. Either may be absent. For blocks in which all lanes are used, good and calm(), with
// L[n] = 0.
template <Update update>
HOL_NOINLINE void substitute_and_store(const Block &block, const ChainSystem &s, const Packed &out, double *value_out,
                                       vec factor) {
#if HOL_FOURS
    if (out.lane[0]) {
        const AtomSink<update> g = {out};
        pull_down(block.n, s.D, s.t, s.L, [&](long e, auto x) HOL_FORCED { g.put(0, e, x); });
    } else {
        backward(0, block.n, s.t, s.L);
    }
    if (value_out) store_bonds(block, s.t, factor, ~none(), value_out);
#else
    const long full = block.n_min / W * W;
    vec t = {};
    vec3 after = {};  // t d of the bond behind
    if (full < block.n) {
        backward(full, block.n, s.t, s.L);
        t = s.t[full];
        after = t * s.D[full];
    }
    // Bonds full .. n-1 and the atoms behind them.
    const AtomSink<update> sink = {out};
    if (out.lane[0] && full < block.n) store_pulls(block, nullptr, s.D, s.t, ~none(), sink, full + 1, after);
    if (value_out) store_bonds(block, s.t, factor, ~none(), value_out, full);
    for (long k0 = full - W; k0 >= 0; k0 -= W) {
        vec value[3 * W], bond_value[W];
        HOL_UNROLL
        for (long b = W - 1; b >= 0; --b) {
            const long k = k0 + b;
            t = mul_add(s.L[k + 1], t, s.t[k]);
            bond_value[b] = mul_add(factor, t, vec{});  // zeros as +0
            const vec3 p = t * s.D[k];
            value[3 * b] = after.x - p.x;
            value[3 * b + 1] = after.y - p.y;
            value[3 * b + 2] = after.z - p.z;
            after = p;
        }
        if (out.lane[0]) {
            if (update == write_ && block.ahead) fetch_ahead(out.lane[0], k0, block.ahead);
            store_chunk(k0 + 1, value, sink);
        }
        if (value_out) store_values<false>(block, k0, bond_value, all_lanes, value_out);
    }
    if (out.lane[0]) store_first(after, all_lanes, sink);
#endif
}

}  // namespace holonomic::HOL_ISA
