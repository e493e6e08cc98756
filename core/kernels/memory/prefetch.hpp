// Past and ahead of the cache: fetching what the next block will read, and stores of what will not be read soon.
#pragma once

#include <stdint.h>

#include "core/kernels/call.hpp"
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

// What the next few molecules are read from and written to, fetched array by array between the stages of those that are
// worked on. In a large call that is what a block waits for longest: the rows of a few molecules in three or four
// arrays are too short for a processor to notice that they are gone through, and some twenty lines are under way at
// once.
class NextMolecules {
public:
    NextMolecules() = default;
    // The arrays of a call, in the order in which they are needed, and its multipliers, which are last. Arrays that are
    // not packed, or not there, are left out.
    template <int n>
    explicit NextMolecules(const AtomArray *const (&arrays)[n], const double *lambda = nullptr) : multipliers(lambda) {
        static_assert(n <= most, "");
        for (const AtomArray *array : arrays)
            if (array->x && array->packed) base[count++] = reinterpret_cast<const char *>(array->x);
    }
    // The next molecules have at most so many atoms each, and are those of add().
    void begin(int64_t n_atoms) {
        most_atoms = n_atoms;
        fetched = n_molecules = 0;
    }
    void add(int64_t first_atom) { molecule[n_molecules++] = {nullptr, first_atom, 0}; }
    // With its masses and multipliers. Those whose atoms a list has are anywhere, and left out.
    void add(const MoleculeLane &one) {
        if (!one.atoms) molecule[n_molecules++] = {one.w, one.first_atom, one.first_bond};
    }

    // Starts to fetch one array more, with the first one the masses. gcc 12 leaves out calls of functions that do
    // nothing but fetch.
    __attribute__((noinline)) void fetch() {
        __asm__ volatile("");
        if (fetched >= count) return;
        const char *const x = base[fetched++];
        const double *known = nullptr;
        for (int i = 0; i < n_molecules; ++i) {
            const Next &m = molecule[i];
            if (fetched == 1 && m.w != known) lines(known = m.w, 8 * most_atoms);
            lines(x + row * m.first_atom, row * most_atoms);
            if (fetched == count && multipliers) lines(multipliers + m.first_bond, 8 * most_atoms);
        }
    }
    void fetch_the_rest() {
        while (fetched < count) fetch();
    }

private:
    struct Next {
        const double *w;  // or nullptr
        int64_t first_atom, first_bond;
    };
    static constexpr int most = 4;
    static constexpr int64_t row = 3 * sizeof(double), line = 64;
    const char *base[most] = {};
    const double *multipliers = nullptr;
    Next molecule[2 * W];
    int64_t most_atoms = 0;
    int count = 0, fetched = most, n_molecules = 0;

    HOL_STATIC void lines(const void *from, int64_t bytes) {
        for (int64_t i = 0; i < bytes; i += line) __builtin_prefetch(static_cast<const char *>(from) + i, 0, 2);
    }
};

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
