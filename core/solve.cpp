#include "core/solve.hpp"

#include <cmath>

#include "core/forces.hpp"
#include "core/run/apart.hpp"
#include "core/run/diagnose.hpp"
#include "core/run/execute.hpp"

namespace holonomic {

namespace {

struct SolveWork final : Work {
    const Variants<SolveCall> calls;
    const Kernels &k = kernels();
    SolveWork(const SolveCall &call, Apart &apart)
        : calls(
              call, apart,
              [&](SolveCall &c) {
                  c.rhs = apart.inputs(call.rhs);
                  c.lambda = apart.results(call.lambda);
              },
              [&](SolveCall &c) {
                  c.r = apart.atoms(call.r);
                  c.g = apart.summed_atoms(call.g, call.add);
              }) {}
    void unit(const MoleculeUnit &unit, int where, double *scratch, Tally &tally) const override {
        k.molecules.solve(calls[where], unit, scratch, tally);
    }
    // The plan has no linear chains.
    void unit(const Unit &, int, double *, Tally &) const override {}
    int images(int where, Images *images) const override {
        images[0] = {&calls[where].r, &calls[where].box};
        return 1;
    }
    std::int64_t long_blocks(std::int64_t) const override { return 0; }
    std::int64_t long_bytes(std::int64_t) const override { return 0; }
    void long_chain(const Lane &, int, const Team &, double *, Tally &) const override {}
};

// A right-hand side that is not finite, which the other arrays don't show.
void check_rhs(const Chains &chains, const Tally &tally, const double *rhs) {
    const Molecule m = chains.molecule(tally.first_bad);
    for (std::int64_t k = 0; k < m.n_bonds; ++k) {
        if (std::isfinite(rhs[m.bond(k)])) continue;
        Error error =
            make_error(Status::not_finite, "molecule %lld: the right-hand side of bond %lld is not finite",
                       static_cast<long long>(m.number + chains.base), static_cast<long long>(k + chains.base));
        error.chain = m.number;
        error.bond = k;
        error.n_bad = tally.n_bad;
        error.base = chains.base;
        throw error;
    }
}

}  // namespace

void solve(const Chains &chains, const AtomArray &r, const double *rhs, double *lambda, const AtomArray &g, bool add,
           double *virial) {
    const SolveCall call{r, g, rhs, lambda, nullptr, add, virial != nullptr, chains.box};
    const Plan &plan = chains.plan_of_parts();
    Apart apart(chains, plan);
    const Tally tally = execute(chains, plan, SolveWork(call, apart));
    apart.put_back();
    clear_unconstrained(chains, lambda);
    if (tally.n_bad > 0) {
        check_rhs(chains, tally, rhs);  // a bad molecule's lambda was not written
        const NamedArray arrays[] = {{"position", &r}};
        throw diagnose(chains, tally, chains.box, arrays, 1, Status::not_finite);
    }
    if (virial) write_virial(tally, virial);
}

}  // namespace holonomic
