// One lane: what a vector of one double is. The compiler's own would go through memory; this one is a double in a
// register.
#ifndef HOLONOMIC_KERNELS_ISA_ONE_LANE_HPP
#define HOLONOMIC_KERNELS_ISA_ONE_LANE_HPP

#include "core/kernels/isa/target.hpp"

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
#endif
