// Turns W vectors of W elements, or four of four, into their transpose.
#ifndef HOLONOMIC_KERNELS_ISA_TRANSPOSE_HPP
#define HOLONOMIC_KERNELS_ISA_TRANSPOSE_HPP

#include "core/kernels/isa/vector.hpp"

namespace holonomic::HOL_ISA {

#if HOL_LANES >= 4 && defined(__AVX2__)
typedef double quad __attribute__((vector_size(32)));  // four lanes: all of vec, or a part of it

HOL_INLINE void transpose(quad *m) {
    const quad a = _mm256_unpacklo_pd(m[0], m[1]), b = _mm256_unpackhi_pd(m[0], m[1]);
    const quad c = _mm256_unpacklo_pd(m[2], m[3]), d = _mm256_unpackhi_pd(m[2], m[3]);
    m[0] = _mm256_permute2f128_pd(a, c, 0x20);
    m[1] = _mm256_permute2f128_pd(b, d, 0x20);
    m[2] = _mm256_permute2f128_pd(a, c, 0x31);
    m[3] = _mm256_permute2f128_pd(b, d, 0x31);
}
#endif
#if HOL_LANES == 8 && defined(__AVX512F__)
HOL_INLINE void transpose(vec *m) {
    vec a[8], b[8];
    for (int i = 0; i < 8; i += 2) {
        a[i] = _mm512_unpacklo_pd(m[i], m[i + 1]);
        a[i + 1] = _mm512_unpackhi_pd(m[i], m[i + 1]);
    }
    for (int i = 0; i < 8; i += 4)
        for (int j = 0; j < 2; ++j) {
            b[i + j] = _mm512_shuffle_f64x2(a[i + j], a[i + j + 2], 0x88);      // 128-bit parts 0, 2 of both
            b[i + j + 2] = _mm512_shuffle_f64x2(a[i + j], a[i + j + 2], 0xdd);  // parts 1, 3 of both
        }
    for (int j = 0; j < 4; ++j) {
        m[j] = _mm512_shuffle_f64x2(b[j], b[j + 4], 0x88);
        m[j + 4] = _mm512_shuffle_f64x2(b[j], b[j + 4], 0xdd);
    }
}
#elif HOL_LANES != 4 || !defined(__AVX2__)
HOL_INLINE void transpose(vec *m) {
    for (int i = 0; i < W; ++i)
        for (int j = i + 1; j < W; ++j) {
            const double t = m[i][j];
            m[i][j] = m[j][i];
            m[j][i] = t;
        }
}
#endif

}  // namespace holonomic::HOL_ISA
#endif
