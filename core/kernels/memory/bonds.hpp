// Bond vectors alone, of all lanes of a block.
#ifndef HOLONOMIC_KERNELS_MEMORY_BONDS_HPP
#define HOLONOMIC_KERNELS_MEMORY_BONDS_HPP

#include "core/kernels/arithmetic/image.hpp"
#include "core/kernels/memory/block.hpp"
#include "core/kernels/memory/rows.hpp"

namespace holonomic {
namespace HOL_ISA {

// Bond vectors k0 .. k0 + W - 1, from pointers to atom k0 of each lane.
template <bool boxed>
HOL_INLINE void bonds_between(const Box &box, const double *const *p, vec3 *d) {
    vec m[3 * W];
    for (int j = 0; j < 3; ++j) {
        for (int i = 0; i < W; ++i) m[j * W + i] = load(p[i] + W * j + 3) - load(p[i] + W * j);
        transpose(m + j * W);
    }
    for (int a = 0; a < W; ++a) {
        d[a] = {m[3 * a], m[3 * a + 1], m[3 * a + 2]};
        vec3 unused = {};
        if (boxed) wrap<false>(box, d[a], unused);
    }
}

template <bool boxed>
static inline void load_bond_vectors(const Block &block, const Box &box, const Packed &r, vec3 *D) {
    const vec lengths = block.lengths();
    const double *p[W];
    vec3 d[W];
    long k0 = 0;
    for (; k0 + W <= block.n_min; k0 += W) {
        for (int i = 0; i < W; ++i) p[i] = r.lane[i] + 3 * k0;
        bonds_between<boxed>(box, p, d);
        for (int a = 0; a < W; ++a) D[k0 + a] = d[a];
    }
    for (; k0 < block.n; k0 += W) {
        double buffer[W][3 * W + 3];
        for (int i = 0; i < W; ++i)
            p[i] = i == 0 || i < block.lanes ? window(r.lane[i], k0, block.len[i], block.roomy, buffer[i]) : p[0];
        bonds_between<boxed>(box, p, d);
        for (long a = 0; a < W && k0 + a < block.n; ++a) {  // inert bonds past the end of a lane: (1, 0, 0)
            const mask m = less(splat(static_cast<double>(k0 + a)), lengths);
            D[k0 + a] = {select(m, d[a].x, splat(1.0)), keep(m, d[a].y), keep(m, d[a].z)};
        }
    }
}

static inline void load_bond_vectors(const Block &block, const Box &box, const Packed &r, vec3 *D) {
    if (box.shape == Box::none)
        load_bond_vectors<false>(block, box, r, D);
    else
        load_bond_vectors<true>(block, box, r, D);
}

}  // namespace HOL_ISA
}  // namespace holonomic
#endif
