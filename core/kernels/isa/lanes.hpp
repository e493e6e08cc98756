// Lanes: W doubles that are worked on at once, with one chain, or one part of a chain, in each. First what the
// compiler can do with a vector of them whatever the instruction set is, then transposition, then what each set has of
// its own.
#pragma once

#include "core/kernels/isa/target.hpp"

#if defined(__AVX__)
#pragma GCC diagnostic push  // some versions of this header use _mm512_undefined_pd() in a way that gcc warns about
#pragma GCC diagnostic ignored "-Wuninitialized"
#ifndef __clang__
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif
#include <immintrin.h>
#pragma GCC diagnostic pop
#elif defined(__x86_64__) || defined(__i386__)
#include <emmintrin.h>  // a tenth of what all of them take to compile
#elif defined(__aarch64__)
#include <arm_neon.h>
#endif

// One lane is a double in a register. The compiler's own vector of one would go through memory.
#if HOL_LANES == 1
namespace holonomic::HOL_ISA {

struct mask {
    long long element;
    HOL_FORCED long long &operator[](int) { return element; }
    HOL_FORCED const long long &operator[](int) const { return element; }
};

struct vec {
    double element;
    HOL_FORCED double &operator[](long) { return element; }
    HOL_FORCED const double &operator[](long) const { return element; }
};
typedef vec vec_unaligned;

HOL_INLINE vec operator+(vec a, vec b) { return {a.element + b.element}; }
HOL_INLINE vec operator-(vec a, vec b) { return {a.element - b.element}; }
HOL_INLINE vec operator*(vec a, vec b) { return {a.element * b.element}; }
HOL_INLINE vec operator/(vec a, vec b) { return {a.element / b.element}; }
HOL_INLINE vec operator-(vec a) { return {-a.element}; }
HOL_INLINE vec operator+(vec a, double b) { return {a.element + b}; }
HOL_INLINE vec operator-(vec a, double b) { return {a.element - b}; }
HOL_INLINE vec operator*(vec a, double b) { return {a.element * b}; }
HOL_INLINE vec operator/(vec a, double b) { return {a.element / b}; }
HOL_INLINE vec operator+(double a, vec b) { return {a + b.element}; }
HOL_INLINE vec operator-(double a, vec b) { return {a - b.element}; }
HOL_INLINE vec operator*(double a, vec b) { return {a * b.element}; }
HOL_INLINE vec operator/(double a, vec b) { return {a / b.element}; }

HOL_INLINE mask operator~(mask a) { return {~a.element}; }
HOL_INLINE mask operator&(mask a, mask b) { return {a.element & b.element}; }
HOL_INLINE mask operator|(mask a, mask b) { return {a.element | b.element}; }
HOL_INLINE mask operator^(mask a, mask b) { return {a.element ^ b.element}; }
HOL_INLINE mask operator+(mask a, mask b) { return {a.element + b.element}; }
HOL_INLINE mask operator-(mask a, mask b) { return {a.element - b.element}; }
HOL_INLINE mask operator+(mask a, long long b) { return {a.element + b}; }
HOL_INLINE mask operator-(mask a, long long b) { return {a.element - b}; }
HOL_INLINE mask operator*(long long a, mask b) { return {a * b.element}; }
HOL_INLINE mask operator>>(mask a, int b) { return {a.element >> b}; }

HOL_INLINE mask as_mask(vec a) {
    mask m;
    __builtin_memcpy(&m, &a, sizeof m);
    return m;
}
HOL_INLINE vec as_vec(mask m) {
    vec a;
    __builtin_memcpy(&a, &m, sizeof a);
    return a;
}
HOL_INLINE mask less(vec a, vec b) { return {a.element < b.element ? -1 : 0}; }
HOL_INLINE mask less_equal(vec a, vec b) { return {a.element <= b.element ? -1 : 0}; }
HOL_INLINE mask equal(vec a, vec b) { return {a.element == b.element ? -1 : 0}; }
// Of doubles, so that nothing leaves the registers of floating point.
HOL_INLINE vec select(mask m, vec a, vec b) { return {m.element ? a.element : b.element}; }
HOL_INLINE vec keep(mask m, vec a) { return {m.element ? a.element : 0.0}; }
HOL_INLINE vec max(vec a, vec b) { return {a.element > b.element ? a.element : b.element}; }
HOL_INLINE vec min(vec a, vec b) { return {a.element < b.element ? a.element : b.element}; }
HOL_INLINE vec abs(vec a) { return {__builtin_fabs(a.element)}; }
HOL_INLINE vec sqrt(vec a) { return {__builtin_sqrt(a.element)}; }

}  // namespace holonomic::HOL_ISA
#endif

// Two lanes by the instructions of 64-bit Arm.
#if HOL_LANES == 2 && defined(__aarch64__)
#define HOL_NEON 1
#else
#define HOL_NEON 0
#endif

namespace holonomic::HOL_ISA {

constexpr int W = HOL_LANES;
constexpr bool small_set = HOL_SMALL;
// There are sixteen registers for vectors, not thirty-two.
#if defined(__AVX512VL__) || defined(__aarch64__)
constexpr bool few_registers = false;
#else
constexpr bool few_registers = true;
#endif

// mask: all bits of a lane set, or none.
#if HOL_LANES > 1
typedef double vec __attribute__((vector_size(HOL_LANES * 8)));
typedef long long mask __attribute__((vector_size(HOL_LANES * 8)));
typedef double vec_unaligned __attribute__((vector_size(HOL_LANES * 8), aligned(8), may_alias));

HOL_INLINE mask as_mask(vec a) { return reinterpret_cast<mask>(a); }
HOL_INLINE vec as_vec(mask a) { return reinterpret_cast<vec>(a); }
HOL_INLINE mask less(vec a, vec b) { return reinterpret_cast<mask>(a < b); }
HOL_INLINE mask less_equal(vec a, vec b) { return reinterpret_cast<mask>(a <= b); }
HOL_INLINE mask equal(vec a, vec b) { return reinterpret_cast<mask>(a == b); }
#if HOL_NEON
HOL_INLINE vec select(mask m, vec a, vec b) { return vbslq_f64(reinterpret_cast<uint64x2_t>(m), a, b); }
#else
HOL_INLINE vec select(mask m, vec a, vec b) { return as_vec((m & as_mask(a)) | (~m & as_mask(b))); }
#endif
HOL_INLINE vec keep(mask m, vec a) { return as_vec(m & as_mask(a)); }  // a where m, else zero
HOL_INLINE vec abs(vec a) { return as_vec(as_mask(a) & (mask{} + 0x7fffffffffffffffLL)); }
#endif

HOL_INLINE vec load(const double *p) { return *reinterpret_cast<const vec_unaligned *>(p); }
HOL_INLINE void store(double *p, vec a) { *reinterpret_cast<vec_unaligned *>(p) = a; }
HOL_INLINE vec splat(double a) { return a - vec{}; }
HOL_INLINE double abs(double a) { return __builtin_fabs(a); }

// To the nearest integer by adding and subtracting 1.5 * 2^52: right for |a| < 2^51, which is all that a box needs.
HOL_INLINE double round(double a) {
    const double big = 6755399441055744.0, sum = a + big;
    return sum - big;
}

// a * b + c: in one rounding where the instruction set has it, in two elsewhere.
HOL_INLINE double mul_add(double a, double b, double c) {
#if HOL_HAS_FMA
    return __builtin_fma(a, b, c);
#else
    return a * b + c;
#endif
}

#if HOL_LANES == 2
typedef vec double2;
#else
typedef double double2 __attribute__((vector_size(16)));
HOL_INLINE double2 mul_add(double2 a, double2 b, double2 c) {
#if HOL_HAS_FMA && defined(__x86_64__)
    return _mm_fmadd_pd(a, b, c);
#else
    return double2{mul_add(a[0], b[0], c[0]), mul_add(a[1], b[1], c[1])};
#endif
}
#endif

// Vectors of any width, or a double, from and to memory.
template <class V>
HOL_INLINE V load_any(const double *p) {
    V a;
    __builtin_memcpy(&a, p, sizeof a);
    return a;
}
template <class V>
HOL_INLINE void store_any(double *p, V a) {
    __builtin_memcpy(p, &a, sizeof a);
}

// Turns W vectors of W elements, or four of four, into their transpose.
#if HOL_LANES >= 4 && defined(__AVX2__)
typedef double quad __attribute__((vector_size(32)));  // four lanes: all of vec, or a part of it

HOL_INLINE void transpose(quad *m) {
    const quad a = _mm256_unpacklo_pd(m[0], m[1]), b = _mm256_unpackhi_pd(m[0], m[1]);
    const quad c = _mm256_unpacklo_pd(m[2], m[3]), d = _mm256_unpackhi_pd(m[2], m[3]);
    m[0] = _mm256_permute2f128_pd(a, c, 0x20);
    m[1] = _mm256_permute2f128_pd(b, d, 0x20);
    m[2] = _mm256_permute2f128_pd(a, c, 0x31);
    m[3] = _mm256_permute2f128_pd(b, d, 0x31);
}
#endif
#if HOL_NEON
HOL_INLINE void transpose(vec *m) {
    const vec a = vzip1q_f64(m[0], m[1]), b = vzip2q_f64(m[0], m[1]);
    m[0] = a;
    m[1] = b;
}
#elif HOL_LANES != 4 || !defined(__AVX2__)
HOL_INLINE void transpose(vec *m) {
    for (int i = 0; i < W; ++i)
        for (int j = i + 1; j < W; ++j) {
            const double t = m[i][j];
            m[i][j] = m[j][i];
            m[j][i] = t;
        }
}
#endif

// Four lanes by AVX2 and FMA.
#if HOL_LANES == 4 && defined(__AVX2__) && defined(__FMA__)
HOL_INLINE vec mul_add(vec a, vec b, vec c) { return _mm256_fmadd_pd(a, b, c); }
HOL_INLINE vec mul_sub(vec a, vec b, vec c) { return _mm256_fmsub_pd(a, b, c); }
HOL_INLINE vec sub_mul(vec a, vec b, vec c) { return _mm256_fnmadd_pd(a, b, c); }
HOL_INLINE vec max(vec a, vec b) { return _mm256_max_pd(a, b); }
HOL_INLINE vec min(vec a, vec b) { return _mm256_min_pd(a, b); }
HOL_INLINE vec sqrt(vec a) { return _mm256_sqrt_pd(a); }
HOL_INLINE vec round(vec a) { return _mm256_round_pd(a, _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC); }
HOL_INLINE unsigned bits(mask m) { return static_cast<unsigned>(_mm256_movemask_pd(as_vec(m))); }
#elif HOL_NEON
HOL_INLINE vec mul_add(vec a, vec b, vec c) { return vfmaq_f64(c, a, b); }
HOL_INLINE vec mul_sub(vec a, vec b, vec c) { return vfmaq_f64(-c, a, b); }
HOL_INLINE vec sub_mul(vec a, vec b, vec c) { return vfmsq_f64(c, a, b); }
HOL_INLINE vec max(vec a, vec b) { return select(less(b, a), a, b); }  // b where one is NaN, which vmaxq_f64() has not
HOL_INLINE vec min(vec a, vec b) { return select(less(a, b), a, b); }
HOL_INLINE vec sqrt(vec a) { return vsqrtq_f64(a); }
HOL_INLINE vec round(vec a) { return vrndnq_f64(a); }
HOL_INLINE unsigned long long sign_words(mask m) {  // the upper halves of the lanes
    return vget_lane_u64(vreinterpret_u64_u32(vshrn_n_u64(reinterpret_cast<uint64x2_t>(m), 32)), 0);
}
HOL_INLINE unsigned bits(mask m) {
    const unsigned long long signs = sign_words(m);
    return static_cast<unsigned>((signs >> 31 & 1) | (signs >> 62 & 2));
}
#else
// Any number of lanes on any processor: what the compiler makes of the vectors.

// One rounding or two, as for a double: results of a set must not depend on where a bond is worked on.
HOL_INLINE vec mul_add(vec a, vec b, vec c) {
#if HOL_LANES % 4 == 0 && defined(__AVX2__) && HOL_HAS_FMA  // in pieces: element by element takes minutes to compile
    vec r{};
    for (int i = 0; i < W / 4; ++i)
        reinterpret_cast<__m256d *>(&r)[i] =
            _mm256_fmadd_pd(reinterpret_cast<const __m256d *>(&a)[i], reinterpret_cast<const __m256d *>(&b)[i],
                            reinterpret_cast<const __m256d *>(&c)[i]);
    return r;
#elif HOL_HAS_FMA
    vec r{};
    HOL_UNROLL
    for (int i = 0; i < W; ++i) r[i] = __builtin_fma(a[i], b[i], c[i]);
    return r;
#else
    return a * b + c;
#endif
}
HOL_INLINE vec mul_sub(vec a, vec b, vec c) { return mul_add(a, b, -c); }
HOL_INLINE vec sub_mul(vec a, vec b, vec c) { return mul_add(-a, b, c); }  // c - a b
#if HOL_LANES > 1
HOL_INLINE vec max(vec a, vec b) { return select(less(b, a), a, b); }
HOL_INLINE vec min(vec a, vec b) { return select(less(a, b), a, b); }
HOL_INLINE vec sqrt(vec a) {
    vec s = {};
    for (int i = 0; i < W; ++i) s[i] = __builtin_sqrt(a[i]);
    return s;
}
#endif
#if HOL_LANES == 1 && defined(__SSE4_1__)
HOL_INLINE vec round(vec a) {
    const __m128d x = _mm_set_sd(a[0]);
    return {_mm_cvtsd_f64(_mm_round_sd(x, x, _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC))};
}
#else
HOL_INLINE vec round(vec a) {  // as of a double
    const vec big = splat(6755399441055744.0);
    const vec sum = a + big;
    return sum - big;
}
#endif
#if HOL_LANES == 2 && defined(__SSE2__)
HOL_INLINE unsigned bits(mask m) { return static_cast<unsigned>(_mm_movemask_pd(as_vec(m))); }
#else
HOL_INLINE unsigned bits(mask m) {
    unsigned b = 0;
    for (int i = 0; i < W; ++i) b |= (m[i] < 0 ? 1u : 0u) << i;
    return b;
}
#endif
#endif

// One lane on a processor that has four: what needs no order is done for four numbers at once (memory/fours.hpp).
#if HOL_LANES == 1 && defined(__AVX2__) && defined(__FMA__)
#define HOL_FOURS 1
typedef double four __attribute__((vector_size(32)));
HOL_INLINE four mul_add(four a, four b, four c) { return _mm256_fmadd_pd(a, b, c); }
HOL_INLINE four round(four a) { return _mm256_round_pd(a, _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC); }
#else
#define HOL_FOURS 0
#endif

// The sign bits of a mask tell.
#if HOL_NEON
HOL_INLINE bool any(mask m) { return (sign_words(m) & 0x8000000080000000ULL) != 0; }
#else
HOL_INLINE bool any(mask m) { return bits(m) != 0; }
#endif
HOL_INLINE mask finite(vec a) { return equal(a - a, vec{}); }
HOL_INLINE mask none() { return mask{}; }
HOL_INLINE mask all_if(bool which) { return mask{} - (which ? 1 : 0); }
HOL_INLINE mask first_lanes(int n) {
    mask m{};
    for (int i = 0; i < W; ++i) m[i] = i < n ? -1 : 0;
    return m;
}
HOL_INLINE double sum_lanes(vec a) {  // in the order of the lanes
    double s = a[0];
    for (int i = 1; i < W; ++i) s += a[i];
    return s;
}

constexpr unsigned all_lanes = (1u << W) - 1;  // bits() of a mask with all lanes set

}  // namespace holonomic::HOL_ISA
