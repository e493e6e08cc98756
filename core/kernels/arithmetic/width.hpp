// What is written once for W lanes (V = vec) and for a single number (V = double): the same operations in the same
// order, so that no digit of a molecule depends on which of the two it gets.
#pragma once

#include "core/kernels/arithmetic/exact.hpp"
#include "core/kernels/isa/lanes.hpp"

namespace holonomic::HOL_ISA {

// The mask of a single lane.
struct ScalarMask {
    bool set;
};
HOL_INLINE ScalarMask operator&(ScalarMask a, ScalarMask b) { return {a.set && b.set}; }
HOL_INLINE ScalarMask operator|(ScalarMask a, ScalarMask b) { return {a.set || b.set}; }
HOL_INLINE ScalarMask operator~(ScalarMask a) { return {!a.set}; }

HOL_INLINE bool any(ScalarMask a) { return a.set; }
HOL_INLINE unsigned bits(ScalarMask a) { return a.set; }
HOL_INLINE ScalarMask less(double a, double b) { return {a < b}; }
HOL_INLINE ScalarMask less_equal(double a, double b) { return {a <= b}; }
HOL_INLINE ScalarMask finite(double a) { return {a - a == 0}; }
HOL_INLINE double select(ScalarMask m, double a, double b) { return m.set ? a : b; }
HOL_INLINE double keep(ScalarMask m, double a) { return m.set ? a : 0; }
HOL_INLINE double max(double a, double b) { return a > b ? a : b; }  // b where one is NaN, as the instruction has it
HOL_INLINE double min(double a, double b) { return a < b ? a : b; }
HOL_INLINE double sqrt(double a) { return __builtin_sqrt(a); }
HOL_INLINE double mul_sub(double a, double b, double c) { return mul_add(a, b, -c); }

// Bits of the exponent of a double.
constexpr long long exponent_bits = 0x7ff0000000000000LL;
constexpr long long exponent_of_one = 0x3ff0000000000000LL;

template <class V>
struct Width;

template <>
struct Width<vec> {
    typedef mask Mask;
    static constexpr int lanes = W;
    HOL_STATIC vec all(double a) { return splat(a); }
    HOL_STATIC mask none() { return mask{}; }
    HOL_STATIC mask first(int n) { return first_lanes(n); }
    HOL_STATIC mask of_bits(unsigned b) {
        mask m{};
        for (int i = 0; i < W; ++i) m[i] = b >> i & 1 ? -1 : 0;
        return m;
    }
    HOL_STATIC double get(const vec &a, int i) { return a[i]; }
    HOL_STATIC void set(vec &a, int i, double x) { a[i] = x; }
    typedef mask Integers;
    HOL_STATIC mask integers(const vec &a) { return as_mask(a); }
    HOL_STATIC vec of_integers(const mask &m) { return as_vec(m); }
    HOL_STATIC long long integer(const mask &m, int i) { return m[i]; }
};

template <>
struct Width<double> {
    typedef ScalarMask Mask;
    static constexpr int lanes = 1;
    HOL_STATIC double all(double a) { return a; }
    HOL_STATIC ScalarMask none() { return {false}; }
    HOL_STATIC ScalarMask first(int n) { return {n > 0}; }
    HOL_STATIC ScalarMask of_bits(unsigned b) { return {(b & 1) != 0}; }
    HOL_STATIC double get(double a, int) { return a; }
    HOL_STATIC void set(double &a, int, double x) { a = x; }
    typedef long long Integers;
    HOL_STATIC long long integers(double a) {
        long long m;
        __builtin_memcpy(&m, &a, sizeof m);
        return m;
    }
    HOL_STATIC double of_integers(long long m) {
        double a;
        __builtin_memcpy(&a, &m, sizeof a);
        return a;
    }
    HOL_STATIC long long integer(long long m, int) { return m; }
};

template <class V>
using MaskOf = typename Width<V>::Mask;
template <class V>
constexpr unsigned all_of = (1u << Width<V>::lanes) - 1;  // bits() of a mask with all lanes set

}  // namespace holonomic::HOL_ISA
