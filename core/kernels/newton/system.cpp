// The lengths of a block of chains in lanes, their squares and inverses, as Newton's method takes them. If each
// chain has one length, no table is made.
#include "core/kernels/newton/system.hpp"

namespace holonomic::HOL_ISA {

BondLengths bond_lengths(const Block &block, const Lane *lane, Arena &arena, bool tables) {
    bool uniform = !tables;
    const double *table[W];
    double first[W];
    for (int i = 0; i < W; ++i) {
        const Lane &one = lane[i < block.lanes ? i : 0];
        uniform = uniform && !one.length;
        table[i] = one.length;
        first[i] = one.length ? one.length[0] : one.length_uniform;
    }
    BondLengths x = {};
    x.a_min = x.a_max = load(first);
    if (!uniform) {
        vec *const a2 = arena.vecs(block.n), *const per_a2 = arena.vecs(block.n);
        interleave(table, block.len, 0, block.n, a2,
                   [&](int i, long k) HOL_FORCED { return table[i] && k < block.len[i] ? table[i][k] : first[i]; });
        const vec lengths = block.lengths();
        for (long k = 0; k < block.n; ++k) {
            const vec a = a2[k];
            x.a_min = min(a, x.a_min);
            x.a_max = max(a, x.a_max);
            a2[k] = k < block.n_min ? a * a : select(less(splat(static_cast<double>(k)), lengths), a * a, splat(1.0));
            per_a2[k] = splat(1.0) / a2[k];
        }
        x.a2 = a2;
        x.per_a2 = per_a2;
    }
    x.per_a_min = splat(1.0) / x.a_min;
    x.a2_uniform = x.a_min * x.a_min;
    x.per_a2_uniform = splat(1.0) / x.a2_uniform;
    return x;
}

}  // namespace holonomic::HOL_ISA
