// What the multipliers do: the virial, and the pulls G_i = t_{i+1} d_{i+1} - t_i d_i on the atoms.
#ifndef HOLONOMIC_KERNELS_MEMORY_PULLS_HPP
#define HOLONOMIC_KERNELS_MEMORY_PULLS_HPP

#include "core/kernels/arithmetic/vector3.hpp"
#include "core/kernels/memory/sink.hpp"

namespace holonomic {
namespace HOL_ISA {

// - factor sum t d (x) d over the bonds of the lanes in `which`.
static inline void add_virial(long n, const vec3 *d, const vec *t, mask which, vec factor, Tally &tally) {
    vec s[6] = {};
    for (long k = 0; k < n; ++k) {
        const vec3 p = {t[k] * d[k].x, t[k] * d[k].y, t[k] * d[k].z};
        s[0] = mul_add(p.x, d[k].x, s[0]);
        s[1] = mul_add(p.x, d[k].y, s[1]);
        s[2] = mul_add(p.x, d[k].z, s[2]);
        s[3] = mul_add(p.y, d[k].y, s[3]);
        s[4] = mul_add(p.y, d[k].z, s[4]);
        s[5] = mul_add(p.z, d[k].z, s[5]);
    }
    for (int c = 0; c < 6; ++c) tally.virial[c] -= sum_lanes(keep(which, factor * s[c]));
}

// G_i = t_{i+1} d_{i+1} - t_i d_i of the atoms first .. n, where `before` is t d of the bond before atom `first`; times
// w_i where `weighted`.
template <bool weighted, bool uniform, Update update>
static inline void store_pulls_from(const Block &block, long first, vec3 before, const vec3 *d, const vec *t,
                                    mask which, const Packed &out) {
    const unsigned chosen = bits(which);
    const auto pull = [&](long k, const vec3 &after, vec *value) HOL_FORCED {
        vec3 g = {after.x - before.x, after.y - before.y, after.z - before.z};
        if (weighted) {
            const vec w = w_at<uniform>(block, k);
            g = {w * g.x, w * g.y, w * g.z};
        }
        value[0] = g.x;
        value[1] = g.y;
        value[2] = g.z;
        before = after;
    };
    long k0 = first;
    if (chosen == (1u << W) - 1)
        for (; k0 + W <= block.n_min; k0 += W) {
            vec value[3 * W];
            for (int a = 0; a < W; ++a) {
                const long k = k0 + a;
                pull(k, {t[k] * d[k].x, t[k] * d[k].y, t[k] * d[k].z}, value + 3 * a);
            }
            store_chunk<update>(k0, value, out);
        }
    for (; k0 <= block.n; k0 += W) {
        vec value[3 * W] = {};
        for (int a = 0; a < W; ++a) {
            const long k = k0 + a;
            if (k > block.n) break;
            vec3 after = {};
            if (k < block.n) after = {t[k] * d[k].x, t[k] * d[k].y, t[k] * d[k].z};
            pull(k, after, value + 3 * a);
        }
        store_ragged<update>(block, k0, value, chosen, out);
    }
}

static inline void store_pulls(const Block &block, const vec3 *d, const vec *t, mask which, Update update,
                               const Packed &out) {
    if (update == add_)
        store_pulls_from<false, true, add_>(block, 0, vec3{}, d, t, which, out);
    else
        store_pulls_from<false, true, write_>(block, 0, vec3{}, d, t, which, out);
}

}  // namespace HOL_ISA
}  // namespace holonomic
#endif
