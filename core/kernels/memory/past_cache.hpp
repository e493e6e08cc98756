// Stores past the cache, for what will not be read soon.
#ifndef HOLONOMIC_KERNELS_MEMORY_PAST_CACHE_HPP
#define HOLONOMIC_KERNELS_MEMORY_PAST_CACHE_HPP

#include "core/kernels/isa/lanes.hpp"

namespace holonomic::HOL_ISA {

// settle_stores() must follow before another thread may read it.
HOL_INLINE void store_past_cache(vec *p, vec a) {
#if HOL_LANES == 8 && defined(__AVX512F__)
    _mm512_stream_pd(reinterpret_cast<double *>(p), a);
#elif HOL_LANES == 4 && defined(__AVX__)
    _mm256_stream_pd(reinterpret_cast<double *>(p), a);
#elif HOL_LANES == 2 && defined(__SSE2__)
    _mm_stream_pd(reinterpret_cast<double *>(p), a);
#else
    *p = a;
#endif
}
HOL_INLINE void settle_stores() {
#if defined(__SSE2__)
    _mm_sfence();
#endif
}

}  // namespace holonomic::HOL_ISA
#endif
