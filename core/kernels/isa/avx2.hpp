// Four lanes by AVX2 and FMA.
#ifndef HOLONOMIC_KERNELS_ISA_AVX2_HPP
#define HOLONOMIC_KERNELS_ISA_AVX2_HPP

#include "core/kernels/isa/vector.hpp"

#if HOL_LANES == 4 && defined(__AVX2__) && defined(__FMA__)
namespace holonomic {
namespace HOL_ISA {

HOL_INLINE vec mul_add(vec a, vec b, vec c) { return _mm256_fmadd_pd(a, b, c); }
HOL_INLINE vec mul_sub(vec a, vec b, vec c) { return _mm256_fmsub_pd(a, b, c); }
HOL_INLINE vec max(vec a, vec b) { return _mm256_max_pd(a, b); }
HOL_INLINE vec min(vec a, vec b) { return _mm256_min_pd(a, b); }
HOL_INLINE vec sqrt(vec a) { return _mm256_sqrt_pd(a); }
HOL_INLINE vec round(vec a) { return _mm256_round_pd(a, _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC); }
HOL_INLINE unsigned bits(mask m) { return static_cast<unsigned>(_mm256_movemask_pd(as_vec(m))); }

}  // namespace HOL_ISA
}  // namespace holonomic
#endif
#endif
