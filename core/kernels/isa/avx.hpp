// Four lanes by AVX2 and FMA, eight by AVX-512: the same instructions of other widths.
#ifndef HOLONOMIC_KERNELS_ISA_AVX_HPP
#define HOLONOMIC_KERNELS_ISA_AVX_HPP

#include "core/kernels/isa/vector.hpp"

#if HOL_LANES == 8 && defined(__AVX512F__)
#define HOL_INTRINSIC(name) _mm512_##name
#elif HOL_LANES == 4 && defined(__AVX2__) && defined(__FMA__)
#define HOL_INTRINSIC(name) _mm256_##name
#endif

#ifdef HOL_INTRINSIC
namespace holonomic::HOL_ISA {

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

}  // namespace holonomic::HOL_ISA
#endif
#endif
