// Newton's method for the positions of a block of chains: the parts of it that are compiled once.
#include "core/kernels/isa/choose.hpp"
#include "core/kernels/newton/iterate.hpp"

namespace holonomic::HOL_ISA {

vec renew(const Block &block, const Newton &x, FactorsOf factors, mask which) {
    if (factors == extended_factors) return eliminate<either, either, extended_factors>(block, x, which);
    return choose(
        [&](auto masses, auto a) { return eliminate<same_if(masses), same_if(a), renewed_factors>(block, x, which); },
        !x.w, !x.a2);
}

vec correct_bonds(const Block &block, const Newton &x) { return correct<either, either, true>(block, x, nullptr); }

vec residuals(const Block &block, const Newton &x) {
    Mover<either> mover(x);
    vec worst = {}, y = {};
    for (long k = 0; k < block.n; ++k) y = y + length_error<either>(x, k, true, mover.bond(x, k), worst);
    return largest_error<either>(x, worst, y);
}

void substitute_back_in(const Block &block, const Newton &x, bool first, bool separate, mask which) {
    choose([&](auto is_first, auto is_separate) { substitute_back<0>(block, x, is_first, is_separate, false, which); },
           first, separate);
}

// Adds the outcome of the lanes in `which`.
static void join(NewtonOutcome &out, const NewtonOutcome &more, mask which) {
    out.untouched = out.untouched | more.untouched;
    out.converged = out.converged | more.converged;
    out.error = select(which, more.error, out.error);
    if (more.solves > out.solves) out.solves = more.solves;
}

// Solves the lanes of two bonds in `longer`, and takes out of it those that are done.
static NewtonOutcome try_two_bonds(Newton &x, Carried &carried, mask &longer, int most) {
    const NewtonOutcome out =
        solve_two_bonds<either, either, false>(x, carried, longer & less(x.lengths, splat(2.5)), most);
    longer = longer & ~(out.converged | out.untouched);
    return out;
}

NewtonOutcome solve_positions(const Block &block, Newton &x, const PositionsCall &call, Carried &carried, mask wanted,
                              bool guess, bool extended) {
    const mask single = wanted & less(x.lengths, splat(1.5));
    mask longer = wanted & ~single;
    NewtonOutcome out = {}, two = {};
    vec tau[2] = {};
    if (!extended && !guess && tries_two_bonds(call) && any(longer & less(x.lengths, splat(2.5)))) {
        two = try_two_bonds(x, carried, longer, call.max_iterations);
        tau[0] = x.tau[0];
        tau[1] = x.tau[1];
    }
    if (any(longer))
        out = choose(
            [&](auto masses, auto a) {
                return iterate<same_if(masses), same_if(a)>(block, x, call, carried, longer, guess, extended);
            },
            !x.w, !x.a2);
    else
        for (long k = 0; k < block.n; ++k) x.tau[k] = vec{};
    if (extended) {  // D has been moved by all corrections
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
    join(out, solve_single_bonds<either>(x, carried, single), single);
    return out;
}

}  // namespace holonomic::HOL_ISA
