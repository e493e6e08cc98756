// Numbers of twice the precision, hi + lo, for what is solved once and must not lose digits; or of four times the
// precision in the set of kernels `quad_double`, which does what twice is not enough for (verbs.hpp).
#pragma once

#include "core/kernels/arithmetic/exact.hpp"
#ifdef HOL_QUAD_DOUBLE
#include "core/kernels/extended/quad_double.hpp"
#endif

namespace holonomic::HOL_ISA {

#ifdef HOL_QUAD_DOUBLE

typedef QuadDouble Wide;
HOL_INLINE Wide wide(double a) { return as_quad_double(a); }

#else

typedef Pair<double> Wide;
HOL_INLINE Wide wide(double a) { return {a, 0}; }
// What its first word leaves of a number.
HOL_INLINE double beyond_first(const Wide &a) { return a.lo; }
HOL_INLINE Wide over(const Wide &a, double power_of_two) { return {a.hi / power_of_two, a.lo / power_of_two}; }
HOL_INLINE double rounded(const Wide &a) { return a.hi + a.lo; }
HOL_INLINE Wide operator-(const Wide &a) { return {-a.hi, -a.lo}; }

HOL_INLINE Wide operator+(const Wide &a, const Wide &b) {
    const Wide s = two_sum(a.hi, b.hi), t = two_sum(a.lo, b.lo);
    const Wide u = fast_two_sum(s.hi, s.lo + t.hi);
    return fast_two_sum(u.hi, u.lo + t.lo);
}

HOL_INLINE Wide operator-(const Wide &a, const Wide &b) { return a + -b; }

HOL_INLINE Wide operator*(const Wide &a, const Wide &b) {
    const Wide p = two_product(a.hi, b.hi);
    return fast_two_sum(p.hi, p.lo + (a.hi * b.lo + a.lo * b.hi));
}

HOL_INLINE Wide operator*(double a, const Wide &b) {
    const Wide p = two_product(a, b.hi);
    return fast_two_sum(p.hi, mul_add(a, b.lo, p.lo));
}

HOL_NOINLINE Wide operator/(const Wide &a, const Wide &b) {
    const double q1 = a.hi / b.hi;
    const Wide r1 = a - q1 * b;
    const double q2 = r1.hi / b.hi;
    const Wide r2 = r1 - q2 * b;
    return fast_two_sum(q1, q2) + wide(r2.hi / b.hi);
}

HOL_INLINE Wide abs(const Wide &a) { return a.hi < 0 ? -a : a; }
HOL_INLINE bool less(const Wide &a, const Wide &b) { return a.hi < b.hi || (a.hi == b.hi && a.lo < b.lo); }

HOL_NOINLINE Wide square_root(const Wide &a) {  // a > 0
    const double s = __builtin_sqrt(a.hi);
    const Wide rest = a - two_product(s, s);
    return fast_two_sum(s, rest.hi / (2 * s));
}

#endif

typedef Vector3<Wide> Wide3;

HOL_INLINE Wide &operator+=(Wide &a, const Wide &b) { return a = a + b; }
HOL_INLINE Wide &operator-=(Wide &a, const Wide &b) { return a = a - b; }

HOL_INLINE Wide3 operator-(const Wide3 &a) { return {-a.x, -a.y, -a.z}; }
HOL_INLINE Wide3 operator+(const Wide3 &a, const Wide3 &b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
HOL_INLINE Wide3 operator-(const Wide3 &a, const Wide3 &b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
HOL_INLINE Wide3 operator*(double s, const Wide3 &a) { return {s * a.x, s * a.y, s * a.z}; }
HOL_INLINE Wide3 operator*(const Wide &s, const Wide3 &a) { return {s * a.x, s * a.y, s * a.z}; }

HOL_INLINE Vector3<double> rounded(const Wide3 &a) { return {rounded(a.x), rounded(a.y), rounded(a.z)}; }

HOL_NOINLINE Wide dot(const Wide3 &a, const Wide3 &b) { return a.x * b.x + (a.y * b.y + a.z * b.z); }

HOL_NOINLINE Wide3 cross(const Wide3 &a, const Wide3 &b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

}  // namespace holonomic::HOL_ISA
