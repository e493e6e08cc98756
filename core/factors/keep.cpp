#include "core/factors/keep.hpp"

#include "core/run/apart.hpp"
#include "core/run/execute.hpp"
#include "core/run/lane.hpp"

namespace holonomic {

namespace {

// Chains that do not fit into lanes are left, and molecules of other shapes.
struct KeptWork : Work {
    const Kernels &k = kernels();
    unsigned char *const left;
    explicit KeptWork(unsigned char *marks) : left(marks) {}
    std::int64_t long_blocks(std::int64_t) const override { return 0; }
    std::int64_t long_bytes(std::int64_t) const override { return 0; }
    void long_chain(const Lane &lane, int, const Team &, double *, Tally &) const override { left[lane.chain] = 1; }
    bool is_left(const MoleculeUnit &unit) const {
        if (k.kept.is_kept(*unit.elimination)) return false;
        for (std::int64_t i = 0; i < unit.count; ++i) left[lane_of(unit, i).molecule] = 1;
        return true;
    }
};

struct KeepWork final : KeptWork {
    const KeepCall &call;
    explicit KeepWork(const KeepCall &c) : KeptWork(c.left), call(c) {}
    void unit(const Unit &unit, int, double *scratch, Tally &tally) const override {
        kernels(unit).kept.keep_chains(call, unit, scratch, tally);
    }
    void unit(const MoleculeUnit &unit, int, double *scratch, Tally &tally) const override {
        if (!is_left(unit)) k.kept.keep_molecules(call, unit, scratch, tally);
    }
};

struct SolveWork final : KeptWork {
    const Variants<KeptCall> calls;
    SolveWork(const KeptCall &call, Apart &apart)
        : KeptWork(call.left), calls(
                                   call, apart,
                                   [&](KeptCall &c) {
                                       c.rhs = apart.inputs(call.rhs);
                                       c.lambda = apart.results(call.lambda);
                                       c.tension = apart.results(call.tension);
                                   },
                                   [](KeptCall &) {}) {}
    void unit(const Unit &unit, int where, double *scratch, Tally &tally) const override {
        kernels(unit).kept.solve_chains(calls[where], unit, scratch, tally);
    }
    void unit(const MoleculeUnit &unit, int where, double *scratch, Tally &tally) const override {
        if (k.kept.is_kept(*unit.elimination)) k.kept.solve_molecules(calls[where], unit, scratch, tally);
    }
    void long_chain(const Lane &, int, const Team &, double *, Tally &) const override {}
};

}  // namespace

void keep(const Chains &chains, const KeepCall &call) { execute(chains, KeepWork(call)); }

Tally solve_kept(const Chains &chains, const KeptCall &call) {
    Apart apart(chains);
    const Tally tally = execute(chains, SolveWork(call, apart));
    apart.put_back();
    clear_unconstrained(chains, call.lambda);
    clear_unconstrained(chains, call.tension);
    return tally;
}

}  // namespace holonomic
