// Newton's method for the positions of a block of chains: which sweep (sweeps.hpp) is made when.
#pragma once

#include "core/kernels/newton/criterion.hpp"
#include "core/kernels/newton/short.hpp"
#include "core/kernels/newton/sweeps.hpp"

namespace holonomic::HOL_ISA {

// Newton's method on the lanes in `wanted`, from tau = 0 or the caller's guess in tau.
template <Same masses, Same a, int fixed = 0>
HOL_INLINE NewtonOutcome iterate(const Block &block, Newton &x, const PositionsCall &call, Carried &carried,
                                 mask wanted, bool guess, bool extended) {
    NewtonOutcome out = {};
    const vec done = splat(wanted_error(call));
    // Functions that are not known here get a copy: x itself stays in registers.
    const auto renew_factors = [&](FactorsOf factors, mask which) HOL_FORCED {
        const Newton copy = x;
        if (fixed > 0 && factors == renewed_factors) return renew<masses, a, fixed>(block, copy, which);
        return renew(block, copy, factors, which);
    };
    x.step = extended ? x.correction : x.tau;
    vec error = extended ? renew_factors(extended_factors, wanted)
                         : eliminate<masses, a, first_factors, fixed>(block, x, wanted);
    out.untouched = wanted & carried.within(error, splat(1.0));
    mask active = wanted & block.movable & ~out.untouched & finite(error) & less_equal(error, splat(call.worst_trial));
    if (guess) {
        for (long k = 0; k < block.n; ++k) x.tau[k] = keep(active, x.tau[k]);
        const vec before = error;
        error = renew_factors(renewed_factors, active);
        active = active & less_equal(error, before);  // where it did not help: from zero, in the second attempt
        out.converged = active & less_equal(error, done);
        active = active & ~out.converged;
    }
    vec rate = error;  // new factors square the error
    mask proven = none();
    for (int i = 0; i < call.max_iterations && any(active); ++i) {
        // Branches on the lanes, so that the next step does not wait for the errors of this one.
        const bool first = i == 0 && !guess;
        if (fixed > 0) {
            // Lanes that are right already, or done, stay as they are: a molecule's neighbours cost it nothing.
            if (first)
                substitute_back<fixed>(block, x, true, false, false, active);
            else
                substitute_back<fixed>(block, x, false, false, false, active);
        } else if (extended || __builtin_expect(bits(active) != all_lanes, 0)) {
            const Newton copy = x;
            substitute_back_in(block, copy, first, extended, active);
        } else if (first)
            substitute_back<fixed>(block, x, true, false, true, active);
        else
            substitute_back<fixed>(block, x, false, false, true, active);
        const mask last = active & proven & less(rate * error, splat(far_below<>));
        out.converged = out.converged | last;  // whatever the other lanes have to do
        active = active & ~last;
        if (!any(active)) {
            ++out.solves;
            if (call.report) {
                const Newton copy = x;
                error = extended ? correct_bonds(block, copy) : residuals(block, copy);
            }
            break;
        }
        const vec before = error, expected = rate * before;
        if (extended) {
            const Newton copy = x;
            error = correct_bonds(block, copy);
        } else {
            error = correct<masses, a, false, fixed>(block, x, i < 3 ? x.next[i] : nullptr);
        }
        ++out.solves;
        const mask floor = at_floor(expected, before, error);
        const mask near = active & (less_equal(error, done) | floor);
        if (any(near)) {
            const mask sure = less_equal(error, max(done, carried.always_accepted()));
            mask finished = near;
            if (any(near & ~sure)) finished = near & less_equal(error, max(done, carried.accepted()));
            out.converged = out.converged | finished;
            active = active & ~finished & finite(error);
            if (!any(active)) break;
        }
        active = active & finite(error);
        rate = error / before;
        const mask renewed = extended ? active : active & worth_new_factors(error, rate, i, wanted_error(call));
        if (!extended) proven = ~renewed & next_is_last(error, rate);
        if (!any(renewed)) continue;
        renew_factors(extended ? extended_factors : renewed_factors, renewed);
        rate = select(renewed, error, rate);
    }
    if (out.solves == 0 && !guess)
        for (long k = 0; k <= block.n; ++k) x.tau[k] = vec{};
    out.error = error;
    return out;
}

// True if chains of two bonds are solved without looking at the error between solves.
HOL_INLINE bool tries_two_bonds(const PositionsCall &call) { return call.max_iterations >= fewest_solves; }

// Newton's method on any lanes: chains of one or two bonds by short.hpp, and iterate() on what that leaves. extended:
// with new factors at every step, D becomes the moved bonds.
NewtonOutcome solve_positions(const Block &, Newton &, const PositionsCall &, Carried &, mask wanted, bool guess,
                              bool extended = false);

}  // namespace holonomic::HOL_ISA
