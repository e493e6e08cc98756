// Lanes: W doubles that are worked on at once, with one chain, or one piece of a chain, in each.
#ifndef HOLONOMIC_KERNELS_ISA_LANES_HPP
#define HOLONOMIC_KERNELS_ISA_LANES_HPP

#include "core/kernels/isa/transpose.hpp"
#include "core/kernels/isa/vector.hpp"

// Four lanes by AVX2 and FMA, eight by AVX-512: the same instructions of other widths.
#if HOL_LANES == 8 && defined(__AVX512F__)
#define HOL_INTRINSIC(name) _mm512_##name
#elif HOL_LANES == 4 && defined(__AVX2__) && defined(__FMA__)
#define HOL_INTRINSIC(name) _mm256_##name
#endif

namespace holonomic::HOL_ISA {

#ifdef HOL_INTRINSIC
HOL_INLINE vec mul_add(vec a, vec b, vec c) { return HOL_INTRINSIC(fmadd_pd)(a, b, c); }
HOL_INLINE vec mul_sub(vec a, vec b, vec c) { return HOL_INTRINSIC(fmsub_pd)(a, b, c); }
HOL_INLINE vec max(vec a, vec b) { return HOL_INTRINSIC(max_pd)(a, b); }
HOL_INLINE vec min(vec a, vec b) { return HOL_INTRINSIC(min_pd)(a, b); }
HOL_INLINE vec sqrt(vec a) { return HOL_INTRINSIC(sqrt_pd)(a); }
#if HOL_LANES == 8
HOL_INLINE vec round(vec a) { return _mm512_roundscale_pd(a, _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC); }
HOL_INLINE unsigned bits(mask m) { return static_cast<unsigned>(_mm512_movepi64_mask(reinterpret_cast<__m512i>(m))); }
#else
HOL_INLINE vec round(vec a) { return _mm256_round_pd(a, _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC); }
HOL_INLINE unsigned bits(mask m) { return static_cast<unsigned>(_mm256_movemask_pd(as_vec(m))); }
#endif
#else
// Any number of lanes on any processor: what the compiler makes of the vectors.

// One rounding or two, as for a double: results of a set must not depend on where a bond is worked on.
HOL_INLINE vec mul_add(vec a, vec b, vec c) {
#if defined(__aarch64__) && HOL_LANES == 2
    return vfmaq_f64(c, a, b);
#elif HOL_LANES % 4 == 0 && defined(__AVX2__) && HOL_HAS_FMA  // in pieces: element by element takes minutes to compile
    vec r{};
    for (int i = 0; i < W / 4; ++i)
        reinterpret_cast<__m256d *>(&r)[i] =
            _mm256_fmadd_pd(reinterpret_cast<const __m256d *>(&a)[i], reinterpret_cast<const __m256d *>(&b)[i],
                            reinterpret_cast<const __m256d *>(&c)[i]);
    return r;
#elif HOL_HAS_FMA
    vec r{};
    HOL_UNROLL
    for (int i = 0; i < W; ++i) r[i] = __builtin_fma(a[i], b[i], c[i]);
    return r;
#else
    return a * b + c;
#endif
}
HOL_INLINE vec mul_sub(vec a, vec b, vec c) { return mul_add(a, b, -c); }
#if HOL_LANES > 1
HOL_INLINE vec max(vec a, vec b) { return select(less(b, a), a, b); }
HOL_INLINE vec min(vec a, vec b) { return select(less(a, b), a, b); }
HOL_INLINE vec sqrt(vec a) {
    vec s = {};
    for (int i = 0; i < W; ++i) s[i] = __builtin_sqrt(a[i]);
    return s;
}
#endif
#if HOL_LANES == 1 && defined(__SSE4_1__)
HOL_INLINE vec round(vec a) {
    const __m128d x = _mm_set_sd(a[0]);
    return {_mm_cvtsd_f64(_mm_round_sd(x, x, _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC))};
}
#else
HOL_INLINE vec round(vec a) {  // as of a double
    const vec big = splat(6755399441055744.0);
    const vec sum = a + big;
    return sum - big;
}
#endif
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
HOL_INLINE mask finite(vec a) { return equal(a - a, vec{}); }
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

constexpr unsigned all_lanes = (1u << W) - 1;  // bits() of a mask with all lanes set

}  // namespace holonomic::HOL_ISA
#endif
