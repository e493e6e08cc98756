// How many digits an extended solution has lost. What is found from terms of one sign is right whatever the
// conditioning is. Multipliers of a joint and pivots of a core are not: their terms cancel. `largest` is the largest
// ratio, over all sums of a molecule, of the sizes of the terms to their sum (theory (54a)); a size includes what a
// term has itself been made of.
#pragma once

#include "core/kernels/arithmetic/thresholds.hpp"
#include "core/kernels/extended/wide.hpp"

namespace holonomic::HOL_ISA::extended {

HOL_INLINE bool is_too_large(double size, const Wide &sum) {
    return !is_quad_double && size > largest_loss * abs(sum.hi);
}

struct Loss {
    double largest;
    // A sum of nothing but zeros is exact.
    void note(double size, const Wide &sum) {
        const double of_sum = abs(sum.hi);
        if (size > largest * of_sum) largest = of_sum > 0 ? size / of_sum : __builtin_inf();
    }
    void note(double other) {
        if (other > largest) largest = other;
    }
    bool too_much() const { return !is_quad_double && !(largest <= largest_loss); }
};

HOL_INLINE double size_of(const Wide3 &a) { return abs(a.x.hi) + abs(a.y.hi) + abs(a.z.hi); }
HOL_INLINE Vector3<double> sizes_of(const Wide3 &a) { return {abs(a.x.hi), abs(a.y.hi), abs(a.z.hi)}; }
HOL_INLINE double size_of_dot(const Wide3 &a, const Wide3 &b) { return dot(sizes_of(a), sizes_of(b)); }
HOL_INLINE Vector3<double> sizes_of_cross(const Wide3 &a, const Wide3 &b) {
    const Vector3<double> p = sizes_of(a), q = sizes_of(b);
    return {p.y * q.z + p.z * q.y, p.z * q.x + p.x * q.z, p.x * q.y + p.y * q.x};
}
// (a x b).(c x d).
HOL_INLINE double size_of_crosses(const Wide3 &a, const Wide3 &b, const Wide3 &ab, const Wide3 &c, const Wide3 &d,
                                  const Wide3 &cd) {
    return dot(sizes_of_cross(a, b), sizes_of(cd)) + dot(sizes_of(ab), sizes_of_cross(c, d));
}
// v.(a x b).
HOL_INLINE double size_of_volume(const Wide3 &v, const Wide3 &a, const Wide3 &b) {
    return dot(sizes_of(v), sizes_of_cross(a, b));
}

}  // namespace holonomic::HOL_ISA::extended
