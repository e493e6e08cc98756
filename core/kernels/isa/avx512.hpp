// Eight lanes by AVX-512.
#ifndef HOLONOMIC_KERNELS_ISA_AVX512_HPP
#define HOLONOMIC_KERNELS_ISA_AVX512_HPP

#include "core/kernels/isa/vector.hpp"

#if HOL_LANES == 8 && defined(__AVX512F__)
namespace holonomic {
namespace HOL_ISA {

HOL_INLINE vec mul_add(vec a, vec b, vec c) { return _mm512_fmadd_pd(a, b, c); }
HOL_INLINE vec mul_sub(vec a, vec b, vec c) { return _mm512_fmsub_pd(a, b, c); }
HOL_INLINE vec max(vec a, vec b) { return _mm512_max_pd(a, b); }
HOL_INLINE vec min(vec a, vec b) { return _mm512_min_pd(a, b); }
HOL_INLINE vec sqrt(vec a) { return _mm512_sqrt_pd(a); }
HOL_INLINE vec round(vec a) { return _mm512_roundscale_pd(a, _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC); }
HOL_INLINE unsigned bits(mask m) { return static_cast<unsigned>(_mm512_movepi64_mask(reinterpret_cast<__m512i>(m))); }

}  // namespace HOL_ISA
}  // namespace holonomic
#endif
#endif
