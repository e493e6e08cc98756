#include "core/solve.hpp"

#include <algorithm>
#include <limits>
#include <new>

#include "core/reactions.hpp"
#include "core/rigid/parts.hpp"
#include "core/rigid/verbs.hpp"
#include "core/run/diagnose.hpp"
#include "core/run/outcomes.hpp"
#include "core/run/thread_memory.hpp"
#include "core/run/verb_work.hpp"

namespace holonomic {

namespace {

struct SolveWork final : MoleculeWork<SolveCall, &MoleculeKernels::solve> {
    SolveWork(const SolveCall &call, Staging &staging)
        : MoleculeWork(
              call, staging,
              [&](SolveCall &c) {
                  c.rhs = staging.inputs(call.rhs);
                  c.lambda = staging.results(call.lambda);
                  c.tension = staging.results(call.tension);
              },
              [&](SolveCall &c) {
                  c.r = staging.atoms(call.r);
                  c.g = staging.summed_atoms(call.g, call.add);
              }) {}
    // The plan has no linear chains.
    void unit(const Unit &, int, double *, Tally &) const override {}
    using MoleculeWork::unit;
    std::int64_t long_blocks(std::int64_t) const override { return 0; }
    std::int64_t long_bytes(std::int64_t) const override { return 0; }
    void long_chain(const Lane &, int, const Team &, double *, Tally &) const override {}
};

// Whether atoms that are held fixed divide a chain into parts, which are solved apart from each other.
bool divides_chains(const Plan &plan) {
    for (std::size_t kind = 1; kind < plan.part_start.size(); ++kind)
        if (plan.part_start[kind] > plan.part_start[kind - 1] + 1) return true;
    return false;
}

Tally solve_parts(const Chains &chains, const Plan &plan, const SolveCall &call) {
    Staging staging(chains, plan);
    Tally tally = empty_tally();
    execute(chains, plan, SolveWork(call, staging), tally);
    staging.put_back();
    return tally;
}

}  // namespace

Tally solve_equations(const Chains &chains, const AtomArray &r, const double *rhs, const SolveOutputs &out) {
    const Plan &plan = chains.plan_of_parts();
    if (!divides_chains(plan)) {
        const Tally tally =
            solve_parts(chains, plan, {r, out.g, rhs, out.lambda, out.tension, out.add, out.virial, chains.box});
        clear_unconstrained(chains, out.lambda);
        clear_unconstrained(chains, out.tension);
        return tally;
    }
    // Two parts pull at the same atom, and a chain is bad if one of them is: from multipliers, which are no numbers
    // where there is no solution.
    const std::int64_t n = chains.n_bonds();
    double *const lambda =
        static_cast<double *>(thread_memory(Keep::multipliers, n * static_cast<std::int64_t>(sizeof(double))));
    if (!lambda) throw std::bad_alloc();
    std::fill(lambda, lambda + n, std::numeric_limits<double>::quiet_NaN());
    solve_parts(chains, plan, {r, AtomArray{}, rhs, lambda, nullptr, false, false, chains.box});
    return react(chains, r, chains.box, lambda, {out.lambda, out.tension, out.g, out.add, nullptr, out.virial});
}

namespace {

void solve_bonds(const Chains &chains, const AtomArray &r, const double *rhs, double *lambda, const AtomArray &g,
                 bool add, double *virial) {
    const Tally tally = solve_equations(chains, r, rhs, {lambda, nullptr, g, add, virial != nullptr});
    if (tally.n_bad > 0) {
        throw_error(chains, tally, [&](const Tally &bad) {
            check_values(chains, bad, rhs, "right-hand side");  // a bad molecule's lambda was not written
            return diagnose(chains, bad, chains.box, {{"position", &r}}, Status::not_finite);
        });
    }
    if (virial) write_virial(tally, virial);
}

}  // namespace

void solve(const Chains &chains, const AtomArray &r, const double *rhs, double *lambda, const AtomArray &g, bool add,
           double *virial) {
    with_outcomes(chains, [&] {
        rigid::over_all(
            chains, add ? nullptr : &g, virial, [&](double *to) { solve_bonds(chains, r, rhs, lambda, g, add, to); },
            [&](double *to) { rigid::solve(chains, r, rhs, lambda, g, add, to); });
    });
}

}  // namespace holonomic
