// From conditions to template arguments: choose(body, a, b) calls body(A, B), where A and B are constants of the
// compiler with the values of a and b, so that body may write kernel<A, B>(..). choose_number<1, 5>(n, body) does the
// same for n = 1 .. 5. choose_few<4>(n, body) does it for n = 1 .. 4, and for any other number gives 0;
// choose_mostly<4>(n, body) out of line, so that it takes no registers of a loop: where a body captures by value.
#pragma once

#include <stdint.h>

#include "core/kernels/isa/target.hpp"

namespace holonomic::HOL_ISA {

template <class T, T number>
struct Constant {
    static constexpr T value = number;
    constexpr operator T() const { return number; }
};

template <class Body>
HOL_INLINE auto choose(const Body &body) {
    return body();
}

template <class Body, class... More>
HOL_INLINE auto choose(const Body &body, bool condition, More... more) {
    if (condition) return choose([&](auto... c) HOL_FORCED { return body(Constant<bool, true>{}, c...); }, more...);
    return choose([&](auto... c) HOL_FORCED { return body(Constant<bool, false>{}, c...); }, more...);
}

template <int first, int last, class Body>
static inline auto choose_number(int64_t n, const Body &body) {
    if constexpr (first < last)
        if (n != first) return choose_number<first + 1, last>(n, body);
    return body(Constant<int, first>{});
}

template <int most, int first = 1, class Body>
HOL_INLINE auto choose_few(int n, const Body &body) {
    if constexpr (first <= most) {
        if (n == first) return body(Constant<int, first>{});
        return choose_few<most, first + 1>(n, body);
    } else {
        return body(Constant<int, 0>{});
    }
}

template <class Body>
HOL_NOINLINE auto for_any_number(Body body) {
    return body(Constant<int, 0>{});
}
template <int most, int first = 1, class Body>
HOL_INLINE auto choose_mostly(int n, const Body &body) {
    if constexpr (first <= most) {
        if (n == first) return body(Constant<int, first>{});
        return choose_mostly<most, first + 1>(n, body);
    } else {
        return for_any_number(body);
    }
}

// A type as an argument.
template <class T>
struct Type {
    typedef T type;
};

}  // namespace holonomic::HOL_ISA
