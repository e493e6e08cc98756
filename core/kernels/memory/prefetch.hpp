// Past and ahead of the cache: fetching what the next block will read, and stores of what will not be read soon.
#pragma once

#include <stdint.h>

#include "core/kernels/isa/lanes.hpp"

namespace holonomic::HOL_ISA {

// Starts to fetch vectors of the next block, `atoms` of each lane, while this block is at atom k0. The next block lies
// `ahead` doubles further on, with its lanes one behind the other. They are fetched in that order because the
// processor's own prefetchers follow it. Addresses may lie behind the array.
template <int atoms = W>
HOL_INLINE void fetch_ahead(const double *first_lane, long k0, long ahead) {
    const uintptr_t address =
        reinterpret_cast<uintptr_t>(first_lane) + static_cast<uintptr_t>(ahead + 3 * W * k0) * sizeof(double);
    HOL_UNROLL
    for (int line = 0; line < (3 * W * atoms + 7) / 8; ++line)
        __builtin_prefetch(reinterpret_cast<const void *>(address + static_cast<uintptr_t>(line) * 64), 0, 2);
}

// settle_stores() must follow before another thread may read it.
HOL_INLINE void store_past_cache(vec *p, vec a) {
#if HOL_LANES == 4 && defined(__AVX__)
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
