// Two blocks of W molecules side by side, as if there were 2 W lanes. While one waits for a quotient, or for the end of
// a chain of products, the processor works on the other.
#pragma once

#include "core/kernels/molecules/atoms/consecutive.hpp"

namespace holonomic::HOL_ISA {

// True if twins pay: the bits of their masks fit, and there is more than one lane.
constexpr bool twins = W > 1 && W <= 8 && !small_set;

#if HOL_LANES == 4 && defined(__AVX512F__) && defined(__AVX512DQ__)
// In one register of AVX-512, of which there are as many as of half the size.
struct Twin {
    __m512d x;
    Twin() = default;
    HOL_FORCED Twin(__m512d value) : x(value) {}
    HOL_FORCED Twin(const Twin &y) : x(y.x) {}
    HOL_FORCED Twin &operator=(const Twin &y) {
        x = y.x;
        return *this;
    }
};
struct TwinMask {
    __mmask8 m;
};

HOL_INLINE Twin operator+(const Twin &a, const Twin &b) { return {a.x + b.x}; }
HOL_INLINE Twin operator-(const Twin &a, const Twin &b) { return {a.x - b.x}; }
HOL_INLINE Twin operator*(const Twin &a, const Twin &b) { return {a.x * b.x}; }
HOL_INLINE Twin operator/(const Twin &a, const Twin &b) { return {a.x / b.x}; }
HOL_INLINE Twin operator-(const Twin &a) { return {-a.x}; }
HOL_INLINE Twin operator+(const Twin &a, double b) { return {a.x + b}; }
HOL_INLINE Twin operator-(const Twin &a, double b) { return {a.x - b}; }
HOL_INLINE Twin operator-(double a, const Twin &b) { return {a - b.x}; }
HOL_INLINE Twin operator*(const Twin &a, double b) { return {a.x * b}; }
HOL_INLINE Twin operator*(double a, const Twin &b) { return {a * b.x}; }
HOL_INLINE Twin mul_add(const Twin &a, const Twin &b, const Twin &c) { return {_mm512_fmadd_pd(a.x, b.x, c.x)}; }
HOL_INLINE Twin max(const Twin &a, const Twin &b) { return {_mm512_max_pd(a.x, b.x)}; }
HOL_INLINE Twin min(const Twin &a, const Twin &b) { return {_mm512_min_pd(a.x, b.x)}; }
HOL_INLINE Twin abs(const Twin &a) { return {_mm512_abs_pd(a.x)}; }
HOL_INLINE Twin sqrt(const Twin &a) { return {_mm512_sqrt_pd(a.x)}; }
HOL_INLINE Twin round(const Twin &a) {
    return {_mm512_roundscale_pd(a.x, _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC)};
}

HOL_INLINE TwinMask twin_mask(unsigned b) { return {static_cast<__mmask8>(b)}; }
HOL_INLINE TwinMask first_of_twin(int n) { return twin_mask((1u << n) - 1); }
HOL_INLINE unsigned bits(const TwinMask &a) { return a.m; }
HOL_INLINE bool any(const TwinMask &a) { return a.m != 0; }
HOL_INLINE TwinMask operator&(const TwinMask &a, const TwinMask &b) { return {_kand_mask8(a.m, b.m)}; }
HOL_INLINE TwinMask operator|(const TwinMask &a, const TwinMask &b) { return {_kor_mask8(a.m, b.m)}; }
HOL_INLINE TwinMask operator~(const TwinMask &a) { return {_knot_mask8(a.m)}; }
HOL_INLINE TwinMask less(const Twin &a, const Twin &b) { return {_mm512_cmp_pd_mask(a.x, b.x, _CMP_LT_OS)}; }
HOL_INLINE TwinMask less_equal(const Twin &a, const Twin &b) { return {_mm512_cmp_pd_mask(a.x, b.x, _CMP_LE_OS)}; }
HOL_INLINE TwinMask finite(const Twin &a) { return {_mm512_cmp_pd_mask(a.x - a.x, _mm512_setzero_pd(), _CMP_EQ_OQ)}; }
HOL_INLINE Twin select(const TwinMask &m, const Twin &a, const Twin &b) {
    return {_mm512_mask_blend_pd(m.m, b.x, a.x)};
}
HOL_INLINE Twin keep(const TwinMask &m, const Twin &a) { return {_mm512_maskz_mov_pd(m.m, a.x)}; }

HOL_INLINE Twin twin(vec a, vec b) { return {_mm512_insertf64x4(_mm512_castpd256_pd512(a), b, 1)}; }
HOL_INLINE vec first_half(const Twin &a) { return _mm512_castpd512_pd256(a.x); }
HOL_INLINE vec second_half(const Twin &a) { return _mm512_extractf64x4_pd(a.x, 1); }
HOL_INLINE Twin splat_twin(double a) { return {_mm512_set1_pd(a)}; }
HOL_INLINE double get(const Twin &a, int i) { return a.x[i]; }
HOL_INLINE void set(Twin &a, int i, double b) { a.x[i] = b; }
#else
// Copied register by register. As a copy of memory gcc 12 makes it of halves of these, and what reads them must wait.
template <class T>
struct SideBySide {
    T a, b;
    SideBySide() = default;
    HOL_FORCED SideBySide(T first, T second) : a(first), b(second) {}
    HOL_FORCED SideBySide(const SideBySide &x) : a(x.a), b(x.b) {}
    HOL_FORCED SideBySide &operator=(const SideBySide &x) {
        a = x.a;
        b = x.b;
        return *this;
    }
};
typedef SideBySide<vec> Twin;
typedef SideBySide<mask> TwinMask;

HOL_INLINE Twin operator+(const Twin &x, const Twin &y) { return {x.a + y.a, x.b + y.b}; }
HOL_INLINE Twin operator-(const Twin &x, const Twin &y) { return {x.a - y.a, x.b - y.b}; }
HOL_INLINE Twin operator*(const Twin &x, const Twin &y) { return {x.a * y.a, x.b * y.b}; }
HOL_INLINE Twin operator/(const Twin &x, const Twin &y) { return {x.a / y.a, x.b / y.b}; }
HOL_INLINE Twin operator-(const Twin &x) { return {-x.a, -x.b}; }
HOL_INLINE Twin operator+(const Twin &x, double y) { return {x.a + y, x.b + y}; }
HOL_INLINE Twin operator-(const Twin &x, double y) { return {x.a - y, x.b - y}; }
HOL_INLINE Twin operator-(double x, const Twin &y) { return {x - y.a, x - y.b}; }
HOL_INLINE Twin operator*(const Twin &x, double y) { return {x.a * y, x.b * y}; }
HOL_INLINE Twin operator*(double x, const Twin &y) { return {x * y.a, x * y.b}; }
HOL_INLINE Twin mul_add(const Twin &x, const Twin &y, const Twin &z) {
    return {mul_add(x.a, y.a, z.a), mul_add(x.b, y.b, z.b)};
}
HOL_INLINE Twin max(const Twin &x, const Twin &y) { return {max(x.a, y.a), max(x.b, y.b)}; }
HOL_INLINE Twin min(const Twin &x, const Twin &y) { return {min(x.a, y.a), min(x.b, y.b)}; }
HOL_INLINE Twin abs(const Twin &x) { return {abs(x.a), abs(x.b)}; }
HOL_INLINE Twin sqrt(const Twin &x) { return {sqrt(x.a), sqrt(x.b)}; }
HOL_INLINE Twin round(const Twin &x) { return {round(x.a), round(x.b)}; }

HOL_INLINE TwinMask operator&(const TwinMask &x, const TwinMask &y) { return {x.a & y.a, x.b & y.b}; }
HOL_INLINE TwinMask operator|(const TwinMask &x, const TwinMask &y) { return {x.a | y.a, x.b | y.b}; }
HOL_INLINE TwinMask operator~(const TwinMask &x) { return {~x.a, ~x.b}; }
HOL_INLINE bool any(const TwinMask &x) { return any(x.a | x.b); }
HOL_INLINE unsigned bits(const TwinMask &x) { return bits(x.a) | bits(x.b) << W; }
HOL_INLINE TwinMask less(const Twin &x, const Twin &y) { return {less(x.a, y.a), less(x.b, y.b)}; }
HOL_INLINE TwinMask less_equal(const Twin &x, const Twin &y) { return {less_equal(x.a, y.a), less_equal(x.b, y.b)}; }
HOL_INLINE TwinMask finite(const Twin &x) { return {finite(x.a), finite(x.b)}; }
HOL_INLINE Twin select(const TwinMask &m, const Twin &x, const Twin &y) {
    return {select(m.a, x.a, y.a), select(m.b, x.b, y.b)};
}
HOL_INLINE Twin keep(const TwinMask &m, const Twin &x) { return {keep(m.a, x.a), keep(m.b, x.b)}; }

HOL_INLINE Twin twin(vec a, vec b) { return {a, b}; }
HOL_INLINE vec first_half(const Twin &x) { return x.a; }
HOL_INLINE vec second_half(const Twin &x) { return x.b; }
HOL_INLINE Twin splat_twin(double x) { return {splat(x), splat(x)}; }
HOL_INLINE TwinMask twin_mask(unsigned b) { return {Width<vec>::of_bits(b), Width<vec>::of_bits(b >> W)}; }
HOL_INLINE TwinMask first_of_twin(int n) { return {first_lanes(n), first_lanes(n - W)}; }
HOL_INLINE double get(const Twin &x, int i) { return i < W ? x.a[i % W] : x.b[i % W]; }
HOL_INLINE void set(Twin &x, int i, double y) {
    if (i < W)
        x.a[i] = y;
    else
        x.b[i - W] = y;  // not through a reference to either: gcc 12 loses elements then
}
#endif

template <>
struct Width<Twin> {
    typedef TwinMask Mask;
    static constexpr int lanes = 2 * W;
    HOL_STATIC Twin all(double x) { return splat_twin(x); }
    HOL_STATIC TwinMask none() { return twin_mask(0); }
    HOL_STATIC TwinMask first(int n) { return first_of_twin(n); }
    HOL_STATIC TwinMask of_bits(unsigned b) { return twin_mask(b); }
    HOL_STATIC double get(const Twin &x, int i) { return HOL_ISA::get(x, i); }
    HOL_STATIC void set(Twin &x, int i, double y) { HOL_ISA::set(x, i, y); }
};

// Found by their argument from where single blocks are read and written.
HOL_INLINE Vector3<Twin> side_by_side(const vec3 &a, const vec3 &b) {
    return {twin(a.x, b.x), twin(a.y, b.y), twin(a.z, b.z)};
}
HOL_INLINE vec3 first_half(const Vector3<Twin> &a) { return {first_half(a.x), first_half(a.y), first_half(a.z)}; }
HOL_INLINE vec3 second_half(const Vector3<Twin> &a) { return {second_half(a.x), second_half(a.y), second_half(a.z)}; }

HOL_INLINE void read_rows(const double *const *p, Vector3<Twin> &x) {
    vec3 a = {}, b = {};
    read_rows(p, a);
    read_rows(p + W, b);
    x = side_by_side(a, b);
}
HOL_INLINE void write_rows(double *const *p, const Vector3<Twin> &x) {
    write_rows(p, first_half(x));
    write_rows(p + W, second_half(x));
}
template <int n>
HOL_INLINE void read_elements(const double *const *p, Vector3<Twin> *x) {
    vec3 a[n / 3] = {}, b[n / 3] = {};
    graph::read_elements<n>(p, a);
    graph::read_elements<n>(p + W, b);
    HOL_UNROLL
    for (int k = 0; k < n / 3; ++k) x[k] = side_by_side(a[k], b[k]);
}
template <int count>
HOL_INLINE void halves(const Vector3<Twin> *x, vec3 *a, vec3 *b) {
    HOL_UNROLL
    for (int k = 0; k < count; ++k) {
        a[k] = first_half(x[k]);
        b[k] = second_half(x[k]);
    }
}
template <int n>
HOL_INLINE void write_elements(double *const *p, Vector3<Twin> *x) {
    vec3 a[n / 3] = {}, b[n / 3] = {};
    halves<n / 3>(x, a, b);
    graph::write_elements<n>(p, a);
    graph::write_elements<n>(p + W, b);
}
template <int n>
HOL_INLINE void add_elements(double *const *r, double *const *v, double factor, Vector3<Twin> *x) {
    vec3 a[n / 3] = {}, b[n / 3] = {};
    halves<n / 3>(x, a, b);
    graph::add_elements<n>(r, v, factor, a);
    graph::add_elements<n>(r + W, v ? v + W : nullptr, factor, b);
}

template <int n>
HOL_INLINE void read_columns(const Columns &from, int64_t first, Vector3<Twin> *x) {
    vec3 a[n], b[n];
    HOL_ISA::read_columns<n>(from, first, a);
    HOL_ISA::read_columns<n>(from, first + W * n, b);
    HOL_UNROLL
    for (int k = 0; k < n; ++k) x[k] = side_by_side(a[k], b[k]);
}
template <int n>
HOL_INLINE void write_columns(const Columns &to, int64_t first, const Vector3<Twin> *x) {
    vec3 a[n] = {}, b[n] = {};
    halves<n>(x, a, b);
    HOL_ISA::write_columns<n>(to, first, a);
    HOL_ISA::write_columns<n>(to, first + W * n, b);
}

}  // namespace holonomic::HOL_ISA
