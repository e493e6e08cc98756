// Numbers of four times the precision: unevaluated sums of four doubles, for molecules that twice the precision can't
// answer for. They are rare, so this is short rather than fast: all terms of a sum or product are added up, with the
// rounding of each addition kept, as often as there are words (SumK of Ogita, Rump and Oishi, SIAM J. Sci. Comput. 26,
// 1955 (2005)).
#pragma once

#include "core/kernels/arithmetic/exact.hpp"

namespace holonomic::HOL_ISA {

// Each word is at most half a unit in the last place of the one before, and zeros come last.
struct QuadDouble {
    double hi, second, third, fourth;
    QuadDouble() = default;
    QuadDouble(double a, double b, double c, double d) : hi(a), second(b), third(c), fourth(d) {}
    QuadDouble(const Pair<double> &a) : hi(a.hi), second(a.lo), third(0), fourth(0) {}  // |lo| is a rounding of hi
};

// Returns the sum of x[0 .. n), n > 4, largest first or nearly so; x is overwritten.
HOL_NOINLINE QuadDouble sum_of(double *x, int n) {
    for (int word = 0; word < 4; ++word)
        for (int i = n - 1; i > word; --i) {
            const Pair<double> s = two_sum<double>(x[i - 1], x[i]);
            x[i - 1] = s.hi;
            x[i] = s.lo;
        }
    for (int i = 5; i < n; ++i) x[4] += x[i];
    // Where the first words have cancelled, the others move up.
    double words[5] = {}, sum = x[0];
    int n_words = 0;
    for (int i = 1; i < 5; ++i) {
        const Pair<double> s = two_sum<double>(sum, x[i]);
        sum = s.hi;
        if (s.lo == 0) continue;
        words[n_words++] = s.hi;
        sum = s.lo;
    }
    words[n_words] = sum;
    return {words[0], words[1], words[2], words[3]};
}

HOL_INLINE QuadDouble as_quad_double(double a) { return {a, 0, 0, 0}; }
HOL_INLINE double rounded(const QuadDouble &a) { return a.hi + a.second; }
// What its first word leaves of a number.
HOL_INLINE double beyond_first(const QuadDouble &a) { return a.second; }
HOL_INLINE QuadDouble over(const QuadDouble &a, double power_of_two) {
    return {a.hi / power_of_two, a.second / power_of_two, a.third / power_of_two, a.fourth / power_of_two};
}

HOL_INLINE QuadDouble operator-(const QuadDouble &a) { return {-a.hi, -a.second, -a.third, -a.fourth}; }

HOL_NOINLINE QuadDouble operator+(const QuadDouble &a, const QuadDouble &b) {
    double x[8] = {a.hi, b.hi, a.second, b.second, a.third, b.third, a.fourth, b.fourth};
    return sum_of(x, 8);
}

HOL_INLINE QuadDouble operator-(const QuadDouble &a, const QuadDouble &b) { return a + -b; }

HOL_NOINLINE QuadDouble operator*(double a, const QuadDouble &b) {
    const Pair<double> p0 = two_product(a, b.hi), p1 = two_product(a, b.second), p2 = two_product(a, b.third);
    double x[7] = {p0.hi, p0.lo, p1.hi, p1.lo, p2.hi, p2.lo, a * b.fourth};
    return sum_of(x, 7);
}

HOL_NOINLINE QuadDouble operator*(const QuadDouble &a, const QuadDouble &b) {
    const Pair<double> p00 = two_product(a.hi, b.hi), p01 = two_product(a.hi, b.second),
                       p10 = two_product(a.second, b.hi), p02 = two_product(a.hi, b.third),
                       p11 = two_product(a.second, b.second), p20 = two_product(a.third, b.hi);
    const double rest = (a.hi * b.fourth + a.fourth * b.hi) + (a.second * b.third + a.third * b.second);
    double x[10] = {p00.hi, p01.hi, p10.hi, p00.lo, p02.hi,
                    p11.hi, p20.hi, p01.lo, p10.lo, rest + (p02.lo + p11.lo + p20.lo)};
    return sum_of(x, 10);
}

HOL_NOINLINE QuadDouble operator/(const QuadDouble &a, const QuadDouble &b) {
    double x[5];
    QuadDouble rest = a;
    for (double &word : x) {
        word = rest.hi / b.hi;
        rest = rest - word * b;
    }
    return sum_of(x, 5);
}

HOL_INLINE QuadDouble abs(const QuadDouble &a) { return a.hi < 0 ? -a : a; }
HOL_INLINE bool less(const QuadDouble &a, const QuadDouble &b) { return (a - b).hi < 0; }

HOL_NOINLINE QuadDouble square_root(const QuadDouble &a) {  // a > 0
    QuadDouble s = as_quad_double(__builtin_sqrt(a.hi));
    for (int step = 0; step < 2; ++step) s = s + 0.5 * ((a - s * s) / s);
    return s;
}

}  // namespace holonomic::HOL_ISA
