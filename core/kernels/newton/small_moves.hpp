// The moves of the atoms of W molecules of N bonds, from their multipliers to the caller's arrays.
#ifndef HOLONOMIC_KERNELS_NEWTON_SMALL_MOVES_HPP
#define HOLONOMIC_KERNELS_NEWTON_SMALL_MOVES_HPP

#include "core/kernels/memory/fixed.hpp"
#include "core/kernels/newton/system.hpp"

namespace holonomic {
namespace HOL_ISA {

// The moves of the atoms.
template <int N, bool uniform>
HOL_INLINE void find_moves(const Newton &x, vec *value) {
    vec3 before = {};
    HOL_UNROLL
    for (int k = 0; k <= N; ++k) {
        const vec3 after = times(x.tau[k], x.b[k]), m = times_w<uniform>(x, k, minus(after, before));
        value[3 * k] = m.x;
        value[3 * k + 1] = m.y;
        value[3 * k + 2] = m.z;
        before = after;
    }
}

// As store_pulls() with a MoveSink: of W molecules, all of them.
template <int N, bool uniform>
HOL_INLINE void move_molecules(const Newton &x, double *r, double *v, double per_dt) {
    constexpr int elements = 3 * (N + 1), full = elements / W, rest = elements % W;
    vec value[(full + 1) * W] = {};
    find_moves<N, uniform>(x, value);
    for (int j = 0; j < full; ++j) transpose(value + j * W);
    for (int i = 0; i < W; ++i)
        for (int j = 0; j < full; ++j) {
            double *const p = r + elements * i + j * W;
            store(p, load(p) + value[j * W + i]);
        }
    for (int i = 0; v && i < W; ++i)
        for (int j = 0; j < full; ++j) {
            double *const p = v + elements * i + j * W;
            store(p, mul_add(value[j * W + i], splat(per_dt), load(p)));
        }
    if (rest == 0) return;
    typedef double pair __attribute__((vector_size(16)));
    typedef double pair_unaligned __attribute__((vector_size(16), aligned(8), may_alias));
    vec *const last = value + full * W;
    transpose(last);
    for (int i = 0; i < W; ++i)
        for (int e = 0; e < rest; e += 2) {
            const int at = elements * i + full * W + e;
            if (e + 1 == rest) {
                r[at] = r[at] + last[i][e];
                if (v) v[at] = mul_add(last[i][e], per_dt, v[at]);
                continue;
            }
            pair_unaligned &p = *reinterpret_cast<pair_unaligned *>(r + at);
            const pair move = {last[i][e], last[i][e + 1]};
            p = p + move;
            if (!v) continue;
            pair_unaligned &q = *reinterpret_cast<pair_unaligned *>(v + at);
#if HOL_HAS_FMA && defined(__x86_64__)
            q = _mm_fmadd_pd(move, pair{per_dt, per_dt}, q);
#else
            q = pair{mul_add(move[0], per_dt, q[0]), mul_add(move[1], per_dt, q[1])};
#endif
        }
}

// The same of molecules with lists of atoms, which are `atoms` now.
template <int N, bool uniform, class Place>
HOL_INLINE void move_listed_molecules(const Newton &x, const Place &place, const vec *atoms, double *r, double *v,
                                      double per_dt) {
    vec move[3 * (N + 1)], moved[3 * (N + 1)], velocities[vectors_of<N>];
    find_moves<N, uniform>(x, move);
    HOL_UNROLL
    for (int e = 0; e < 3 * (N + 1); ++e) moved[e] = atoms[e] + move[e];
    place.template store<write_>(moved, r);
    if (!v) return;
    place.load(v, velocities);
    HOL_UNROLL
    for (int e = 0; e < 3 * (N + 1); ++e) velocities[e] = mul_add(move[e], splat(per_dt), velocities[e]);
    place.template store<write_>(velocities, v);
}

}  // namespace HOL_ISA
}  // namespace holonomic
#endif
