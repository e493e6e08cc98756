// Sums of logarithms of many factors, of W lanes or of one: one logarithm for as many factors as a product can take.
#pragma once

#include "core/kernels/arithmetic/width.hpp"

namespace holonomic::HOL_ISA {

// Of factors 1 - x, each at least 2^-100. Neither a sum near 0 nor a large one loses digits. What a lane does depends
// on its own factors alone.
template <class V>
struct LogSum {
    static constexpr int always = 8;  // factors whose product is larger than `least` for sure
    static constexpr double least = 0x1p-900;
    V sum = {}, product = Width<V>::all(1), removed = {};  // removed = 1 - product, without cancellation
    int n = 0;
    inline HOL_FORCED void multiply(V factor, V x) {  // factor = 1 - x
        removed = mul_add(removed, factor, x);
        product = product * factor;
        if (++n <= always) return;
        const MaskOf<V> full = less(product, Width<V>::all(least));
        if (__builtin_expect(any(full), 0)) flush(bits(full));
    }
    __attribute__((noinline)) void flush(unsigned lanes = all_of<V>) {
        for (int i = 0; i < Width<V>::lanes; ++i) {
            if (!(lanes >> i & 1)) continue;
            const double p = Width<V>::get(product, i);
            Width<V>::set(
                sum, i,
                Width<V>::get(sum, i) + (p < 0.5 ? __builtin_log(p) : __builtin_log1p(-Width<V>::get(removed, i))));
            Width<V>::set(product, i, 1);
            Width<V>::set(removed, i, 0);
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
