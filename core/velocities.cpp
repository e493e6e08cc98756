#include "core/velocities.hpp"

#include <algorithm>

#include "core/caller/box.hpp"
#include "core/caller/packed_array.hpp"
#include "core/rigid/parts.hpp"
#include "core/rigid/verbs.hpp"
#include "core/run/diagnose.hpp"
#include "core/run/execute.hpp"
#include "core/run/outcomes.hpp"
#include "core/run/rescale.hpp"
#include "core/run/staging.hpp"

namespace holonomic {

namespace {

struct VelocitiesWork final : Work {
    const Variants<VelocitiesCall> calls;
    const Kernels &k = kernels();
    VelocitiesWork(const VelocitiesCall &call, Staging &staging)
        : calls(
              call, staging, [&](VelocitiesCall &c) { c.lambda = staging.results(call.lambda); },
              [&](VelocitiesCall &c) {
                  c.r = staging.atoms(call.r);
                  c.v = staging.moved_atoms(call.v);
              }) {}
    void unit(const Unit &unit, int where, double *scratch, Tally &tally) const override {
        kernels(unit).velocities(calls[where], unit, scratch, tally);
    }
    void unit(const MoleculeUnit &unit, int where, double *scratch, Tally &tally) const override {
        k.molecules.velocities(calls[where], unit, scratch, tally);
    }
    bool walks_batches() const override { return true; }
    std::int64_t long_blocks(std::int64_t n) const override { return k.long_velocities.blocks(n); }
    std::int64_t long_bytes(std::int64_t n) const override { return k.long_velocities.bytes(n); }
    void long_chain(const Lane &lane, int where, const Team &team, double *store, Tally &tally) const override {
        work_on_long(calls[where], lane, team, store, tally);
    }
    void work_on_long(const VelocitiesCall &call, const Lane &lane, const Team &team, double *store,
                      Tally &tally) const {
        // The recursion gives the multipliers to a few roundings of themselves; what that leaves of the rates goes with
        // a second projection, of velocities that need next to none.
        const std::int64_t n_bad = tally.n_bad;
        solve_long_chain(k.long_velocities, call, lane, team, store, tally);
        if (tally.n_bad > n_bad) return;
        VelocitiesCall again = call;
        again.lambda = nullptr;
        again.virial = false;
        if (!call.v.is_float) solve_long_chain(k.long_velocities, again, lane, team, store, tally);
    }
    bool rescales() const override { return true; }
    bool again(const Unit &one, int where, double *scratch, Tally &tally) const override {
        return work_in_ordinary_units(calls[where], one, tally,
                                      [&](const VelocitiesCall &c, const Unit &unit, Tally &own) {
                                          kernels(unit).velocities(c, unit, scratch, own);
                                      });
    }
    bool again(const MoleculeUnit &one, int where, double *scratch, Tally &tally) const override {
        return work_in_ordinary_units(calls[where], one, tally,
                                      [&](const VelocitiesCall &c, const MoleculeUnit &unit, Tally &own) {
                                          k.molecules.velocities(c, unit, scratch, own);
                                      });
    }
    bool again(const Lane &lane, int where, const Team &team, double *store, Tally &tally) const override {
        return work_in_ordinary_units(calls[where], Unit{&lane, 1, false, false}, tally,
                                      [&](const VelocitiesCall &c, const Unit &unit, Tally &own) {
                                          work_on_long(c, unit.lanes[0], team, store, own);
                                      });
    }
};

[[noreturn, gnu::noinline]] void throw_error_of(const Chains &chains, const Tally &tally, const VelocitiesCall &call) {
    const NamedArray arrays[] = {{"position", &call.r}, {"velocity", &call.v}};
    throw_error(chains, tally,
                [&](const Tally &bad) { return diagnose(chains, bad, chains.box, arrays, 2, Status::not_finite); });
}

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
    if (tally.n_bad > 0) throw_error_of(chains, tally, call);
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
