// A vector of W doubles, and what the compiler can do with it whatever the instruction set is.
#ifndef HOLONOMIC_KERNELS_ISA_VECTOR_HPP
#define HOLONOMIC_KERNELS_ISA_VECTOR_HPP

#include "core/kernels/isa/target.hpp"

#if defined(__x86_64__) || defined(__i386__)
#pragma GCC diagnostic push  // some versions of this header use _mm512_undefined_pd() in a way that gcc warns about
#pragma GCC diagnostic ignored "-Wuninitialized"
#ifndef __clang__
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif
#include <immintrin.h>
#pragma GCC diagnostic pop
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

namespace holonomic::HOL_ISA {

constexpr int W = HOL_LANES;

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
HOL_INLINE vec select(mask m, vec a, vec b) { return as_vec((m & as_mask(a)) | (~m & as_mask(b))); }
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

}  // namespace holonomic::HOL_ISA
#endif
