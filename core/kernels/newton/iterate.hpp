// Newton's method for the positions of a block of chains: which sweep (sweeps.hpp) is made when.
#ifndef HOLONOMIC_KERNELS_NEWTON_ITERATE_HPP
#define HOLONOMIC_KERNELS_NEWTON_ITERATE_HPP

#include "core/kernels/newton/criterion.hpp"
#include "core/kernels/newton/short.hpp"
#include "core/kernels/newton/sweeps.hpp"

namespace holonomic::HOL_ISA {

// Newton's method on the lanes in `wanted`, from tau = 0 or the caller's guess in tau.
template <bool uniform_w, bool uniform_a, bool careful, int fixed = 0>
HOL_INLINE Outcome iterate(const Block &block, Newton &x, const PositionsCall &call, Carried &carried, mask wanted,
                           bool guess) {
    Outcome out = {};
    const vec done = splat(wanted_error(call));
    x.step = careful ? x.correction : x.tau;
    vec error = careful ? renew<uniform_w, uniform_a, careful_factors>(block, x, wanted)
                        : eliminate<uniform_w, uniform_a, first_factors, fixed>(block, x, wanted);
    out.untouched = wanted & carried.within(error, splat(1.0));
    mask active = wanted & block.movable & ~out.untouched & finite(error) & less_equal(error, splat(call.worst_trial));
    if (guess) {
        for (long k = 0; k < block.n; ++k) x.tau[k] = keep(active, x.tau[k]);
        const vec before = error;
        error = renew<uniform_w, uniform_a, renewed_factors>(block, x, active);
        active = active & less_equal(error, before);  // where it did not help: from zero, in the second attempt
        out.converged = active & less_equal(error, done);
        active = active & ~out.converged;
    }
    vec rate = error;  // new factors square the error
    mask proven = none();
    for (int i = 0; i < call.max_iterations && any(active); ++i) {
        if (i == 0 && !guess)
            substitute_back<true, careful, fixed>(block, x, active);
        else
            substitute_back<false, careful, fixed>(block, x, active);
        const mask last = active & proven & less(rate * error, splat(0.125 * epsilon));
        out.converged = out.converged | last;  // whatever the other lanes have to do
        active = active & ~last;
        if (!any(active)) {
            ++out.solves;
            if (call.report) error = correct<uniform_w, uniform_a, careful, fixed>(block, x, nullptr);
            break;
        }
        const vec before = error, expected = rate * before;
        error = correct<uniform_w, uniform_a, careful, fixed>(block, x, i < 3 ? x.next[i] : nullptr);
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
        const mask renewed = careful ? active : active & worth_renewing(error, rate, i);
        if (!careful) proven = ~renewed & less(rate, splat(steady)) & less_equal(error, splat(last_error));
        if (!any(renewed)) continue;
        renew<uniform_w, uniform_a, careful ? careful_factors : renewed_factors, fixed>(block, x, renewed);
        rate = select(renewed, error, rate);
    }
    if (out.solves == 0 && !guess)
        for (long k = 0; k <= block.n; ++k) x.tau[k] = vec{};
    out.error = error;
    return out;
}

// Adds the outcome of the lanes in `which`.
HOL_INLINE void join(Outcome &out, const Outcome &more, mask which) {
    out.untouched = out.untouched | more.untouched;
    out.converged = out.converged | more.converged;
    out.error = select(which, more.error, out.error);
    if (more.solves > out.solves) out.solves = more.solves;
}

// True if chains of two bonds are solved without looking at the error first: a loose tolerance would save solves.
HOL_INLINE bool tries_two_bonds(const PositionsCall &call) {
    return call.max_iterations >= two_bonds_solves && !(call.tolerance > epsilon);
}

// Solves the lanes of two bonds in `longer`, and takes out of it those that are done.
template <bool uniform_w, bool uniform_a>
HOL_NOINLINE Outcome try_two_bonds(Newton &x, Carried &carried, mask &longer) {
    const Outcome out = solve_two_bonds<uniform_w, uniform_a>(x, carried, longer & less(x.lengths, splat(2.5)));
    longer = longer & ~(out.converged | out.untouched);
    return out;
}

// Newton's method on any lanes. Chains of one or two bonds go by short.hpp; iterate() does what that leaves.
template <bool uniform_w, bool uniform_a, bool careful>
HOL_NOINLINE Outcome solve_positions(const Block &block, Newton &x, const PositionsCall &call, Carried &carried,
                                     mask wanted, bool guess) {
    const mask single = wanted & less(x.lengths, splat(1.5));
    mask longer = wanted & ~single;
    Outcome out = {}, two = {};
    vec tau[2] = {};
    if (!careful && !guess && tries_two_bonds(call) && any(longer & less(x.lengths, splat(2.5)))) {
        two = try_two_bonds<uniform_w, uniform_a>(x, carried, longer);
        tau[0] = x.tau[0];
        tau[1] = x.tau[1];
    }
    if (any(longer))
        out = iterate<uniform_w, uniform_a, careful>(block, x, call, carried, longer, guess);
    else
        for (long k = 0; k < block.n; ++k) x.tau[k] = vec{};
    if (careful) {  // D has been moved by all corrections
        x.step = x.correction;
        for (long k = 0; k < block.n; ++k) x.correction[k] = vec{};
    }
    const mask closed = two.converged | two.untouched;
    if (any(closed)) {
        for (int k = 0; k < 2; ++k) x.tau[k] = select(closed, tau[k], x.tau[k]);
        join(out, two, closed);
    }
    if (!any(single)) return out;
    x.step = x.tau;
    join(out, solve_single_bonds<uniform_w>(x, carried, single), single);
    return out;
}

}  // namespace holonomic::HOL_ISA
#endif
