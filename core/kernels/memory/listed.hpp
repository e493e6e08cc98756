// Blocks of equally long chains with lists of atoms, in packed arrays: every vector is read where the list says, and
// results are written there, with the same arithmetic as for chains over consecutive atoms. What needs more than the
// plain path is left to the general one, which copies such chains into staging buffers.
#ifndef HOLONOMIC_KERNELS_MEMORY_LISTED_HPP
#define HOLONOMIC_KERNELS_MEMORY_LISTED_HPP

#include "core/kernels/arithmetic/vector3.hpp"
#include "core/kernels/memory/block.hpp"
#include "core/kernels/memory/sink.hpp"

namespace holonomic {
namespace HOL_ISA {

// The lists of the lanes.
struct AtomLists {
    const int64_t *atoms[W];
    explicit AtomLists(const Lane *lane) {
        for (int i = 0; i < W; ++i) atoms[i] = lane[i].atoms;
    }
    // Lists of so many atoms each, one behind the other.
    AtomLists(const int64_t *first, int64_t n_atoms) {
        for (int i = 0; i < W; ++i) atoms[i] = first + i * n_atoms;
    }
};

#if HOL_LANES >= 4 && defined(__AVX2__)
typedef double vec4 __attribute__((vector_size(32)));

// x y z of four atoms, from and to rows of three. They are read in the pieces in which scatter4() writes them, and
// nothing of the next atom is touched: a load that overlaps with a store just made would have to wait for it.
HOL_INLINE void gather4(const double *base, const int64_t *const *atoms, long k, vec4 &x, vec4 &y, vec4 &z) {
    const double *p[4];
    HOL_UNROLL
    for (int i = 0; i < 4; ++i) p[i] = base + 3 * atoms[i][k];
    const vec4 even = _mm256_insertf128_pd(_mm256_castpd128_pd256(_mm_loadu_pd(p[0])), _mm_loadu_pd(p[2]), 1);
    const vec4 odd = _mm256_insertf128_pd(_mm256_castpd128_pd256(_mm_loadu_pd(p[1])), _mm_loadu_pd(p[3]), 1);
    x = _mm256_unpacklo_pd(even, odd);
    y = _mm256_unpackhi_pd(even, odd);
    z = vec4{p[0][2], p[1][2], p[2][2], p[3][2]};
}

HOL_INLINE void scatter4(double *base, const int64_t *const *atoms, long k, vec4 x, vec4 y, vec4 z) {
    const vec4 even = _mm256_unpacklo_pd(x, y), odd = _mm256_unpackhi_pd(x, y);
    HOL_UNROLL
    for (int i = 0; i < 4; ++i) {
        double *const p = base + 3 * atoms[i][k];
        const vec4 pair = i % 2 ? odd : even;
        _mm_storeu_pd(p, i < 2 ? _mm256_castpd256_pd128(pair) : _mm256_extractf128_pd(pair, 1));
        p[2] = z[i];
    }
}
#endif

HOL_INLINE vec3 gather(const double *base, const AtomLists &at, long k) {
    vec3 a;
#if HOL_LANES == 4 && defined(__AVX2__)
    gather4(base, at.atoms, k, a.x, a.y, a.z);
#elif HOL_LANES == 8 && defined(__AVX512F__)
    vec4 x[2], y[2], z[2];
    for (int h = 0; h < 2; ++h) gather4(base, at.atoms + 4 * h, k, x[h], y[h], z[h]);
    a.x = _mm512_insertf64x4(_mm512_castpd256_pd512(x[0]), x[1], 1);
    a.y = _mm512_insertf64x4(_mm512_castpd256_pd512(y[0]), y[1], 1);
    a.z = _mm512_insertf64x4(_mm512_castpd256_pd512(z[0]), z[1], 1);
#else
    for (int i = 0; i < W; ++i) {
        const double *const p = base + 3 * at.atoms[i][k];
        a.x[i] = p[0];
        a.y[i] = p[1];
        a.z[i] = p[2];
    }
#endif
    return a;
}

template <Update update>
HOL_INLINE void scatter(double *base, const AtomLists &at, long k, vec3 a) {
    if (update == add_) {
        const vec3 b = gather(base, at, k);
        a = {b.x + a.x, b.y + a.y, b.z + a.z};
    }
#if HOL_LANES == 4 && defined(__AVX2__)
    scatter4(base, at.atoms, k, a.x, a.y, a.z);
#elif HOL_LANES == 8 && defined(__AVX512F__)
    scatter4(base, at.atoms, k, _mm512_castpd512_pd256(a.x), _mm512_castpd512_pd256(a.y), _mm512_castpd512_pd256(a.z));
    scatter4(base, at.atoms + 4, k, _mm512_extractf64x4_pd(a.x, 1), _mm512_extractf64x4_pd(a.y, 1),
             _mm512_extractf64x4_pd(a.z, 1));
#else
    for (int i = 0; i < W; ++i) {
        double *const p = base + 3 * at.atoms[i][k];
        p[0] = a.x[i];
        p[1] = a.y[i];
        p[2] = a.z[i];
    }
#endif
}

HOL_INLINE double *base_of(const AtomArray &array) { return reinterpret_cast<double *>(array.x); }

// Lists in packed arrays, in all lanes of a full block?
HOL_INLINE bool listed(const Block &block, const Lane *lane) {
    if (block.lanes < W || block.n != block.n_min) return false;
    for (int i = 0; i < W; ++i)
        if (!lane[i].atoms) return false;
    return true;
}

}  // namespace HOL_ISA
}  // namespace holonomic
#endif
