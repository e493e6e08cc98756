// Lanes: W doubles worked on at once, one chain (or one segment of a chain) in each.
//
// Included once per instruction set with HOL_ISA (a namespace) and HOL_LANES (W) defined, so that no function compiled
// for a newer processor can be linked into code that runs on an older one. No standard headers with templates here.
#ifndef HOLONOMIC_KERNELS_LANES_HPP
#define HOLONOMIC_KERNELS_LANES_HPP

#if !defined(HOL_ISA) || !defined(HOL_LANES)
#error "define HOL_ISA and HOL_LANES first"
#endif

#if defined(__x86_64__) || defined(__i386__)
#pragma GCC diagnostic push  // some versions of this header use _mm512_undefined_pd() in a way that gcc warns about
#pragma GCC diagnostic ignored "-Wuninitialized"
#ifndef __clang__
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif
#include <immintrin.h>
#pragma GCC diagnostic pop
#elif defined(__aarch64__)
#include <arm_neon.h>
#endif

#if defined(__FMA__) || defined(__aarch64__)
#define HOL_HAS_FMA 1
#else
#define HOL_HAS_FMA 0
#endif

namespace holonomic {
namespace HOL_ISA {

constexpr int W = HOL_LANES;

typedef double vec __attribute__((vector_size(HOL_LANES * 8)));
typedef long long mask __attribute__((vector_size(HOL_LANES * 8)));  // all bits of a lane set, or none
typedef double vec_unaligned __attribute__((vector_size(HOL_LANES * 8), aligned(8), may_alias));

#define HOL_INLINE static inline __attribute__((always_inline))

// Before a loop of few turns over vectors: left rolled, it would keep them in memory.
#if defined(__clang__)
#define HOL_UNROLL _Pragma("clang loop unroll(full)")
#else
#define HOL_UNROLL _Pragma("GCC unroll 16")
#endif

HOL_INLINE vec load(const double *p) { return *reinterpret_cast<const vec_unaligned *>(p); }
HOL_INLINE void store(double *p, vec a) { *reinterpret_cast<vec_unaligned *>(p) = a; }
HOL_INLINE vec splat(double a) { return a - vec{}; }
HOL_INLINE mask as_mask(vec a) { return reinterpret_cast<mask>(a); }
HOL_INLINE vec as_vec(mask a) { return reinterpret_cast<vec>(a); }
HOL_INLINE vec select(mask m, vec a, vec b) { return as_vec((m & as_mask(a)) | (~m & as_mask(b))); }
HOL_INLINE vec keep(mask m, vec a) { return as_vec(m & as_mask(a)); }  // a where m, else zero
HOL_INLINE vec abs(vec a) { return as_vec(as_mask(a) & (mask{} + 0x7fffffffffffffffLL)); }
HOL_INLINE double round(double a) {  // as for vec below
    const double big = 6755399441055744.0, sum = a + big;
    return sum - big;
}
HOL_INLINE double abs(double a) { return __builtin_fabs(a); }

// a * b + c: in one rounding where the instruction set has it, in two elsewhere.
HOL_INLINE double mul_add(double a, double b, double c) {
#if HOL_HAS_FMA
    return __builtin_fma(a, b, c);
#else
    return a * b + c;
#endif
}

#if HOL_LANES == 8 && defined(__AVX512F__)
HOL_INLINE vec mul_add(vec a, vec b, vec c) { return _mm512_fmadd_pd(a, b, c); }
HOL_INLINE vec mul_sub(vec a, vec b, vec c) { return _mm512_fmsub_pd(a, b, c); }
HOL_INLINE vec max(vec a, vec b) { return _mm512_max_pd(a, b); }
HOL_INLINE vec min(vec a, vec b) { return _mm512_min_pd(a, b); }
HOL_INLINE vec sqrt(vec a) { return _mm512_sqrt_pd(a); }
HOL_INLINE vec round(vec a) { return _mm512_roundscale_pd(a, _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC); }
HOL_INLINE unsigned bits(mask m) {
    return static_cast<unsigned>(_mm512_movepi64_mask(reinterpret_cast<__m512i>(m)));
}
#elif HOL_LANES == 4 && defined(__AVX2__)
HOL_INLINE vec mul_add(vec a, vec b, vec c) { return _mm256_fmadd_pd(a, b, c); }
HOL_INLINE vec mul_sub(vec a, vec b, vec c) { return _mm256_fmsub_pd(a, b, c); }
HOL_INLINE vec max(vec a, vec b) { return _mm256_max_pd(a, b); }
HOL_INLINE vec min(vec a, vec b) { return _mm256_min_pd(a, b); }
HOL_INLINE vec sqrt(vec a) { return _mm256_sqrt_pd(a); }
HOL_INLINE vec round(vec a) { return _mm256_round_pd(a, _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC); }
HOL_INLINE unsigned bits(mask m) { return static_cast<unsigned>(_mm256_movemask_pd(as_vec(m))); }
#else
HOL_INLINE vec mul_add(vec a, vec b, vec c) {
#if defined(__aarch64__) && HOL_LANES == 2
    return vfmaq_f64(c, a, b);
#else
    return a * b + c;
#endif
}
HOL_INLINE vec mul_sub(vec a, vec b, vec c) { return mul_add(a, b, -c); }
HOL_INLINE vec max(vec a, vec b) { return select(reinterpret_cast<mask>(a > b), a, b); }
HOL_INLINE vec min(vec a, vec b) { return select(reinterpret_cast<mask>(a < b), a, b); }
HOL_INLINE vec sqrt(vec a) {
    vec s;
    for (int i = 0; i < W; ++i) s[i] = __builtin_sqrt(a[i]);
    return s;
}
// To the nearest integer by adding and subtracting 1.5 * 2^52: right for |a| < 2^51, which is all that a box needs.
HOL_INLINE vec round(vec a) {
    const vec big = splat(6755399441055744.0);
    const vec sum = a + big;
    return sum - big;
}
#if HOL_LANES == 2 && defined(__SSE2__)
HOL_INLINE unsigned bits(mask m) { return static_cast<unsigned>(_mm_movemask_pd(as_vec(m))); }
#else
HOL_INLINE unsigned bits(mask m) {
    unsigned b = 0;
    for (int i = 0; i < W; ++i) b |= (m[i] < 0 ? 1u : 0u) << i;
    return b;
}
#endif
#endif

// The sign bits of a mask tell.
HOL_INLINE bool any(mask m) { return bits(m) != 0; }
HOL_INLINE mask less(vec a, vec b) { return reinterpret_cast<mask>(a < b); }
HOL_INLINE mask less_equal(vec a, vec b) { return reinterpret_cast<mask>(a <= b); }
HOL_INLINE mask finite(vec a) { return reinterpret_cast<mask>(a - a == vec{}); }
HOL_INLINE mask none() { return mask{}; }
HOL_INLINE mask first_lanes(int n) {
    mask m{};
    for (int i = 0; i < W; ++i) m[i] = i < n ? -1 : 0;
    return m;
}
HOL_INLINE double sum_lanes(vec a) {  // in the order of the lanes
    double s = a[0];
    for (int i = 1; i < W; ++i) s += a[i];
    return s;
}

// Turns W vectors of W elements into their transpose.
#if HOL_LANES == 4 && defined(__AVX2__)
HOL_INLINE void transpose(vec *m) {
    const vec a = _mm256_unpacklo_pd(m[0], m[1]), b = _mm256_unpackhi_pd(m[0], m[1]);
    const vec c = _mm256_unpacklo_pd(m[2], m[3]), d = _mm256_unpackhi_pd(m[2], m[3]);
    m[0] = _mm256_permute2f128_pd(a, c, 0x20);
    m[1] = _mm256_permute2f128_pd(b, d, 0x20);
    m[2] = _mm256_permute2f128_pd(a, c, 0x31);
    m[3] = _mm256_permute2f128_pd(b, d, 0x31);
}
#elif HOL_LANES == 8 && defined(__AVX512F__)
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
#else
HOL_INLINE void transpose(vec *m) {
    for (int i = 0; i < W; ++i)
        for (int j = i + 1; j < W; ++j) {
            const double t = m[i][j];
            m[i][j] = m[j][i];
            m[j][i] = t;
        }
}
#endif

}  // namespace HOL_ISA
}  // namespace holonomic
#endif
