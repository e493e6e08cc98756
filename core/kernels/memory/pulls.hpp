// What comes of the multipliers of a block: values per bond, the pulls G_i = t_{i+1} d_{i+1} - t_i d_i on the atoms,
// and the virial.
#ifndef HOLONOMIC_KERNELS_MEMORY_PULLS_HPP
#define HOLONOMIC_KERNELS_MEMORY_PULLS_HPP

#include "core/kernels/arithmetic/vector3.hpp"
#include "core/kernels/call.hpp"
#include "core/kernels/memory/block.hpp"
#include "core/kernels/memory/sink.hpp"

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

// Of W lanes.
struct VirialSum {
    vec xx = {}, xy = {}, xz = {}, yy = {}, yz = {}, zz = {};

    HOL_FORCED void add(const vec3 &d, const vec3 &p) {  // p = t d
        xx = mul_add(p.x, d.x, xx);
        xy = mul_add(p.x, d.y, xy);
        xz = mul_add(p.x, d.z, xz);
        yy = mul_add(p.y, d.y, yy);
        yz = mul_add(p.y, d.z, yz);
        zz = mul_add(p.z, d.z, zz);
    }
    // Counts factor times that of the lanes in `which`.
    void count(mask which, vec factor, Tally &tally) const {
        const vec sum[6] = {xx, xy, xz, yy, yz, zz};
        for (int c = 0; c < 6; ++c) tally.virial[c] -= sum_lanes(keep(which, factor * sum[c]));
    }
};

static inline void add_virial(long n, const vec3 *d, const vec *t, mask which, vec factor, Tally &tally) {
    VirialSum sum;
    for (long k = 0; k < n; ++k) sum.add(d[k], t[k] * d[k]);
    sum.count(which, factor, tally);
}

}  // namespace holonomic::HOL_ISA
#endif
