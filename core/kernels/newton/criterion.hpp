// When Newton's method is done in a lane, and when it takes new factors there.
#ifndef HOLONOMIC_KERNELS_NEWTON_CRITERION_HPP
#define HOLONOMIC_KERNELS_NEWTON_CRITERION_HPP

#include "core/kernels/arithmetic/exact.hpp"
#include "core/kernels/newton/system.hpp"

namespace holonomic::HOL_ISA {

// A few roundings of D.D - a^2. In a chain of many bonds the iteration gets no further.
constexpr double floor_error = 4 * epsilon;

// The error that is asked for if the coordinates can carry it.
HOL_INLINE double wanted_error(const PositionsCall &call) {
    return call.tolerance > epsilon ? call.tolerance : epsilon;
}

// An error is at the floor if the solve should have gone far below a rounding, or gained little. Then it is accepted if
// the coordinates carry no less. `expected`: the error that the solve should have left.
HOL_INLINE mask at_floor(vec expected, vec before, vec error) {
    return (less(expected, splat(0.125 * epsilon)) & less_equal(error, splat(floor_error))) |
           less(0.25 * before, error);
}

// The factors of an earlier D shrink the error by the same `rate` each time. New ones square it, at twice the price.
// They are worth it if the old ones would take more than four solves in all. i: solves so far, less one.
HOL_INLINE mask worth_renewing(vec error, vec rate, int64_t i) {
    vec expected = error * rate;
    for (int64_t k = i + 2; k < 4; ++k) expected = expected * rate;
    return less(splat(0.1 * epsilon), expected) & less(splat(i < 2 ? -1.0 : 1e-4), rate);
}

// If the error is no larger than last_error, and the same factors have just taken it below `steady` of itself, nobody
// needs to look at what the next solve does. It leaves less than a rounding, and at the worst last_error.
constexpr double last_error = 64 * epsilon;
constexpr double steady = 1.0 / 256;

// Largest |coordinate| of each lane.
vec extent(const Block &, const Source &);

// What error the coordinates of each lane carry. Each end of a bond is rounded to u |r|, u = half a unit in the last
// place. The largest coordinate is found only when a decision depends on it, which is rare.
class Carried {
public:
    Carried(const Block &block, const Newton &x, const PositionsCall &call, const Source &r)
        : block_(block), x_(x), r_(r), tolerance_(call.tolerance), u_(call.r.is_float ? 5.97e-8 : 1.11e-16),
          worst_trial_(call.worst_trial), boxed_(call.box.shape != Box::none) {}

    void know_largest(vec coordinate) {
        largest_ = coordinate;
        known_ = true;
    }
    vec largest_coordinate() {
        if (!known_) {
            const Source copy = r_;  // so that r_ stays in registers
            largest_ = extent(block_, copy);
        }
        known_ = true;
        return largest_;
    }
    // An error |D.D - a^2| / a^2 no larger than this, or than the caller's tolerance, is accepted.
    vec accepted() { return max(splat(tolerance_), (8 * u_) * (1.0 + largest_coordinate() / x_.a_min)); }
    mask not_too_far(vec error, vec a2) const { return less_equal(error, worst_trial_ * a2); }
    vec always_accepted() const { return splat(tolerance_ > 8 * u_ ? tolerance_ : 8 * u_); }

    // Lanes in which the bonds may be accepted as they came; `error` is their |D.D - a^2| in units of `a2`. Without
    // images no atom is farther from the first one of its chain than all bonds are long. If this bound already excludes
    // all lanes, the largest coordinate is not found. The bound is too large by much more than its roundings.
    mask within(vec error, vec a2) {
        if (!boxed_ && !known_) {
            vec first = {};
            for (int c = 0; c < 3; ++c) {
                vec component = {};
                for (int i = 0; i < W; ++i) component[i] = r_.atom(i, 0)[c];
                first = max(abs(component), first);
            }
            const vec per_a = x_.per_a_min, a = mul_add(error * x_.a_max, per_a * per_a, x_.a_max);
            const vec most = mul_add(mul_add(a, splat(static_cast<double>(block_.n)), first), per_a, splat(1.0));
            if (!any(~less(a2 * max(splat(2 * tolerance_), (16 * u_) * most), error))) return none();
        }
        return less_equal(error, a2 * accepted());
    }

private:
    const Block &block_;
    const Newton &x_;
    const Source r_;
    const double tolerance_, u_, worst_trial_;
    const bool boxed_;
    bool known_ = false;
    vec largest_ = {};
};

struct Outcome {
    mask untouched, converged;
    vec error;
    int64_t solves;
};

}  // namespace holonomic::HOL_ISA
#endif
