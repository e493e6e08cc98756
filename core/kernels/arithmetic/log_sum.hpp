// Sums of logarithms of many factors, of W lanes or of one: one logarithm for every few factors.
#pragma once

#include "core/kernels/arithmetic/width.hpp"

namespace holonomic::HOL_ISA {

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
    // The logarithm of p = 1 - x.
    __attribute__((noinline)) void add(V p, V x) {
        for (int i = 0; i < Width<V>::lanes; ++i) {
            const double one = Width<V>::get(p, i);
            Width<V>::set(sum, i,
                          Width<V>::get(sum, i) + (one < 0.5 ? __builtin_log(one) : __builtin_log1p(-Width<V>::get(x, i))));
        }
    }
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
