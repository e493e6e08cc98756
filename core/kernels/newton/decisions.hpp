// What the lanes of a block accept.
#ifndef HOLONOMIC_KERNELS_NEWTON_DECISIONS_HPP
#define HOLONOMIC_KERNELS_NEWTON_DECISIONS_HPP

#include "core/kernels/newton/criterion.hpp"
#include "core/kernels/newton/system.hpp"

namespace holonomic {
namespace HOL_ISA {

// Largest |coordinate| of each lane. With lists of atoms, r is where the first ones are.
HOL_NOINLINE vec extent(const Block &block, const Packed &r, const int64_t *const *lists = nullptr) {
    vec largest;
    for (int i = 0; i < W; ++i) {
        if (lists) {
            double x = 0;
            for (long k = 0; k <= block.len[i]; ++k)
                for (int c = 0; c < 3; ++c) {
                    const double y = abs(r.lane[i][3 * (lists[i][k] - lists[i][0]) + c]);
                    x = y > x ? y : x;
                }
            largest[i] = x;
            continue;
        }
        const long count = 3 * (block.len[i] + 1);
        vec m = {};
        long e = 0;
        for (; e + W <= count; e += W) m = max(m, abs(load(r.lane[i] + e)));
        double x = 0;
        for (int j = 0; j < W; ++j) x = m[j] > x ? m[j] : x;
        for (; e < count; ++e) x = abs(r.lane[i][e]) > x ? abs(r.lane[i][e]) : x;
        largest[i] = x;
    }
    return largest;
}

// What the coordinates of each lane carry. Their largest is looked for when a decision hangs on it, which is rare.
class Carried {
public:
    Carried(const Block &block, const Newton &x, const PositionsCall &call, const Packed &r,
            const int64_t *const *lists = nullptr)
        : block_(block), x_(x), r_(r), lists_(lists), tolerance_(call.tolerance), u_(unit_roundoff(call.r)),
          boxed_(call.box.shape != Box::none) {}

    void know_largest(vec coordinate) {
        largest_ = coordinate;
        known_ = true;
    }
    vec largest_coordinate() {
        if (!known_) largest_ = extent(block_, r_, lists_);
        known_ = true;
        return largest_;
    }
    // An error |D.D - a^2| / a^2 no larger than this one is accepted.
    vec accepted() { return max(splat(tolerance_), carried_error(u_, largest_coordinate(), x_.a_min)); }
    vec always_accepted() const { return splat(tolerance_ > 8 * u_ ? tolerance_ : 8 * u_); }

    // Whether the bonds as they came may be accepted: `error` is their |D.D - a^2| in units of `a2`. No atom is farther
    // from the first one of its chain than the bonds are long, unless there are images: where that bound, on the safe
    // side by much more than its roundings, excludes it, nothing is looked for.
    mask within(vec error, vec a2) {
        if (!boxed_ && !known_) {
            vec first = {};
            for (int c = 0; c < 3; ++c) {
                vec component;
                for (int i = 0; i < W; ++i) component[i] = r_.lane[i][c];
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
    const Packed &r_;
    const int64_t *const *const lists_;
    const double tolerance_, u_;
    const bool boxed_;
    bool known_ = false;
    vec largest_ = {};
};

// From an error no larger than this, a solve with factors that have just taken the error down to less than `steady` of
// itself needs no look at what it has done: it leaves less than a rounding, and could not leave more than this.
constexpr double last_error = 64 * epsilon;
constexpr double steady = 1.0 / 256;

struct Outcome {
    mask untouched, converged;
    vec error;
    int64_t solves;
};

}  // namespace HOL_ISA
}  // namespace holonomic
#endif
