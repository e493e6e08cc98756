// Elements that stand one behind the other in each of four lanes: four at a time where they can be, then two by two,
// then alone. In two lanes: two by two, then alone.
#pragma once

#include "core/kernels/isa/lanes.hpp"

namespace holonomic::HOL_ISA {

// Whether there are functions for all lanes at once.
#if HOL_NEON || (HOL_LANES == 4 && defined(__AVX2__))
#define HOL_ELEMENTS 1
#else
#define HOL_ELEMENTS 0
#endif

#if HOL_LANES >= 4 && defined(__AVX2__)
// Two elements of four lanes, from element k of their rows.
HOL_INLINE void read_pair(const double *const *p, long k, quad &first, quad &second) {
    quad of[2];
    HOL_UNROLL
    for (int i = 0; i < 2; ++i)
        of[i] = _mm256_insertf128_pd(_mm256_castpd128_pd256(_mm_loadu_pd(p[i] + k)), _mm_loadu_pd(p[i + 2] + k), 1);
    first = _mm256_unpacklo_pd(of[0], of[1]);
    second = _mm256_unpackhi_pd(of[0], of[1]);
}

// Element e of four lanes.
template <int n>
HOL_INLINE void read_elements(const double *const *p, quad *e) {
    constexpr int fours = n / 4 * 4, twos = n / 2 * 2;
    HOL_UNROLL
    for (int j = 0; j < fours; j += 4) {
        HOL_UNROLL
        for (int i = 0; i < 4; ++i) e[j + i] = _mm256_loadu_pd(p[i] + j);
        transpose(e + j);
    }
    if (fours < twos) read_pair(p, fours, e[fours], e[twos - 1]);
    if (twos < n) e[n - 1] = quad{p[0][n - 1], p[1][n - 1], p[2][n - 1], p[3][n - 1]};
}

// What is left of rows is handed to two(lane, element, numbers) and one(lane, element, number).
template <int n, class Two, class One>
HOL_INLINE void for_each_left(const quad *e, const Two &two, const One &one) {
    constexpr int fours = n / 4 * 4, twos = n / 2 * 2;
    if (fours < twos) {
        const quad of[2] = {_mm256_unpacklo_pd(e[fours], e[twos - 1]), _mm256_unpackhi_pd(e[fours], e[twos - 1])};
        HOL_UNROLL
        for (int i = 0; i < 4; ++i)
            two(i, fours, i < 2 ? _mm256_castpd256_pd128(of[i % 2]) : _mm256_extractf128_pd(of[i % 2], 1));
    }
    HOL_UNROLL
    for (int i = 0; i < 4 && twos < n; ++i) one(i, n - 1, e[n - 1][i]);
}

// The elements are used up.
template <int n>
HOL_INLINE void write_elements(double *const *p, quad *e) {
    HOL_UNROLL
    for (int j = 0; j < n / 4; ++j) {
        transpose(e + 4 * j);
        HOL_UNROLL
        for (int i = 0; i < 4; ++i) _mm256_storeu_pd(p[i] + 4 * j, e[4 * j + i]);
    }
    for_each_left<n>(
        e, [&](int i, int c, double2 x) HOL_FORCED { _mm_storeu_pd(p[i] + c, x); },
        [&](int i, int c, double x) HOL_FORCED { p[i][c] = x; });
}
#elif HOL_NEON
template <int n>
HOL_INLINE void read_elements(const double *const *p, vec *e) {
    constexpr int twos = n / 2 * 2;
    HOL_UNROLL
    for (int j = 0; j < twos; j += 2) {
        e[j] = load(p[0] + j);
        e[j + 1] = load(p[1] + j);
        transpose(e + j);
    }
    if (twos < n) e[n - 1] = vec{p[0][n - 1], p[1][n - 1]};
}

// The elements are used up. pair(lane, element, numbers) gets two, one(lane, element, number) what is left.
template <int n, class Two, class One>
HOL_INLINE void for_each_pair(vec *e, const Two &pair, const One &one) {
    constexpr int twos = n / 2 * 2;
    HOL_UNROLL
    for (int j = 0; j < twos; j += 2) {
        transpose(e + j);
        pair(0, j, e[j]);
        pair(1, j, e[j + 1]);
    }
    if (twos == n) return;
    one(0, n - 1, e[n - 1][0]);
    one(1, n - 1, e[n - 1][1]);
}
template <int n>
HOL_INLINE void write_elements(double *const *p, vec *e) {
    for_each_pair<n>(
        e, [&](int i, int c, vec x) HOL_FORCED { store(p[i] + c, x); },
        [&](int i, int c, double x) HOL_FORCED { p[i][c] = x; });
}
#endif

}  // namespace holonomic::HOL_ISA
