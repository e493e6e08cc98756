// Sets of one lane: what needs no order along a chain is done for four of its bonds at a time, as they stand in memory.
// Each number is made as one lane makes it. Twelve components x y z x y z .. are three vectors of four.
#pragma once

#include "core/kernels/arithmetic/vector3.hpp"
#include "core/kernels/isa/choose.hpp"

#if HOL_FOURS
namespace holonomic::HOL_ISA {

HOL_INLINE four load_four(const vec *p) { return load_any<four>(&p->element); }

// The values of four bonds, for vector j of their components.
template <int j>
HOL_INLINE four spread(four a) {
    return _mm256_permute4x64_pd(a, j == 0 ? 0x40 : j == 1 ? 0xa5 : 0xfe);
}

// Vectors in space from their components.
HOL_INLINE Vector3<four> as_vectors(const four *p) {
    const four a = _mm256_blend_pd(p[0], p[1], 12), b = _mm256_permute2f128_pd(p[0], p[2], 0x21),
               c = _mm256_blend_pd(p[1], p[2], 12);
    return {_mm256_shuffle_pd(a, b, 10), _mm256_shuffle_pd(a, c, 5), _mm256_shuffle_pd(b, c, 10)};
}

// Calls body(k, j, pull) for vector j of the pulls t' d' - t d on the atoms k .. k + 3, from atom k0 > 0 on, as long as
// there are four with a bond behind each. Returns the first atom that is left.
template <class Body>
HOL_INLINE long pulls_in_fours(long k0, long n, const vec3 *d, const vec *t, const Body &body) {
    for (; k0 + 4 <= n; k0 += 4) {
        const four before = load_four(t + k0 - 1), behind = load_four(t + k0);
        const double *const x = &d[k0].x.element;
        const auto part = [&](auto j, four t0, four t1) HOL_FORCED {
            body(k0, j, t1 * load_any<four>(x + 4 * j) - t0 * load_any<four>(x + 4 * j - 3));
        };
        part(Constant<int, 0>{}, spread<0>(before), spread<0>(behind));
        part(Constant<int, 1>{}, spread<1>(before), spread<1>(behind));
        part(Constant<int, 2>{}, spread<2>(before), spread<2>(behind));
    }
    return k0;
}

// Rates d . (v' - v) of the bonds k .. k + 3 between the atoms x[k] and x[k + 1].
HOL_INLINE four rates_of_four(long k, const vec3 *d, const double *x) {
    const double *const v = x + 3 * k;
    four bond[3], change[3];
    HOL_UNROLL
    for (int j = 0; j < 3; ++j) {
        bond[j] = load_any<four>(&d[k].x.element + 4 * j);
        change[j] = load_any<four>(v + 4 * j + 3) - load_any<four>(v + 4 * j);
    }
    return dot(as_vectors(bond), as_vectors(change));
}

}  // namespace holonomic::HOL_ISA
#endif
