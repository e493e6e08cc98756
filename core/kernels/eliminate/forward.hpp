// The forward sweep of a block, from the caller's arrays to u: loading and eliminating in one go.
#ifndef HOLONOMIC_KERNELS_ELIMINATE_FORWARD_HPP
#define HOLONOMIC_KERNELS_ELIMINATE_FORWARD_HPP

#include "core/kernels/eliminate/chain.hpp"
#include "core/kernels/memory/packed.hpp"

namespace holonomic::HOL_ISA {

// Loads the bonds of a block and eliminates: t becomes u. Returns the lanes that plain arithmetic can answer for, and
// in `calm` those in which nothing can overflow from here on.
template <int terms, bool uniform, bool boxed>
HOL_NOINLINE mask forward(const Block &block, const Box &box, const Packed &r, const Packed &v, const Packed &f,
                          const System &s, mask &calm) {
    const Places at(r, v, f);
    const Source source = {&r, nullptr, nullptr, &box, nullptr};
    Sweep<uniform, false> sweep{block, source, s};
    long k0 = 0;
    for (; k0 + group <= block.n_min; k0 += group) {
        vec b[group];
        HOL_UNROLL
        for (long k = 0; k < group; k += W)
            load_full_chunk<terms, uniform, boxed, false>(block, box, at, k0 + k, s.D + k0 + k, nullptr, b + k);
        HOL_UNROLL
        for (long k = 0; k < group; ++k) sweep.step(k0 + k, b[k], k % 4 == 0, false);
    }
    const long ragged_from = k0;
    for (; k0 < block.n; k0 += W)
        load_ragged<terms, uniform, boxed, false>(block, box, r, v, f, k0, s.D + k0, nullptr, s.t + k0);
    for (long k = ragged_from; k < block.n; ++k) sweep.step(k, s.t[k], k % 4 == 0, k >= block.n_min);
    calm = sweep.calm();
    return ~sweep.doubt();
}

// The same with compensated products of unrounded bond vectors: good in all lanes.
template <int terms, bool uniform, bool boxed>
HOL_NOINLINE mask forward_careful(const Block &block, const Box &box, const Packed &r, const Packed &v, const Packed &f,
                                  const System &s, mask &calm) {
    load_bonds<terms, uniform, boxed, true>(block, box, r, v, f, s.D, s.D_low, s.t);
    forward_careful<uniform>(block, s);
    calm = none();
    return ~none();
}

template <int terms, bool careful>
static inline mask forward_any(const Block &block, const Box &box, const Packed &r, const Packed &v, const Packed &f,
                               const System &s, mask &calm) {
    const bool boxed = box.shape != Box::none;
    if (!careful && (terms & velocity_squared) && block.unit_masses && !boxed)
        return forward<terms | unit_mass, true, false>(block, box, r, v, f, s, calm);
    return choose(
        [&](auto uniform, auto has_box) {
            return careful ? forward_careful<terms, uniform, has_box>(block, box, r, v, f, s, calm)
                           : forward<terms, uniform, has_box>(block, box, r, v, f, s, calm);
        },
        block.uniform_w, boxed);
}

}  // namespace holonomic::HOL_ISA
#endif
