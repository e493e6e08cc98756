// When Newton's method is done, and when it takes new factors: for the error of a lane each (V = vec) or of a long
// chain (V = double).
#ifndef HOLONOMIC_KERNELS_NEWTON_CRITERION_HPP
#define HOLONOMIC_KERNELS_NEWTON_CRITERION_HPP

#include "core/kernels/call.hpp"
#include "core/kernels/isa/lanes.hpp"

namespace holonomic {
namespace HOL_ISA {

constexpr double epsilon = 2.220446049250313e-16;

// A few roundings of D.D - a^2: what the iteration leaves at best in a chain of many bonds.
constexpr double floor_error = 4 * epsilon;

HOL_INLINE bool less(double a, double b) { return a < b; }
HOL_INLINE bool less_equal(double a, double b) { return a <= b; }

// What the coordinates carry: each end of a bond is rounded to u |r|, u = half a unit in the last place. An error
// |D.D - a^2| / a^2 no larger than this, or than the caller's tolerance, is accepted.
HOL_INLINE double unit_roundoff(const AtomArray &r) { return r.is_float ? 5.97e-8 : 1.11e-16; }
template <class V>
HOL_INLINE V carried_error(double u, V extent, V shortest) {
    return (8 * u) * (1.0 + extent / shortest);
}

// What is asked for where the coordinates carry it.
HOL_INLINE double wanted_error(const PositionsCall &call) {
    return call.tolerance > epsilon ? call.tolerance : epsilon;
}

// At the floor: the solve should have gone far below a rounding, or it gained little. There an error is accepted that
// is no more than the coordinates carry. `expected`: what the solve should have left.
template <class V>
HOL_INLINE auto at_floor(V expected, V before, V error) {
    return (less(expected, V{} + 0.125 * epsilon) & less_equal(error, V{} + floor_error)) | less(0.25 * before, error);
}

// The factors of an earlier D shrink the error by a constant, `rate`, each time; new ones square it at twice the price:
// they are worth it where the old ones would take more than four solves in all. i: solves so far, less one.
template <class V>
HOL_INLINE auto worth_renewing(V error, V rate, int64_t i) {
    V expected = error * rate;
    for (int64_t k = i + 2; k < 4; ++k) expected = expected * rate;
    return less(V{} + 0.1 * epsilon, expected) & less(V{} + (i < 2 ? -1.0 : 1e-4), rate);
}

}  // namespace HOL_ISA
}  // namespace holonomic
#endif
