// Reads and writes one atom of each lane, a row x y z. Nothing behind z is touched.
#ifndef HOLONOMIC_KERNELS_MEMORY_ATOM_ROWS_HPP
#define HOLONOMIC_KERNELS_MEMORY_ATOM_ROWS_HPP

#include "core/kernels/arithmetic/vector3.hpp"
#include "core/kernels/isa/transpose.hpp"

namespace holonomic::HOL_ISA {

#if HOL_LANES >= 4 && defined(__AVX2__)
// Rows are read in the same pieces as they are written, and never beyond z. A load that overlaps a recent store in any
// other way has to wait for it.
HOL_INLINE void read_rows(const double *const *p, quad &x, quad &y, quad &z) {
    const quad even = _mm256_insertf128_pd(_mm256_castpd128_pd256(_mm_loadu_pd(p[0])), _mm_loadu_pd(p[2]), 1);
    const quad odd = _mm256_insertf128_pd(_mm256_castpd128_pd256(_mm_loadu_pd(p[1])), _mm_loadu_pd(p[3]), 1);
    x = _mm256_unpacklo_pd(even, odd);
    y = _mm256_unpackhi_pd(even, odd);
    z = quad{p[0][2], p[1][2], p[2][2], p[3][2]};
}

HOL_INLINE void write_rows(double *const *p, quad x, quad y, quad z) {
    const quad even = _mm256_unpacklo_pd(x, y), odd = _mm256_unpackhi_pd(x, y);
    HOL_UNROLL
    for (int i = 0; i < 4; ++i) {
        const quad pair = i % 2 ? odd : even;
        _mm_storeu_pd(p[i], i < 2 ? _mm256_castpd256_pd128(pair) : _mm256_extractf128_pd(pair, 1));
        p[i][2] = z[i];
    }
}
#endif

HOL_INLINE void read_rows(const double *const *p, vec3 &a) {
#if HOL_LANES == 4 && defined(__AVX2__)
    read_rows(p, a.x, a.y, a.z);
#elif HOL_LANES == 8 && defined(__AVX512F__)
    quad x[2], y[2], z[2];
    for (int h = 0; h < 2; ++h) read_rows(p + 4 * h, x[h], y[h], z[h]);
    a.x = _mm512_insertf64x4(_mm512_castpd256_pd512(x[0]), x[1], 1);
    a.y = _mm512_insertf64x4(_mm512_castpd256_pd512(y[0]), y[1], 1);
    a.z = _mm512_insertf64x4(_mm512_castpd256_pd512(z[0]), z[1], 1);
#else
    // gcc 12 loses elements that are written to a wide vector without a value.
    a = vec3{};
    for (int i = 0; i < W; ++i) a.x[i] = p[i][0];
    for (int i = 0; i < W; ++i) a.y[i] = p[i][1];
    for (int i = 0; i < W; ++i) a.z[i] = p[i][2];
#endif
}

HOL_INLINE void write_rows(double *const *p, const vec3 &a) {
#if HOL_LANES == 4 && defined(__AVX2__)
    write_rows(p, a.x, a.y, a.z);
#elif HOL_LANES == 8 && defined(__AVX512F__)
    write_rows(p, _mm512_castpd512_pd256(a.x), _mm512_castpd512_pd256(a.y), _mm512_castpd512_pd256(a.z));
    write_rows(p + 4, _mm512_extractf64x4_pd(a.x, 1), _mm512_extractf64x4_pd(a.y, 1), _mm512_extractf64x4_pd(a.z, 1));
#else
    for (int i = 0; i < W; ++i) {
        p[i][0] = a.x[i];
        p[i][1] = a.y[i];
        p[i][2] = a.z[i];
    }
#endif
}

}  // namespace holonomic::HOL_ISA
#endif
