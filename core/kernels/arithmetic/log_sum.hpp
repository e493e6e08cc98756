// Sums of logarithms of many factors, of W lanes or of one: one logarithm for every few factors.
#pragma once

#include "core/kernels/arithmetic/width.hpp"

namespace holonomic::HOL_ISA {

// ln p of p = 1 - x, x >= 0, of which both are right to their last digits; NaN if p is below 2^-1000 or no number. The
// method is that of fdlibm (Sun Microsystems 1993): p = 2^k m, ln m from a polynomial in s = f / (2 + f), f = m - 1,
// |f| < 0.42.
template <class V>
HOL_INLINE V logarithm(V p, V x) {
    typedef typename Width<V>::Integers Integers;
    constexpr double root = 0x1.6a09e667f3bcdp-1;  // of 1/2
    constexpr long long above_root = exponent_of_one - 0x3fe6a09e667f3bcdLL;
    const auto known = less(Width<V>::all(0x1p-1000), p), small = known & less(p, Width<V>::all(0.5));
    const V one = Width<V>::all(1), q = select(known, select(small, p, one - x), one);
    const Integers power = (Width<V>::integers(q) + above_root) & (Integers{} + exponent_bits);
    const V m = q * Width<V>::of_integers((Integers{} + 2 * exponent_of_one) - power);
    const V k = Width<V>::of_integers((power >> 52) + (0x4338000000000000LL - 1023)) - Width<V>::all(0x1.8p52);
    const V f = select(less(q, Width<V>::all(root)), select(small, m - one, one - (x + x)), -x);  // exact
    const V s = f / (one + one + f), z = s * s, w = z * z;
    const auto horner = [&](double a, double b, double c) HOL_FORCED {
        return mul_add(w, mul_add(w, Width<V>::all(a), Width<V>::all(b)), Width<V>::all(c));
    };
    const V odd = horner(0x1.39a09d078c69fp-3, 0x1.c71c51d8e78afp-3, 0x1.999999997fa04p-2),
            even = mul_add(w, horner(0x1.2f112df3e5244p-3, 0x1.7466496cb03dep-3, 0x1.2492494229359p-2),
                           Width<V>::all(0x1.5555555555593p-1)),
            half = 0.5 * f * f, rest = mul_add(z, even, w * odd);
    const V low = mul_add(s, half + rest, k * Width<V>::all(0x1.a39ef35793c76p-33));
    const V sum = mul_add(k, Width<V>::all(0x1.62e42feep-1), f - (half - low));
    return select(known, sum, Width<V>::all(__builtin_nan("")));
}

// Of factors 1 - x, each at least 2^-100. Neither a sum near 0 nor a large one loses digits.
template <class V>
struct LogSum {
    static constexpr int group = 8;
    V sum = {}, product = Width<V>::all(1), removed = {};  // removed = 1 - product, without cancellation
    int n = 0;
    inline HOL_FORCED void multiply(V factor, V x) {  // factor = 1 - x
        removed = mul_add(removed, factor, x);
        product = product * factor;
        if (++n == group) flush();
    }
    void flush() {
        add(product, removed);
        product = Width<V>::all(1);
        removed = V{};
        n = 0;
    }
    __attribute__((noinline)) void add(V p, V x) { sum = sum + logarithm(p, x); }
};

// Of positive factors of any size: mantissas and exponents are added up apart.
template <class V>
struct LogSumWide {
    typedef typename Width<V>::Integers Integers;
    V sum = {}, mantissas = Width<V>::all(1);
    Integers exponents = {};
    int n = 0;
    inline HOL_FORCED void multiply(V factor, V scale) {  // factor / scale^2, scale a power of two
        const Integers f = Width<V>::integers(factor), one = Integers{} + exponent_of_one;
        exponents = exponents + (((f & (Integers{} + exponent_bits)) - one) >> 52) -
                    2 * ((Width<V>::integers(scale) - one) >> 52);
        mantissas = mantissas * Width<V>::of_integers((f & (Integers{} + 0xfffffffffffffLL)) | one);
        if (++n == 16) flush();
    }
    __attribute__((noinline)) void flush() {
        for (int i = 0; i < Width<V>::lanes; ++i)
            Width<V>::set(sum, i, Width<V>::get(sum, i) + __builtin_log(Width<V>::get(mantissas, i)));
        mantissas = Width<V>::all(1);
        n = 0;
    }
    V total() {
        flush();
        for (int i = 0; i < Width<V>::lanes; ++i)
            Width<V>::set(
                sum, i,
                Width<V>::get(sum, i) + static_cast<double>(Width<V>::integer(exponents, i)) * 0.69314718055994530942);
        return sum;
    }
};

}  // namespace holonomic::HOL_ISA
