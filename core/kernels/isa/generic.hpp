// Any number of lanes on any processor: what the compiler makes of the vectors.
#ifndef HOLONOMIC_KERNELS_ISA_GENERIC_HPP
#define HOLONOMIC_KERNELS_ISA_GENERIC_HPP

#include "core/kernels/isa/avx.hpp"

#ifndef HOL_INTRINSIC
namespace holonomic::HOL_ISA {

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
    vec s;
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

}  // namespace holonomic::HOL_ISA
#endif
#endif
