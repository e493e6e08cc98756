// What the multipliers do to the atoms: the pulls G_i = t_{i+1} d_{i+1} - t_i d_i.
#ifndef HOLONOMIC_KERNELS_MEMORY_PULLS_HPP
#define HOLONOMIC_KERNELS_MEMORY_PULLS_HPP

#include "core/kernels/memory/sink.hpp"

namespace holonomic::HOL_ISA {

// Gives the sink the pulls on the atoms first .. n of the lanes in `which`, times w_i if `weighted`. `before` is t d of
// the bond before atom `first`.
template <bool weighted, bool uniform, class Sink>
static inline void store_pulls(const Block &block, const vec3 *d, const vec *t, mask which, const Sink sink,
                               long first = 0, vec3 before = vec3{}) {
    const unsigned chosen = bits(which & block.in_use());
    const auto pull = [&](long k, const vec3 &after, vec *value) HOL_FORCED {
        vec3 g = after - before;
        if (weighted && !uniform) g = block.w[k] * g;
        value[0] = g.x;
        value[1] = g.y;
        value[2] = g.z;
        before = after;
    };
    long k0 = first;
    if (chosen == all_lanes)
        for (; k0 + W <= block.n_min; k0 += W) {
            vec value[3 * W];
            for (int a = 0; a < W; ++a) pull(k0 + a, t[k0 + a] * d[k0 + a], value + 3 * a);
            store_chunk(k0, value, sink);
        }
    for (; k0 <= block.n; k0 += W) {
        vec value[3 * W] = {};
        for (int a = 0; a < W && k0 + a <= block.n; ++a)
            pull(k0 + a, k0 + a < block.n ? t[k0 + a] * d[k0 + a] : vec3{}, value + 3 * a);
        store_ragged(block, k0, value, chosen, sink);
    }
}

static inline void store_pulls(const Block &block, const vec3 *d, const vec *t, mask which, Update update,
                               const Packed &out) {
    if (update == add_)
        store_pulls<false, true>(block, d, t, which, AtomSink<add_>{out});
    else
        store_pulls<false, true>(block, d, t, which, AtomSink<write_>{out});
}

}  // namespace holonomic::HOL_ISA
#endif
