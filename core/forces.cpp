#include "core/forces.hpp"

#include "core/caller/box.hpp"
#include "core/caller/view.hpp"
#include "core/run/apart.hpp"
#include "core/run/diagnose.hpp"
#include "core/run/execute.hpp"

namespace holonomic {

namespace {

struct ForcesWork final : Work {
    const Variants<ForcesCall> calls;
    const Kernels &k = kernels();
    ForcesWork(const ForcesCall &call, Apart &apart)
        : calls(
              call, apart,
              [&](ForcesCall &c) {
                  c.lambda = apart.results(call.lambda);
                  c.tension = apart.results(call.tension);
              },
              [&](ForcesCall &c) {
                  c.r = apart.atoms(call.r);
                  c.v = apart.atoms(call.v);
                  c.f = apart.atoms(call.f);
                  c.g = apart.summed_atoms(call.g, call.add);
              }) {}
    void unit(const Unit &unit, int where, double *scratch, Tally &tally) const override {
        kernels(unit).forces(calls[where], unit, scratch, tally);
    }
    void unit(const MoleculeUnit &unit, int where, double *scratch, Tally &tally) const override {
        k.molecules.forces(calls[where], unit, scratch, tally);
    }
    int images(int where, Images *images) const override {
        images[0] = {&calls[where].r, &calls[where].box};
        return 1;
    }
    std::int64_t long_blocks(std::int64_t n) const override { return k.long_forces.blocks(n); }
    std::int64_t long_bytes(std::int64_t n) const override { return k.long_forces.bytes(n); }
    void long_chain(const Lane &lane, int where, const Team &team, double *store, Tally &tally) const override {
        solve_long_chain(k.long_forces, calls[where], lane, team, store, tally);
    }
};

}  // namespace

void forces(const Chains &chains, const AtomArray &r, const AtomArray &v, const AtomArray &f, double *lambda,
            double *tension, const AtomArray &g, bool add, double *virial) {
    ForcesCall call;
    call.r = r;
    call.v = v;
    call.f = f;
    call.g = g;
    call.lambda = lambda;
    call.tension = tension;
    call.add = add;
    call.virial = virial != nullptr;
    put_box(chains.box, call.box);
    AtomArray *const inputs[] = {&call.r, &call.v, &call.f};
    unify_layout(inputs, 3);
    Apart apart(chains);
    const Tally tally = execute(chains, ForcesWork(call, apart));
    apart.put_back();
    clear_unconstrained(chains, lambda);
    clear_unconstrained(chains, tension);
    if (tally.n_bad > 0) {
        const NamedArray arrays[] = {{"position", &r}, {"velocity", &v}, {"force", &f}};
        throw diagnose(chains, tally, chains.box, arrays, 3, Status::not_finite);
    }
    if (virial) write_virial(tally, virial);
}

}  // namespace holonomic
