// What the coordinates of chains carry, by which Newton's method is done in a lane (rules.hpp).
#pragma once

#include "core/kernels/newton/rules.hpp"
#include "core/kernels/newton/system.hpp"

namespace holonomic::HOL_ISA {

// Largest |coordinate| of each lane.
vec extent(const Block &, const Source &);

// What error the coordinates of each lane carry. The largest coordinate is found only when a decision depends on it,
// which is rare.
class Carried {
public:
    Carried(const Block &block, const Newton &x, const PositionsCall &call, const Source &r)
        : block_(block), x_(x), r_(r), tolerance_(call.tolerance), rounding_(rounding_of_bonds(call)),
          worst_trial_(call.worst_trial), boxed_(call.box.lattice != Box::none) {}

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
    vec accepted() { return max(splat(tolerance_), rounding_ * (1.0 + largest_coordinate() / x_.a_min)); }
    mask not_too_far(vec error, vec a2) const { return less_equal(error, worst_trial_ * a2); }
    vec always_accepted() const { return splat(tolerance_ > rounding_ ? tolerance_ : rounding_); }

    // Lanes in which the bonds may be accepted as they came; `error` is their |D.D - a^2| in units of `a2`. Without
    // images no atom is farther from the first one of its chain than all bonds are long. If this bound, or the first
    // atom alone, already decides of all lanes, the largest coordinate is not found. The bound is too large by much
    // more than its roundings.
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
            const vec carried = (2 * rounding_) * most;
            // A tolerance above that decides alone.
            if (tolerance_ > rounding_ && !any(less(splat(tolerance_), carried)))
                return less_equal(error, a2 * splat(tolerance_));
            const mask excluded = less(a2 * max(splat(2 * tolerance_), carried), error);
            if (!any(~excluded)) return none();
            const mask accepted = less_equal(error, a2 * max(splat(tolerance_), rounding_ * (1.0 + first / x_.a_min)));
            if (!any(~(excluded | accepted))) return accepted;
        }
        return less_equal(error, a2 * accepted());
    }

private:
    const Block &block_;
    const Newton &x_;
    const Source r_;
    const double tolerance_, rounding_, worst_trial_;
    const bool boxed_;
    bool known_ = false;
    vec largest_ = {};
};

struct NewtonOutcome {
    mask untouched, converged;
    vec error;
    int64_t solves;
};

}  // namespace holonomic::HOL_ISA
