// Inverse masses of a block.
#ifndef HOLONOMIC_KERNELS_MEMORY_MASSES_HPP
#define HOLONOMIC_KERNELS_MEMORY_MASSES_HPP

#include "core/kernels/memory/arena.hpp"
#include "core/kernels/memory/block.hpp"
#include "core/kernels/memory/rows.hpp"

namespace holonomic::HOL_ISA {

// Inverse masses of the lanes: constant along each, or tables in scratch.
static inline void set_masses(Block &block, const Lane *lane, Arena &arena) {
    const double *table[W];
    double constant[W];  // where there is no table
    block.uniform_w = true;
    for (int i = 0; i < W; ++i) {
        const Lane &of = lane[i < block.lanes ? i : 0];
        const bool has_unit = !of.w && of.w_uniform > 0;  // not in a chain of nothing but fixed atoms
        table[i] = of.w;
        constant[i] = has_unit ? 1.0 : of.w_uniform;
        block.movable[i] = has_unit || of.w ? -1 : 0;
        block.unit[i] = has_unit ? of.w_uniform : 1.0;
        block.uniform_w = block.uniform_w && has_unit;
    }
    block.mass = splat(1.0) / block.unit;
    block.unit_masses = block.uniform_w && !any(~equal(block.mass, splat(1.0)));
    if (block.uniform_w) return;
    vec *w = arena.vecs(block.n + 1);
    bool same = true;
    for (int i = 1; i < W; ++i)
        same = same && table[i] == table[0] && constant[i] == constant[0] && block.len[i] == block.len[0];
    const auto value = [&](int i, long k) HOL_FORCED {  // inert bonds past the end: any positive mass
        return k > block.len[i] ? 1.0 : (table[i] ? table[i][k] : constant[i]);
    };
    interleave(table, block.len, 1, block.n + 1, w, value);
    for (int i = 0; i < W; ++i) {
        if (i > 0 && same) {
            block.w3[i] = block.w3[0];
            continue;
        }
        double *const w3 = arena.doubles(3 * (block.n + 1 + W));
        long k = 0;
        for (; table[i] && k + W <= block.len[i] + 1; k += W) {
            const vec x = load(table[i] + k);
            HOL_UNROLL
            for (int j = 0; j < 3; ++j) {
                vec three;
                HOL_UNROLL
                for (int e = 0; e < W; ++e) three[e] = x[(j * W + e) / 3];
                store(w3 + 3 * k + j * W, three);
            }
        }
        for (; k < block.n + 1 + W; ++k) w3[3 * k] = w3[3 * k + 1] = w3[3 * k + 2] = value(i, k);
        block.w3[i] = w3;
    }
    block.w = w;
}

}  // namespace holonomic::HOL_ISA
#endif
