// When Newton's method for positions is done, and when it takes new factors: what holds for chains in lanes (V = vec),
// for molecules (vec and double) and for the extended-precision solver (double). Errors are |D.D - a^2| / a^2, the
// largest of a lane.
#pragma once

#include "core/kernels/arithmetic/width.hpp"
#include "core/kernels/call.hpp"

namespace holonomic::HOL_ISA {

// A few roundings of D.D - a^2. With many bonds the iteration gets no further.
constexpr double floor_error = 4 * epsilon;

// A solve that should leave less than this has gone far below a rounding. `by_length`: see worth_new_factors().
template <bool by_length = false>
constexpr double far_below = (by_length ? 0.5 : 0.125) * epsilon;

// The error that is asked for if the coordinates can carry it.
HOL_INLINE double wanted_error(const PositionsCall &call) {
    return call.tolerance > epsilon ? call.tolerance : epsilon;
}

// What error any coordinates carry: each end of a bond is rounded to u |r|, u = half a unit in the last place. Those of
// a molecule carry (1 + largest coordinate / shortest bond) times that.
HOL_INLINE double rounding_of_bonds(const PositionsCall &call) { return 8 * (call.r.is_float ? 5.97e-8 : 1.11e-16); }

// An error is at the floor if the solve should have gone far below a rounding, or gained little. Then it is accepted if
// the coordinates carry no less. `expected`: the error that the solve should have left; it came from `before`.
template <bool by_length = false, class V>
HOL_INLINE MaskOf<V> at_floor(V expected, V before, V error) {
    return (less(expected, Width<V>::all(far_below<by_length>)) & less_equal(error, Width<V>::all(floor_error))) |
           less(0.25 * before, error);
}

// The factors of an earlier D shrink the error by the same `rate` each time. New ones square it, at twice the price.
// They are worth it if the old ones would take more than four solves in all to what is `wanted`. i: solves so far, less
// one. `by_length`: the right-hand side is |D_0| (|D| - a) where the factors are those of D_0. Then the rate of the
// first solve says nothing of those that follow. It leaves the square of the angles by which bonds have turned, the
// others are slowed down by the angles themselves: two of these make the error to the power of two, four to that of
// three. Later, new factors take one solve for what is below 1e-8 and two for what is above, and a price of one to
// three: they are worth it if the old ones would take two more than that.
template <bool by_length = false, class V>
HOL_INLINE MaskOf<V> worth_new_factors(V error, V rate, int64_t i, double wanted) {
    if (by_length && i == 0)
        return less(Width<V>::all(1e-5), error) & less(Width<V>::all(wanted), error * error * error);
    V expected = error * rate;
    if (by_length) {
        expected = expected * rate;
        expected = select(less(Width<V>::all(1e-8), error), expected * rate, expected);
        return less(Width<V>::all(0.4 * wanted), expected);
    }
    for (int64_t k = i + 2; k < 4; ++k) expected = expected * rate;
    return less(Width<V>::all(0.1 * wanted), expected) & less(Width<V>::all(i < 2 ? -1.0 : 1e-4), rate);
}

// True if nobody needs to look at what the next solve does: the error is no larger than last_error, and the same
// factors have just taken it below `steady` of itself. The solve leaves less than a rounding, and at the worst
// last_error.
constexpr double last_error = 64 * epsilon;
constexpr double steady = 1.0 / 256;
template <class V>
HOL_INLINE MaskOf<V> next_is_last(V error, V rate) {
    return less(rate, Width<V>::all(steady)) & less_equal(error, Width<V>::all(last_error));
}

}  // namespace holonomic::HOL_ISA
