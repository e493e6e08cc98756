// Newton's method on a block of molecules: what is done when, by the rules that chains have (newton/rules.hpp).
#pragma once

#include "core/kernels/newton/rules.hpp"
#include "core/kernels/tally.hpp"

namespace holonomic::HOL_ISA::graph {

// Errors |D.D - a^2| / a^2 that are accepted: what the coordinates of a molecule carry, and what is so for any
// coordinates; but no less than the tolerance.
template <class V>
struct Limits {
    V accepted, always_accepted;
    double wanted, far;  // far: from larger errors nothing is tried
    Limits(const PositionsCall &call, V largest_coordinate, V a_min) : Limits(call, largest_coordinate / a_min) {}
    // The largest coordinate in units of the shortest bond.
    Limits(const PositionsCall &call, V coordinate) {
        const double rounding = rounding_of_bonds(call);
        accepted = max(Width<V>::all(call.tolerance), rounding * (Width<V>::all(1) + coordinate));
        always_accepted = Width<V>::all(call.tolerance > rounding ? call.tolerance : rounding);
        wanted = wanted_error(call);
        far = call.far_trial;
    }
    // What is enough where the last solve must have gone far below a rounding: the floor, as in iterate().
    V enough() const {
        const V carried = max(accepted, always_accepted);
        return max(Width<V>::all(wanted), min(Width<V>::all(floor_error), carried));
    }
};

// What became of the lanes.
template <class V>
struct Solved {
    MaskOf<V> untouched, converged;
    V error;
    int64_t solves;
};

// Of the lanes in `which`, whose molecules are lane[i], the one with the worst bond, if none before was worse: the
// tally has taken it; or -1.
template <class V>
HOL_INLINE int worst_lane(unsigned which, const V &error, const MoleculeLane *lane, Tally &tally) {
    int worst = -1;
    for (int i = 0; i < Width<V>::lanes; ++i)
        if ((which >> i & 1) && take_worst(tally, Width<V>::get(error, i), lane[i].molecule)) worst = i;
    return worst;
}

// The worst bond of the molecules in `which`, in the order s.bond_of: of a molecule the one with the smallest number
// among those. error_of(k): in all lanes. for_indices(each) calls each(first, end) for indices where it may stand.
template <class V, class Order, class ErrorOf, class Indices>
HOL_INLINE void note_worst_bond(const Order &s, unsigned which, const V &error, const MoleculeLane *lane,
                                const ErrorOf &error_of, const Indices &for_indices, Tally &tally) {
    const int worst = worst_lane(which, error, lane, tally);
    if (worst < 0) return;
    int32_t bond = s.n_bonds;
    for_indices([&](int32_t first, int32_t end) {
        for (int32_t k = first; k < end; ++k)
            if (s.bond_of[k] < bond && Width<V>::get(error_of(k), worst) >= tally.worst) bond = s.bond_of[k];
    });
    tally.worst_bond = bond < s.n_bonds ? bond : 0;
}

// solve() and move(): a system may have an overload that does both at once.
template <class System, class Mask>
HOL_INLINE auto solve_and_move(System &newton, Mask active) {
    newton.solve(active);
    return newton.move();
}

// New factors square the error. Where they leave much more, bonds are so nearly straight that they can bend either way,
// and the way that Newton's method takes decides. Such a molecule is left to the extended-precision solver, which takes
// the straight one, with new factors at each solve. `before`: the error from which a solve with new factors came.
template <class V>
HOL_INLINE MaskOf<V> lost_its_way(V error, V before) {
    const V part = max(Width<V>::all(0.01), 1e3 * before);
    return less(Width<V>::all(1e-10), error) & less(part * before, error);
}

// Newton's method in the lanes of `wanted`, from tau as it is: 0 or, with `guess`, that, unless 0 is better.
// System:
//   V open()                       largest error of the bonds as they came
//   void first_factors()           with these
//   void forget(mask)              tau = 0
//   void factorize(mask)           with the bonds as they have been moved
//   void solve(mask)               corrections for what is left, added to tau
//   V move()                       the bonds as tau moves them, and their largest error
// look_last: also after the last solve, for what move() leaves of it. by_length: solve() takes |D_0| (|D| - a) on the
// right where its factors are those of D_0, not (D.D - a^2) / 2.
template <class V, bool look_last, bool by_length = false, class System>
HOL_INLINE Solved<V> iterate(System &newton, const Limits<V> &limits, const PositionsCall &call, MaskOf<V> wanted) {
    typedef MaskOf<V> Mask;
    const Mask none = Width<V>::none();
    const V done = Width<V>::all(limits.wanted);
    V error = newton.open();
    Solved<V> out = {wanted & less_equal(error, limits.accepted), none, error, 0};
    Mask active = wanted & ~out.untouched & finite(error) & less_equal(error, Width<V>::all(limits.far));
    if (call.guess) {
        newton.forget(~active);
        const V with_guess = newton.move();
        newton.forget(~less_equal(with_guess, error));
        error = newton.move();
        out.converged = active & less_equal(error, done);
        active = active & ~out.converged;
        if (any(active)) newton.factorize(~none);
    } else if (any(active)) {
        newton.first_factors();
    }
    V rate = error;  // new factors square the error
    Mask proven = none, fresh = active;
    for (int i = 0; i < call.max_iterations && any(active); ++i) {
        const Mask last = active & proven & less(rate * error, Width<V>::all(far_below<by_length>));
        const V before = error, expected = rate * before;
        const bool looks = look_last || call.report || any(active & ~last);
        ++out.solves;
        out.converged = out.converged | last;  // whatever the other lanes have to do
        if (!looks) {
            newton.solve(active);
            break;
        }
        error = solve_and_move(newton, active);
        active = active & ~last;
        const Mask floor = at_floor<by_length>(expected, before, error);
        const Mask near = active & (less_equal(error, done) | floor);
        const Mask finished = near & less_equal(error, max(done, max(limits.accepted, limits.always_accepted)));
        out.converged = out.converged | finished;
        active = active & ~finished & finite(error) & ~(fresh & lost_its_way(error, before));
        if (!any(active)) break;
        rate = error / before;
        const Mask renewed = active & worth_new_factors<by_length>(error, rate, i, limits.wanted);
        proven = ~renewed & next_is_last(error, rate);
        fresh = renewed;
        if (!any(renewed)) continue;
        newton.factorize(renewed);
        rate = select(renewed, error, rate);
    }
    out.error = error;
    return out;
}

}  // namespace holonomic::HOL_ISA::graph
