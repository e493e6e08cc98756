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

// Four bonds from `from` [12], and low words; what is found goes to the same places of `u` [12], `square`, `scale`,
// `reciprocal` [4]. i: their place in the stage.
HOL_INLINE void measure_bonds(MeasuredBonds &x, long i, const double *from, const double *from_low, double *u,
                              double *square, double *scale, double *reciprocal) {
    const Vector3<Four> raw = read_vectors(from);
    const Four largest = max(max(abs(raw.x), abs(raw.y)), abs(raw.z));
    const __m256i exponents =
        _mm256_and_si256(_mm256_castpd_si256(largest.v), _mm256_set1_epi64x(0x7ff0000000000000LL));
    const Four s = {_mm256_castsi256_pd(_mm256_sub_epi64(_mm256_set1_epi64x(2 * 0x3ff0000000000000LL), exponents))};
    const Vector3<Four> d = s * raw, low = s * read_vectors(from_low);
    const Four q = dot_compensated(d, low, d, low), r = Four{four{} + 1.0} / Four{_mm256_sqrt_pd(q.v)};
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

// All bonds and joints of n: from bond vectors in x.u and their low words. The last ones of a stage that are fewer than
// four are measured apart, beside bonds that are there for this alone.
template <class Geometry>
HOL_NOINLINE void measure_in_fours(long n, const Geometry &x) {
    MeasuredBonds bonds;
    for (long first = 0; first < n; first += MeasuredBonds::most) {
        const long count = first + MeasuredBonds::most < n ? MeasuredBonds::most : n - first;
        for (long i = 0; i < count; i += 4) {
            const long k = first + i, m = count - i < 4 ? count - i : 4;
            if (m == 4) {
                measure_bonds(bonds, i + 1, &x.u[k].x.element, &x.low[k].x.element, &x.u[k].x.element,
                              &x.square[k].element, &x.scale[k].element, &x.reciprocal[k].element);
                continue;
            }
            double d[12] = {1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0}, low[12] = {}, value[3][4];
            for (long e = 0; e < 3 * m; ++e) d[e] = (&x.u[k].x.element)[e], low[e] = (&x.low[k].x.element)[e];
            measure_bonds(bonds, i + 1, d, low, d, value[0], value[1], value[2]);
            for (long e = 0; e < 3 * m; ++e) (&x.u[k].x.element)[e] = d[e];
            for (long b = 0; b < m; ++b) {
                x.square[k + b].element = value[0][b];
                x.scale[k + b].element = value[1][b];
                x.reciprocal[k + b].element = value[2][b];
            }
        }
        // Joint k is before bond k.
        for (long i = first == 0 ? 1 : 0; i < count; i += 4) {
            const long k = first + i, m = count - i < 4 ? count - i : 4;
            double c[4], complement[4], normal[12];
            if (m == 4) {
                measure_joints(bonds, i + 1, &x.cosine[k].element, &x.complement[k].element, &x.normal[k].x.element);
                continue;
            }
            for (long b = i + 1 + m; b < i + 5; ++b) {  // any bond
                for (int e = 0; e < 3; ++e) bonds.d[e][b] = bonds.low[e][b] = 1;
                bonds.r[b] = 1;
            }
            measure_joints(bonds, i + 1, c, complement, normal);
            for (long b = 0; b < m; ++b) {
                x.cosine[k + b].element = c[b];
                x.complement[k + b].element = complement[b];
            }
            for (long e = 0; e < 3 * m; ++e) (&x.normal[k].x.element)[e] = normal[e];
        }
        bonds.move_last(count);
    }
}

// weigh_normal() in deficits.hpp for the joints from k on, with deficits x.f. Returns the first one that is left.
template <bool uniform, class Geometry>
HOL_INLINE long weigh_in_fours(long k, long n, const vec *w, const Geometry &x) {
    const four one = four{} + 1.0, zero = {}, sign = _mm256_set1_pd(-0.0);
    for (; k + 4 <= n; k += 4) {
        const four p = load_four(x.p + k), coupled = _mm256_cmp_pd(zero, p, _CMP_LT_OQ);
        const four e = load_four(x.e + k - 1), f = load_four(x.f + k), divisor = _mm256_blendv_pd(one, p, coupled);
        const four size = (uniform ? one : load_four(w + k)) / (e + f + (e / divisor) * f);
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
