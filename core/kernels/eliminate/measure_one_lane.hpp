// Bonds and joints of a chain that comes alone, as measure() in deficits.hpp finds them, in sets of one lane: four at a
// time, for none waits for another. Each number is made as one lane makes it.
#pragma once

#include "core/kernels/arithmetic/exact.hpp"
#include "core/kernels/memory/fours.hpp"

#if HOL_FOURS
namespace holonomic::HOL_ISA {

// A type of its own: the templates of exact.hpp find its functions.
struct Four {
    four v;
};
HOL_INLINE Four operator+(Four a, Four b) { return {a.v + b.v}; }
HOL_INLINE Four operator-(Four a, Four b) { return {a.v - b.v}; }
HOL_INLINE Four operator*(Four a, Four b) { return {a.v * b.v}; }
HOL_INLINE Four operator/(Four a, Four b) { return {a.v / b.v}; }
HOL_INLINE Four operator-(Four a) { return {-a.v}; }
HOL_INLINE Four mul_add(Four a, Four b, Four c) { return {_mm256_fmadd_pd(a.v, b.v, c.v)}; }
HOL_INLINE Four abs(Four a) { return {_mm256_andnot_pd(_mm256_set1_pd(-0.0), a.v)}; }
HOL_INLINE Four max(Four a, Four b) { return {_mm256_max_pd(a.v, b.v)}; }

// The bonds of one stage, and before them the last one of the stage before; components apart.
struct MeasuredBonds {
    static constexpr long most = 32;
    double d[3][most + 4], low[3][most + 4], r[most + 4];  // in units of their scales; 1 / |d|

    HOL_FORCED Vector3<Four> vector(const double (*of)[most + 4], long i) const {
        return {load_any<Four>(of[0] + i), load_any<Four>(of[1] + i), load_any<Four>(of[2] + i)};
    }
    HOL_FORCED void put(double (*of)[most + 4], long i, const Vector3<Four> &a) {
        store_any(of[0] + i, a.x);
        store_any(of[1] + i, a.y);
        store_any(of[2] + i, a.z);
    }
    HOL_FORCED void move_last(long n) {
        for (int c = 0; c < 3; ++c) {
            d[c][0] = d[c][n];
            low[c][0] = low[c][n];
        }
        r[0] = r[n];
    }
};

// As they stand in memory.
HOL_INLINE Vector3<Four> read_vectors(const double *p) {
    four part[3];
    for (int j = 0; j < 3; ++j) part[j] = load_any<four>(p + 4 * j);
    const Vector3<four> a = as_vectors(part);
    return {{a.x}, {a.y}, {a.z}};
}
HOL_INLINE void write_vectors(double *p, const Vector3<Four> &v) {
    const four a = _mm256_shuffle_pd(v.x.v, v.y.v, 0), b = _mm256_shuffle_pd(v.z.v, v.x.v, 10),
               c = _mm256_shuffle_pd(v.y.v, v.z.v, 15);
    store_any(p, four(_mm256_permute2f128_pd(a, b, 0x20)));
    store_any(p + 4, four(_mm256_blend_pd(c, a, 12)));
    store_any(p + 8, four(_mm256_permute2f128_pd(b, c, 0x31)));
}

// As of lanes, in deficits.hpp.
HOL_INLINE Four reciprocal_scale(Four a) {
    const __m256i exponents = _mm256_and_si256(_mm256_castpd_si256(a.v), _mm256_set1_epi64x(0x7ff0000000000000LL));
    return {_mm256_castsi256_pd(_mm256_sub_epi64(_mm256_set1_epi64x(2 * 0x3ff0000000000000LL), exponents))};
}

// Four bonds u [12], which become unit vectors, and low words; what is found goes to `square`, `scale`, `reciprocal`
// [4]. i: their place in the stage.
HOL_INLINE void measure_bonds(MeasuredBonds &x, long i, double *u, const double *u_low, double *square, double *scale,
                              double *reciprocal) {
    const Vector3<Four> raw = read_vectors(u);
    const Four s = reciprocal_scale(max(max(abs(raw.x), abs(raw.y)), abs(raw.z)));
    const Vector3<Four> d = s * raw, low = s * read_vectors(u_low);
    const Four q = square_of(d, low), r = Four{four{} + 1.0} / Four{_mm256_sqrt_pd(q.v)};
    x.put(x.d, i, d);
    x.put(x.low, i, low);
    store_any(x.r + i, r);
    write_vectors(u, r * d);
    store_any(square, q);
    store_any(scale, s);
    store_any(reciprocal, r * s);
}

// The joints before bonds i .. i + 3 of the stage.
HOL_INLINE void measure_joints(const MeasuredBonds &x, long i, double *cosine, double *complement, double *normal) {
    const Four one = {four{} + 1.0}, f = load_any<Four>(x.r + i - 1) * load_any<Four>(x.r + i);
    const Vector3<Four> d0 = x.vector(x.d, i - 1), low0 = x.vector(x.low, i - 1), d = x.vector(x.d, i),
                        low = x.vector(x.low, i);
    const Four c = dot_compensated(d0, low0, d, low) * f;
    const Vector3<Four> n = f * cross_compensated(d0, low0, d, low);
    const Four size = abs(c), near = one - size, far = dot(n, n) / (one + size);
    store_any(cosine, c);
    store_any(complement, four(_mm256_blendv_pd(far.v, near.v, _mm256_cmp_pd(size.v, four{} + 0.5, _CMP_LT_OQ))));
    write_vectors(normal, n);
}

// All bonds and joints of n: from bond vectors in x.u and their low words. Beside the last ones, and before the first,
// stand bonds that are there for this alone.
template <class Geometry>
HOL_NOINLINE void measure_in_fours(long n, const Geometry &x) {
    MeasuredBonds bonds;
    for (long k = n; k % 4 != 0; ++k) {
        x.u[k] = vec3{{1}, {1}, {1}};
        x.low[k] = vec3{};
    }
    for (int c = 0; c < 3; ++c) {
        bonds.d[c][0] = 1;
        bonds.low[c][0] = 0;
    }
    bonds.r[0] = 1;
    for (long first = 0; first < n; first += MeasuredBonds::most) {
        const long count = first + MeasuredBonds::most < n ? MeasuredBonds::most : n - first;
        for (long i = 0; i < count; i += 4) {
            const long k = first + i;
            measure_bonds(bonds, i + 1, &x.u[k].x.element, &x.low[k].x.element, &x.square[k].element,
                          &x.scale[k].element, &x.reciprocal[k].element);
        }
        for (long i = 0; i < count; i += 4) {
            const long k = first + i;
            measure_joints(bonds, i + 1, &x.cosine[k].element, &x.complement[k].element, &x.normal[k].x.element);
        }
        bonds.move_last(count);
    }
}

// weigh_normal() in deficits.hpp for the joints from k on, with deficits x.f. Returns the first one that is left.
template <bool uniform, class Geometry>
HOL_INLINE long weigh_in_fours(long k, long n, const vec *w, const Geometry &x) {
    const four one = four{} + 1.0, zero = {}, sign = _mm256_set1_pd(-0.0);
    for (; k + 4 <= n; k += 4) {
        four p = load_four(x.p + k), A = load_four(x.e + k - 1), B = load_four(x.f + k), of_atom = one;
        const four coupled = _mm256_cmp_pd(zero, p, _CMP_LT_OQ);
        if (!uniform) {
            of_atom = load_four(w + k);
            const four s = reciprocal_scale(max(max(Four{A}, Four{B}), Four{of_atom})).v;
            p = s * p;
            A = s * A;
            B = s * B;
            of_atom = s * of_atom;
        }
        const four G = load_four(x.per_f + k), pF = p * load_four(x.per_e + k - 1), pG = p * G;
        const four whole = mul_add(pG, A, mul_add(pF, B, A * B));
        const four size = of_atom * (pF * G) / _mm256_blendv_pd(one, whole, coupled);
        const four h = _mm256_and_pd(coupled, _mm256_or_pd(size, _mm256_and_pd(load_four(x.cosine + k), sign)));
        double *const normal = &x.normal[k].x.element;
        store_any(normal, spread<0>(h) * load_any<four>(normal));
        store_any(normal + 4, spread<1>(h) * load_any<four>(normal + 4));
        store_any(normal + 8, spread<2>(h) * load_any<four>(normal + 8));
    }
    return k;
}

// The same of turn().
template <class Geometry>
HOL_INLINE long turn_in_fours(long k, long n, const Geometry &x, double kT) {
    const Four zero = {four{}};
    for (; k + 4 <= n; k += 4) {
        const double *const normal = &x.normal[k].x.element;
        double change[12];
        for (int j = 0; j < 3; ++j)
            store_any(change + 4 * j, load_any<four>(normal + 4 * j + 3) - load_any<four>(normal + 4 * j));
        const Vector3<Four> v = cross(read_vectors(&x.u[k].x.element), read_vectors(change));
        write_vectors(&x.u[k].x.element, {v.x + zero, v.y + zero, v.z + zero});
        store_any(&x.t[k].element, kT * load_four(x.reciprocal + k));
    }
    return k;
}

}  // namespace holonomic::HOL_ISA
#endif
