#include "core/velocities.hpp"

#include <algorithm>

#include "core/caller/box.hpp"
#include "core/caller/packed_array.hpp"
#include "core/rigid/parts.hpp"
#include "core/rigid/verbs.hpp"
#include "core/run/diagnose.hpp"
#include "core/run/outcomes.hpp"
#include "core/run/verb_work.hpp"

namespace holonomic {

namespace {

struct VelocitiesWork final
    : VerbWork<VelocitiesCall, &MoleculeKernels::velocities, &Kernels::velocities, &Kernels::long_velocities> {
    VelocitiesWork(const VelocitiesCall &call, Staging &staging)
        : VerbWork(
              call, staging, [&](VelocitiesCall &c) { c.lambda = staging.results(call.lambda); },
              [&](VelocitiesCall &c) {
                  c.r = staging.atoms(call.r);
                  c.v = staging.moved_atoms(call.v);
              }) {}
    // The recursion gives the multipliers to a few roundings of themselves; what that leaves of the rates goes with a
    // second projection, of velocities that need next to none.
    [[gnu::noinline]] void solve_long(const VelocitiesCall &call, const Lane &lane, const Team &team, double *store,
                                      Tally &tally) const override {
        const std::int64_t n_bad = tally.n_bad;
        VerbWork::solve_long(call, lane, team, store, tally);
        if (tally.n_bad > n_bad || call.v.is_float) return;
        VelocitiesCall again = call;
        again.lambda = nullptr;
        again.virial = false;
        VerbWork::solve_long(again, lane, team, store, tally);
    }
};

void project_velocities_of_bonds(const Chains &chains, VelocitiesCall &call, double *virial) {
    call.virial = virial != nullptr;
    call.strain = chains.box_rate() ? chains.box_rate()->strain : nullptr;
    put_box(chains.box, call.box);
    AtomArray *const inputs[] = {&call.r, &call.v};
    unify_layout(inputs, 2);
    Staging staging(chains);
    const Tally tally = execute(chains, VelocitiesWork(call, staging));
    staging.put_back();
    clear_unconstrained(chains, call.lambda);
    if (tally.n_bad > 0) throw_diagnosis(chains, tally, {{"position", &call.r}, {"velocity", &call.v}});
    if (virial) write_virial(tally, virial);
}

[[gnu::noinline]] void project_velocities_of_all(const Chains &chains, VelocitiesCall &call, double *virial) {
    with_outcomes(chains, [&] {
        rigid::over_all(
            chains, nullptr, virial, [&](double *to) { project_velocities_of_bonds(chains, call, to); },
            [&](double *to) { rigid::project_velocities(chains, call.r, call.v, call.lambda, to); });
    });
}

}  // namespace

void project_velocities(const Chains &chains, VelocitiesCall &call, double *virial) {
    if (__builtin_expect(chains.is_plain(), 1)) return project_velocities_of_bonds(chains, call, virial);
    project_velocities_of_all(chains, call, virial);
}

}  // namespace holonomic
