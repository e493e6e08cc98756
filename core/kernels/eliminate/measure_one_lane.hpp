// Bonds and joints of a chain that comes alone, as measure() in deficits.hpp finds them, in sets of one lane: four at a
// time, for none waits for another. Each number is made as one lane makes it.
#pragma once

#include "core/kernels/arithmetic/image.hpp"
#include "core/kernels/memory/fours.hpp"

#if HOL_FOURS
namespace holonomic::HOL_ISA {

// A type of its own: the templates of exact.hpp find its functions.
struct FourLanes {
    four v;
};
HOL_INLINE FourLanes operator+(FourLanes a, FourLanes b) { return {a.v + b.v}; }
HOL_INLINE FourLanes operator-(FourLanes a, FourLanes b) { return {a.v - b.v}; }
HOL_INLINE FourLanes operator*(FourLanes a, FourLanes b) { return {a.v * b.v}; }
HOL_INLINE FourLanes operator/(FourLanes a, FourLanes b) { return {a.v / b.v}; }
HOL_INLINE FourLanes operator-(FourLanes a) { return {-a.v}; }
HOL_INLINE FourLanes mul_add(FourLanes a, FourLanes b, FourLanes c) { return {_mm256_fmadd_pd(a.v, b.v, c.v)}; }
HOL_INLINE FourLanes abs(FourLanes a) { return {_mm256_andnot_pd(_mm256_set1_pd(-0.0), a.v)}; }
HOL_INLINE FourLanes max(FourLanes a, FourLanes b) { return {_mm256_max_pd(a.v, b.v)}; }
HOL_INLINE FourLanes round(FourLanes a) { return {round(a.v)}; }
HOL_INLINE FourLanes operator*(FourLanes a, double b) { return {a.v * b}; }
HOL_INLINE FourLanes operator+(FourLanes a, double b) { return {a.v + b}; }

// The bonds of one stage in units of their scales, and 1 / |d| there; components apart. From place 4 on; before them
// stands the last one of the stage before.
struct MeasuredBonds {
    static constexpr long most = 32;
    double d[3][most + 4], low[3][most + 4], r[most + 4];
};
typedef double Row[MeasuredBonds::most + 4];
HOL_INLINE void put(Row *to, long i, const Vector3<FourLanes> &v) {
    store_any(to[0] + i, v.x);
    store_any(to[1] + i, v.y);
    store_any(to[2] + i, v.z);
}
HOL_INLINE Vector3<FourLanes> get(const Row *of, long i) {
    return {load_any<FourLanes>(of[0] + i), load_any<FourLanes>(of[1] + i), load_any<FourLanes>(of[2] + i)};
}

// As they stand in memory.
HOL_INLINE Vector3<FourLanes> as_fours(const four *part) {
    const Vector3<four> a = as_vectors(part);
    return {{a.x}, {a.y}, {a.z}};
}
HOL_INLINE Vector3<FourLanes> read_vectors(const double *p) {
    four part[3];
    for (int j = 0; j < 3; ++j) part[j] = load_any<four>(p + 4 * j);
    return as_fours(part);
}
HOL_INLINE void write_vectors(double *p, const Vector3<FourLanes> &v) {
    const four a = _mm256_shuffle_pd(v.x.v, v.y.v, 0), b = _mm256_shuffle_pd(v.z.v, v.x.v, 10),
               c = _mm256_shuffle_pd(v.y.v, v.z.v, 15);
    store_any(p, four(_mm256_permute2f128_pd(a, b, 0x20)));
    store_any(p + 4, four(_mm256_blend_pd(c, a, 12)));
    store_any(p + 8, four(_mm256_permute2f128_pd(b, c, 0x31)));
}

// As of lanes, in deficits.hpp.
HOL_INLINE FourLanes reciprocal_scale(FourLanes a) {
    const __m256i exponents = _mm256_and_si256(_mm256_castpd_si256(a.v), _mm256_set1_epi64x(0x7ff0000000000000LL));
    return {_mm256_castsi256_pd(_mm256_sub_epi64(_mm256_set1_epi64x(2 * 0x3ff0000000000000LL), exponents))};
}

// Few calls have a box, so it is not inlined.
HOL_NOINLINE void fold(const Box &box, Vector3<FourLanes> *d, Vector3<FourLanes> *low) { wrap<true>(box, *d, *low); }

// Four bonds from the atom at r on, unrounded. Of the last ones there are `left`, fewer than four; beside them stand
// bonds that are there for this alone.
template <bool last>
HOL_INLINE void read_bonds(const Box &box, const double *r, long left, Vector3<FourLanes> &d, Vector3<FourLanes> &low) {
    static const long long inside[24] = {-1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1};
    const auto mask_of = [&](long i) HOL_FORCED {
        return _mm256_loadu_si256(reinterpret_cast<const __m256i *>(inside + 12 + i));
    };
    four hi[3], lo[3];
    HOL_UNROLL
    for (int j = 0; j < 3; ++j) {
        const double *const p = r + 4 * j;
        const auto read = [&](const double *at) HOL_FORCED {
            return last ? four(_mm256_maskload_pd(at, mask_of(4 * j - 3 * left))) : load_any<four>(at);
        };
        const Pair<four> e = two_difference<four>(read(p + 3), read(p));
        hi[j] = e.hi;
        lo[j] = e.lo;
    }
    d = as_fours(hi);
    low = as_fours(lo);
    if (__builtin_expect(box.lattice != Box::none, 0)) {
        Vector3<FourLanes> folded = d, folded_low = low;
        fold(box, &folded, &folded_low);
        d = folded;
        low = folded_low;
    }
    if (!last) return;
    const four one = four{} + 1.0, live = _mm256_castsi256_pd(mask_of(-left));
    d = {{_mm256_blendv_pd(one, d.x.v, live)},
         {_mm256_blendv_pd(one, d.y.v, live)},
         {_mm256_blendv_pd(one, d.z.v, live)}};
}

// Bonds k .. k + 3 of n, to place i of the stage.
template <bool last, class Geometry>
HOL_INLINE void measure_bonds(const Box &box, const double *r, long k, long n, const Geometry &x, MeasuredBonds &to,
                              long i) {
    Vector3<FourLanes> raw, raw_low;
    read_bonds<last>(box, r + 3 * k, n - k, raw, raw_low);
    const FourLanes s = reciprocal_scale(max(max(abs(raw.x), abs(raw.y)), abs(raw.z)));
    const Vector3<FourLanes> d = s * raw, low = s * raw_low;
    const FourLanes q = square_of(d, low), one_over = FourLanes{four{} + 1.0} / FourLanes{_mm256_sqrt_pd(q.v)};
    put(to.d, i, d);
    put(to.low, i, low);
    store_any(to.r + i, one_over);  // what needs it comes later: a scheduler is full of what waits for quotients
    store_any(&x.square[k].element, q);
    store_any(&x.scale[k].element, s);
}

// The joints before bonds k .. k + 3, which stand at place i of the stage. turns: for forces, too.
template <bool uniform, bool turns, class Geometry>
HOL_INLINE void measure_joints(const MeasuredBonds &of, long i, const vec *w, long k, const Geometry &x) {
    const FourLanes one = {four{} + 1.0}, r = load_any<FourLanes>(of.r + i), f = load_any<FourLanes>(of.r + i - 1) * r;
    const Vector3<FourLanes> d0 = get(of.d, i - 1), low0 = get(of.low, i - 1), d = get(of.d, i), low = get(of.low, i);
    const FourLanes c = dot_compensated(d0, low0, d, low) * f;
    const Vector3<FourLanes> n = f * cross_compensated(d0, low0, d, low);
    const FourLanes size = abs(c), near = one - size, far = dot(n, n) / (one + size);
    FourLanes side = {_mm256_blendv_pd(far.v, near.v, _mm256_cmp_pd(size.v, four{} + 0.5, _CMP_LT_OQ))}, p = size;
    if (!uniform) {
        const FourLanes of_atom = {load_four(w + k)};
        p = of_atom * p;
        side = of_atom * side;
    }
    store_any(&x.p[k].element, p);
    store_any(&x.side[k].element, side);
    store_any(&x.reciprocal[k].element, r.v * load_four(x.scale + k));
    if (!turns) return;
    store_any(&x.cosine[k].element, c);
    write_vectors(&x.u[k].x.element, r * d);
    write_vectors(&x.normal[k].x.element, n);
}

// All bonds and joints of n.
template <bool uniform, bool turns, class Geometry>
HOL_NOINLINE void measure_in_fours(const Box &box, const double *r, const vec *w, long n, const Geometry x) {
    MeasuredBonds bonds;
    for (int c = 0; c < 3; ++c) {  // stands before the first one
        bonds.d[c][3] = 1;
        bonds.low[c][3] = 0;
    }
    bonds.r[3] = 1;
    for (long first = 0; first < n; first += MeasuredBonds::most) {
        const long count = first + MeasuredBonds::most < n ? MeasuredBonds::most : n - first;
        long i = 0;
        for (; i + 4 <= count; i += 4) measure_bonds<false>(box, r, first + i, n, x, bonds, i + 4);
        if (i < count) measure_bonds<true>(box, r, first + i, n, x, bonds, i + 4);
        for (i = 0; i < count; i += 4) measure_joints<uniform, turns>(bonds, i + 4, w, first + i, x);
        for (int c = 0; c < 3; ++c) {
            bonds.d[c][3] = bonds.d[c][count + 3];
            bonds.low[c][3] = bonds.low[c][count + 3];
        }
        bonds.r[3] = bonds.r[count + 3];
    }
}

// The deficits of four bonds, or of the joints before them.
struct DeficitsOfFour {
    four A, F;
};

// weigh_normal() and turn() in deficits.hpp of bonds k .. k + 3, and of the joints before them, from the deficits on
// either side. `behind`: the joint behind them, weighed; then these.
template <bool uniform, class Geometry>
HOL_INLINE void turn_in_fours(const vec *w, long k, double kT, const Geometry &x, DeficitsOfFour left,
                              DeficitsOfFour right, Vector3<FourLanes> &behind) {
    const four one = four{} + 1.0, zero = {}, sign = _mm256_set1_pd(-0.0);
    four p = load_four(x.p + k), A = left.A, B = right.A, of_atom = one;
    const four coupled = _mm256_cmp_pd(zero, p, _CMP_LT_OQ);
    if (!uniform) {
        of_atom = load_four(w + k);
        const four s = reciprocal_scale(max(max(FourLanes{A}, FourLanes{B}), FourLanes{of_atom})).v;
        p = s * p;
        A = s * A;
        B = s * B;
        of_atom = s * of_atom;
    }
    const four pF = p * left.F, pG = p * right.F;
    const four whole = mul_add(pG, A, mul_add(pF, B, A * B));
    const four size = of_atom * (pF * right.F) / _mm256_blendv_pd(one, whole, coupled);
    const FourLanes h = {_mm256_and_pd(coupled, _mm256_or_pd(size, _mm256_and_pd(load_four(x.cosine + k), sign)))};
    const Vector3<FourLanes> a = h * read_vectors(&x.normal[k].x.element);
    const auto next = [](FourLanes here, FourLanes after) HOL_FORCED {
        return FourLanes{_mm256_shuffle_pd(here.v, _mm256_permute2f128_pd(here.v, after.v, 0x21), 5)};
    };
    const Vector3<FourLanes> b = {next(a.x, behind.x), next(a.y, behind.y), next(a.z, behind.z)};
    const Vector3<FourLanes> v = cross(read_vectors(&x.u[k].x.element), b - a);
    write_vectors(&x.u[k].x.element, {v.x + FourLanes{zero}, v.y + FourLanes{zero}, v.z + FourLanes{zero}});
    store_any(&x.t[k].element, kT * load_four(x.reciprocal + k));
    behind = a;
}

}  // namespace holonomic::HOL_ISA
#endif
