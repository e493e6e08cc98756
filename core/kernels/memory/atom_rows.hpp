// Reads and writes one atom of each lane, a row x y z. Nothing behind z is touched.
#pragma once

#include "core/kernels/arithmetic/vector3.hpp"
#include "core/kernels/memory/block.hpp"
#include "core/kernels/memory/outputs.hpp"

namespace holonomic::HOL_ISA {

#if HOL_LANES >= 4 && defined(__AVX2__)
// Rows are read in the same parts as they are written, and never beyond z. A load that overlaps a recent store in any
// other way has to wait for it.
HOL_INLINE void read_rows(const double *const *p, quad &x, quad &y, quad &z) {
    const quad even = _mm256_insertf128_pd(_mm256_castpd128_pd256(_mm_loadu_pd(p[0])), _mm_loadu_pd(p[2]), 1);
    const quad odd = _mm256_insertf128_pd(_mm256_castpd128_pd256(_mm_loadu_pd(p[1])), _mm_loadu_pd(p[3]), 1);
    x = _mm256_unpacklo_pd(even, odd);
    y = _mm256_unpackhi_pd(even, odd);
    z = quad{p[0][2], p[1][2], p[2][2], p[3][2]};
}

HOL_INLINE void write_rows(double *const *p, quad x, quad y, quad z) {
    const quad even = _mm256_unpacklo_pd(x, y), odd = _mm256_unpackhi_pd(x, y);
    HOL_UNROLL
    for (int i = 0; i < 4; ++i) {
        const quad pair = i % 2 ? odd : even;
        _mm_storeu_pd(p[i], i < 2 ? _mm256_castpd256_pd128(pair) : _mm256_extractf128_pd(pair, 1));
        p[i][2] = z[i];
    }
}
#endif

HOL_INLINE void read_rows(const double *const *p, vec3 &a) {
#if HOL_LANES == 4 && defined(__AVX2__)
    read_rows(p, a.x, a.y, a.z);
#elif HOL_NEON
    vec pair[2] = {load(p[0]), load(p[1])};
    transpose(pair);
    a = {pair[0], pair[1], vec{p[0][2], p[1][2]}};
#elif HOL_LANES == 2
    a = {vec{p[0][0], p[1][0]}, vec{p[0][1], p[1][1]}, vec{p[0][2], p[1][2]}};
#else
    // gcc 12 loses elements that are written to a wide vector without a value, or to several of them in turns.
    a = vec3{};
    for (int i = 0; i < W; ++i) a.x[i] = p[i][0];
    for (int i = 0; i < W; ++i) a.y[i] = p[i][1];
    for (int i = 0; i < W; ++i) a.z[i] = p[i][2];
#endif
}

HOL_INLINE void write_rows(double *const *p, const vec3 &a) {
#if HOL_LANES == 4 && defined(__AVX2__)
    write_rows(p, a.x, a.y, a.z);
#elif HOL_NEON
    vec pair[2] = {a.x, a.y};
    transpose(pair);
    HOL_UNROLL
    for (int i = 0; i < 2; ++i) {
        store(p[i], pair[i]);
        p[i][2] = a.z[i];
    }
#else
    for (int i = 0; i < W; ++i) {
        p[i][0] = a.x[i];
        p[i][1] = a.y[i];
        p[i][2] = a.z[i];
    }
#endif
}

// Atoms that stand anywhere in packed arrays: at.atom(base, i, k) is where atom k of lane i is. They are read and
// written one of each lane at a time; the arithmetic is that of rows.

// The lanes' lists of atoms.
struct AtomLists {
    const int64_t *atoms[W];
    explicit AtomLists(const Lane *lane) {
        for (int i = 0; i < W; ++i) atoms[i] = lane[i].atoms;
    }
    // Lists of n_atoms each, one behind the other.
    AtomLists(const int64_t *first, int64_t n_atoms) {
        for (int i = 0; i < W; ++i) atoms[i] = first + i * n_atoms;
    }
    HOL_FORCED const double *atom(const double *base, int i, long k) const { return base + 3 * atoms[i][k]; }
    // Starts to fetch the atoms k, `ahead` further on in each list, of up to three arrays; ahead = 0: none.
    HOL_FORCED void fetch(long k, long ahead, const double *a, const double *b, const double *c) const {
        for (int i = 0; ahead && i < W; ++i) {
            const int64_t next = 3 * atoms[i][k + ahead];
            if (a) __builtin_prefetch(a + next, 0, 2);
            if (b) __builtin_prefetch(b + next, 0, 2);
            if (c) __builtin_prefetch(c + next, 0, 2);
        }
    }
};

template <class View>
HOL_INLINE vec3 gather(const double *base, const View &at, long k) {
    const double *p[W];
    HOL_UNROLL
    for (int i = 0; i < W; ++i) p[i] = at.atom(base, i, k);
    vec3 a;
    read_rows(p, a);
    return a;
}

template <Update update, class View>
HOL_INLINE void scatter(double *base, const View &at, long k, vec3 a) {
    if (update == add_) a = gather(base, at, k) + a;
    double *p[W];
    HOL_UNROLL
    for (int i = 0; i < W; ++i) p[i] = const_cast<double *>(at.atom(base, i, k));
    write_rows(p, a);
}

HOL_INLINE double *base_of(const AtomArray &array) { return reinterpret_cast<double *>(array.x); }

// True if the block is full, its chains are equally long, and all have lists.
HOL_INLINE bool listed(const Block &block, const Lane *lane) {
    if (block.lanes < W || block.n != block.n_min) return false;
    for (int i = 0; i < W; ++i)
        if (!lane[i].atoms) return false;
    return true;
}

}  // namespace holonomic::HOL_ISA
