#include "core/positions.hpp"

#include "core/caller/box.hpp"
#include "core/caller/view.hpp"
#include "core/run/apart.hpp"
#include "core/run/diagnose.hpp"
#include "core/run/execute.hpp"

namespace holonomic {

namespace {

struct PositionsWork final : Work {
    const Variants<PositionsCall> calls;
    const Kernels &k = kernels();
    PositionsWork(const PositionsCall &call, Apart &apart)
        : calls(
              call, apart, [&](PositionsCall &c) { c.lambda = apart.results(call.lambda); },
              [&](PositionsCall &c) {
                  c.r_ref = apart.atoms(call.r_ref);
                  c.r = apart.moved_atoms(call.r);
                  c.v = apart.moved_atoms(call.v);
              }) {}
    void unit(const Unit &unit, int where, double *scratch, Tally &tally) const override {
        kernels(unit).positions(calls[where], unit, scratch, tally);
    }
    void unit(const MoleculeUnit &unit, int where, double *scratch, Tally &tally) const override {
        k.molecules.positions(calls[where], unit, scratch, tally);
    }
    int images(int where, Images *images) const override {
        images[0] = {&calls[where].r_ref, &calls[where].box_ref};
        images[1] = {&calls[where].r, &calls[where].box};
        return 2;
    }
    bool shares_lists() const override { return true; }
    std::int64_t long_blocks(std::int64_t n) const override { return k.long_positions.blocks(n); }
    std::int64_t long_bytes(std::int64_t n) const override { return store_bytes(k.long_positions, n); }
    void long_chain(const Lane &lane, int where, const Team &team, double *store, Tally &tally) const override {
        solve_long_chain(k.long_positions, kernels_for_one_chain().positions, calls[where], lane, team, store, tally);
    }
};

}  // namespace

void project_positions(const Chains &chains, const AtomArray &r_ref, const AtomArray &r, const AtomArray &v, double dt,
                       double *lambda, bool guess, double *virial, Report *report) {
    PositionsCall call;
    call.r_ref = r_ref;
    call.r = r;
    call.v = v;
    call.lambda = lambda;
    call.dt = dt;
    call.guess = guess;
    call.virial = virial != nullptr;
    call.report = report != nullptr;
    call.tolerance = chains.tolerance;
    call.max_iterations = chains.max_iterations;
    put_box(chains.box, call.box);
    put_box(chains.box_of_reference(), call.box_ref);
    Apart apart(chains);
    const Tally tally = execute(chains, PositionsWork(call, apart));
    apart.put_back();
    clear_unconstrained(chains, lambda);
    if (report) {
        const bool none = tally.worst_chain < 0;
        *report = {tally.iterations,
                   tally.n_corrected,
                   tally.n_bad,
                   none ? -1 : tally.worst_chain + chains.base,
                   none ? -1 : tally.worst_bond + chains.base,
                   tally.worst,
                   true};
    }
    if (tally.n_bad > 0) {
        const NamedArray arrays[] = {{"reference position", &r_ref}, {"position", &r}, {"velocity", &v}};
        throw diagnose(chains, tally, chains.box_of_reference(), arrays, 3, Status::no_convergence);
    }
    if (virial) write_virial(tally, virial);
}

}  // namespace holonomic
