// What is written of a block of W chains (outputs.hpp), compiled once: multipliers, W bonds of W chains turned at a
// time; the constraint forces t_k d_k - t_{k-1} d_{k-1} on the atoms; the virial.
#include "core/kernels/memory/outputs.hpp"

namespace holonomic::HOL_ISA {

void store_bonds(const Block &block, const vec *value, vec factor, mask which, double *out, long first) {
    const unsigned chosen = bits(which & block.in_use());
    vec m[W];
    long k0 = first;
    double *to[W];
    for (int i = 0; i < W; ++i) to[i] = out + block.first_bond[i < block.lanes ? i : 0];
    const auto whole_chunk = [&](long k) HOL_FORCED {
        HOL_UNROLL
        for (int b = 0; b < W; ++b) m[b] = mul_add(factor, value[k + b], vec{});
        transpose(m);
        HOL_UNROLL
        for (int i = 0; i < W; ++i) store(to[i] + k, m[i]);
    };
    for (const long full = chosen == all_lanes ? block.n_min - W : -1; k0 <= full; k0 += W) whole_chunk(k0);
    // Lanes that end together: the last ones with some of those before, once more.
    if (k0 < block.n && chosen == all_lanes && block.n_min == block.n && block.n - W >= first)
        return whole_chunk(block.n - W);
    for (; k0 < block.n; k0 += W) {
        for (int b = 0; b < W; ++b) m[b] = k0 + b < block.n ? mul_add(factor, value[k0 + b], vec{}) : vec{};
        store_values<true>(block, k0, m, chosen, out);
    }
}

void store_pulls(const Block &block, const vec3 *d, const vec *t, mask which, Update update, const Packed &out) {
    if (update == add_)
        store_pulls(block, nullptr, d, t, which, AtomSink<add_>{out});
    else
        store_pulls(block, nullptr, d, t, which, AtomSink<write_>{out});
}

void add_virial(long n, const vec3 *d, const vec *t, mask which, vec factor, Tally &tally) {
    VirialSum sum;
    for (long k = 0; k < n; ++k) sum.add(d[k], t[k] * d[k]);
    sum.count(which, factor, tally);
}

}  // namespace holonomic::HOL_ISA
