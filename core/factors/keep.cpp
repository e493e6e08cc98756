#include "core/factors/keep.hpp"

#include <algorithm>

#include "core/index.hpp"
#include "core/molecules/planned/elimination_plan.hpp"
#include "core/run/execute.hpp"
#include "core/run/lane.hpp"
#include "core/run/staging.hpp"

namespace holonomic {

namespace {

// Chains that do not fit into lanes are kept as one lane, for right-hand sides that are given; forces are left to the
// ordinary verb, whose segments are in lanes. So are those of large trees that are mostly chains. Molecules of other
// shapes are left.
struct KeptWork : Work {
    const Kernels &k = kernels();
    const Plan &plan;
    unsigned char *const left;
    KeptWork(const Chains &chains, unsigned char *marks) : plan(chains.plan()), left(marks) {}
    std::int64_t long_blocks(std::int64_t) const override { return 0; }
    std::int64_t long_bytes(std::int64_t n_bonds) const override {
        return kernels_for_one_chain().scratch_bytes(n_bonds);
    }
    std::int64_t scratch_bytes() const override {
        std::int64_t most = 0;
        for (const std::int32_t s : plan.shapes)
            most = std::max(most, k.kept.scratch_bytes(*plan.elimination_plans[at(s)]));
        return most;
    }
    static bool is_for_rhs_alone(const MoleculeUnit &unit) {
        return list_of_kept(*unit.elimination) && unit.elimination->way.forces != Way::sparse_ldl;
    }
    bool is_left(const MoleculeUnit &unit) const {
        if (k.kept.is_kept(*unit.elimination)) return false;
        for (std::int64_t i = 0; i < unit.count; ++i) left[lane_of(unit, i).molecule] = 1;
        return true;
    }
};

struct KeepWork final : KeptWork {
    const KeepCall &call;
    KeepWork(const Chains &chains, const KeepCall &c) : KeptWork(chains, c.left), call(c) {}
    void unit(const Unit &unit, int, double *scratch, Tally &tally) const override {
        kernels(unit).kept.keep_chains(call, unit, scratch, tally);
    }
    void unit(const MoleculeUnit &unit, int, double *scratch, Tally &tally) const override {
        if (is_left(unit)) return;
        k.kept.keep_molecules(call, unit, scratch, tally);
        for (std::int64_t i = 0; is_for_rhs_alone(unit) && i < unit.count; ++i) {
            unsigned char &mark = left[lane_of(unit, i).molecule];
            if (!mark) mark = left_of_forces;
        }
    }
    void long_chain(const Lane &lane, int, const Team &, double *store, Tally &tally) const override {
        kernels_for_one_chain().kept.keep_chains(call, {&lane, 1, false, false}, store, tally);
        if (!left[lane.chain]) left[lane.chain] = left_of_forces;
    }
};

struct KeptSolveWork final : KeptWork {
    const Variants<KeptCall> variants;  // of a single call
    const KeptCall *const calls;
    const int n_calls;
    KeptSolveWork(const Chains &chains, const KeptCall *given, int n, Staging &staging)
        : KeptWork(chains, given->left), variants(
                                             *given, staging,
                                             [&](KeptCall &c) {
                                                 c.rhs = staging.inputs(given->rhs);
                                                 c.lambda = staging.results(given->lambda);
                                                 c.tension = staging.results(given->tension);
                                             },
                                             [](KeptCall &) {}),
          calls(given), n_calls(n) {}
    template <class Body>
    void for_each_call(int where, const Body &body) const {
        if (n_calls == 1) return body(variants[where]);
        for (int i = 0; i < n_calls; ++i) body(calls[i]);
    }
    void unit(const Unit &unit, int where, double *scratch, Tally &tally) const override {
        for_each_call(where, [&](const KeptCall &c) { kernels(unit).kept.solve_chains(c, unit, scratch, tally); });
    }
    void unit(const MoleculeUnit &unit, int where, double *scratch, Tally &tally) const override {
        if (!k.kept.is_kept(*unit.elimination) || (!calls->rhs && is_for_rhs_alone(unit))) return;
        k.kept.solve_molecules(n_calls == 1 ? &variants[where] : calls, n_calls, unit, scratch, tally);
    }
    void long_chain(const Lane &lane, int where, const Team &, double *store, Tally &tally) const override {
        if (!calls->rhs) return;
        for_each_call(where, [&](const KeptCall &c) {
            kernels_for_one_chain().kept.solve_chains(c, {&lane, 1, false, false}, store, tally);
        });
    }
};

}  // namespace

void keep(const Chains &chains, const KeepCall &call) {
    const Plan &plan = chains.plan();
    for (const std::int32_t s : plan.shapes) make_list_of_kept(*plan.elimination_plans[at(s)]);
    execute(chains, KeepWork(chains, call));
}

Tally solve_kept(const Chains &chains, const KeptCall *calls, int n) {
    Staging staging(chains);
    const Tally tally = execute(chains, KeptSolveWork(chains, calls, n, staging));
    staging.put_back();
    for (int k = 0; k < n; ++k) {
        clear_unconstrained(chains, calls[k].lambda);
        clear_unconstrained(chains, calls[k].tension);
    }
    return tally;
}

}  // namespace holonomic
