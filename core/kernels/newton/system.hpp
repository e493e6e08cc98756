// Newton's method for the positions of a block of chains (theory (15)-(19)): its sweeps. With b the bond vectors of the
// reference positions and D the new ones, the corrections w_i (tau_{i+1} b_{i+1} - tau_i b_i) of the atoms must bring
// every D.D to a^2. Newton's Jacobian is tridiagonal and its elimination the one of the forces, with
//     q_k = D_k . b_k,   X_{k+1} = (D_k x D_{k+1}) . (b_k x b_{k+1}) = q_k q_{k+1} - (D_{k+1} . b_k) (D_k . b_{k+1}).
// The bonds are moved from D, in scratch, by all corrections so far: each step is one sweep up the chain, which moves
// the bonds, finds what is left of D.D - a^2 and substitutes forward at once, and one sweep down. The coordinates are
// rounded once, at the end. Chains (lanes) that are done take no more corrections while the rest of the block goes on.
#ifndef HOLONOMIC_KERNELS_NEWTON_SYSTEM_HPP
#define HOLONOMIC_KERNELS_NEWTON_SYSTEM_HPP

#include "core/kernels/arithmetic/vector3.hpp"
#include "core/kernels/memory/arena.hpp"
#include "core/kernels/memory/block.hpp"

namespace holonomic {
namespace HOL_ISA {

// The factors of a bond's row: what it gets of the row before on the way up, 1 / (2 P), what it gets of the row behind
// on the way down; and y / (2 P).
struct Row {
    vec down, half_rP, up, u;
};

// The lengths of the bonds, a. Errors relative to a^2 are products with 1 / a^2, whether it differs among bonds or not.
struct BondLengths {
    const vec *a2, *per_a2;  // nullptr: the same for all bonds of a lane
    vec a2_uniform, per_a2_uniform, a_min, a_max, per_a_min;
};

struct Newton : BondLengths {
    vec3 *b, *D;  // [n+1]: behind the last bond is one of length 0, whose multiplier is 0
    Row *row;
    vec *tau;                    // [n+1], times `unit`
    vec *correction;             // [n+1], the last one
    vec *step;                   // what D has not been moved by yet: tau, or the last correction
    const vec *w;                // [n+1] inverse masses, those of the block; not if all are 1
    vec lengths;                 // numbers of bonds
    const double *next[3] = {};  // where the block's atoms begin, for those of the next one to be fetched early
    Newton(long n, Arena &arena)
        : b(reinterpret_cast<vec3 *>(arena.vecs(3 * (n + 1)))), D(reinterpret_cast<vec3 *>(arena.vecs(3 * (n + 1)))),
          row(reinterpret_cast<Row *>(arena.vecs(4 * n))), tau(arena.vecs(n + 1)), correction(arena.vecs(n + 1)),
          step(tau) {
        b[n] = vec3{};
        tau[n] = correction[n] = vec{};
    }
    Newton(const Block &block, const BondLengths &a, Arena &arena) : Newton(block.n, arena) {
        static_cast<BondLengths &>(*this) = a;
        lengths = block.lengths();
        w = block.w;
    }
};

template <bool uniform_w>
HOL_INLINE vec times_w(const Newton &x, long k, vec a) {
    return uniform_w ? a : x.w[k] * a;
}

template <bool uniform_w>
HOL_INLINE vec3 times_w(const Newton &x, long k, const vec3 &a) {
    return {times_w<uniform_w>(x, k, a.x), times_w<uniform_w>(x, k, a.y), times_w<uniform_w>(x, k, a.z)};
}

// Whether a lane has a bond k.
HOL_INLINE mask live(const Newton &x, long k) { return less(splat(static_cast<double>(k)), x.lengths); }

}  // namespace HOL_ISA
}  // namespace holonomic
#endif
