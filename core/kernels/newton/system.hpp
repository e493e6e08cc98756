// Newton's method for the positions of a block of chains (theory (15)-(19)): its sweeps. With b the bond vectors of the
// reference positions and D the new ones, the corrections w_i (tau_{i+1} b_{i+1} - tau_i b_i) of the atoms must bring
// every D.D to a^2. Newton's Jacobian is tridiagonal and its elimination the one of the forces, with
//     q_k = D_k . b_k,   X_{k+1} = (D_k x D_{k+1}) . (b_k x b_{k+1}) = q_k q_{k+1} - (D_{k+1} . b_k) (D_k . b_{k+1}).
// The bonds are moved from D, in scratch, by all corrections so far. A step is one sweep up the chain and one down. The
// sweep up moves the bonds, finds D.D - a^2 and substitutes forward. The coordinates are rounded once, at the end.
// Lanes that are done take no more corrections while the others go on.
#pragma once

#include "core/kernels/arithmetic/vector3.hpp"
#include "core/kernels/memory/arena.hpp"
#include "core/kernels/memory/block.hpp"

namespace holonomic::HOL_ISA {

// A bond's row: the factor of the row before on the way up, 1 / (2 P), the factor of the row behind on the way down,
// and y / (2 P).
struct ChainRow {
    vec down, half_rP, up, u;
};

// The lengths a of the bonds. Relative errors are products with 1 / a^2, so that equal and unequal lengths round alike.
struct BondLengths {
    const vec *a2, *per_a2;  // nullptr: the same for all bonds of a lane
    vec a2_uniform, per_a2_uniform, a_min, a_max, per_a_min;
};

// `tables`: gives tables even if all lengths are the same.
BondLengths bond_lengths(const Block &, const Lane *, Arena &, bool tables = false);

struct Newton : BondLengths {
    vec3 *b, *D;  // [n+W]: behind the last bond is one whose multiplier is 0
    ChainRow *row;
    vec *tau;                    // [n+1], times `unit`
    vec *correction;             // [n+1], the last one
    vec *step;                   // what D has not been moved by yet: tau, or the last correction
    const vec *w = nullptr;      // [n+1] inverse masses, those of the block; nullptr: all are 1
    vec lengths;                 // numbers of bonds
    const double *next[3] = {};  // where the block's atoms begin, for those of the next one to be fetched early
    Newton(long n, Arena &arena)
        : b(reinterpret_cast<vec3 *>(arena.vecs(3 * (n + W)))), D(reinterpret_cast<vec3 *>(arena.vecs(3 * (n + W)))),
          row(reinterpret_cast<ChainRow *>(arena.vecs(4 * n))), tau(arena.vecs(n + 1)), correction(arena.vecs(n + 1)),
          step(tau) {
        b[n] = vec3{};
        tau[n] = correction[n] = vec{};
    }
    Newton(const Block &block, const BondLengths &a, Arena &arena) : Newton(block.n, arena) {
        static_cast<BondLengths &>(*this) = a;
        lengths = block.lengths();
        w = block.uniform_w ? nullptr : block.w;
    }
};

// Whether masses, or lengths, are all the same: as the compiler knows, or as is found at each bond, where little is
// done.
enum Same { differ, same, either };
constexpr Same same_if(bool all) { return all ? same : differ; }

template <Same masses>
HOL_INLINE vec times_w(const Newton &x, long k, vec a) {
    return masses == same || (masses == either && !x.w) ? a : x.w[k] * a;
}

template <Same masses>
HOL_INLINE vec3 times_w(const Newton &x, long k, const vec3 &a) {
    return {times_w<masses>(x, k, a.x), times_w<masses>(x, k, a.y), times_w<masses>(x, k, a.z)};
}

// Whether a lane has a bond k.
HOL_INLINE mask live(const Newton &x, long k) { return less(splat(static_cast<double>(k)), x.lengths); }

}  // namespace holonomic::HOL_ISA
