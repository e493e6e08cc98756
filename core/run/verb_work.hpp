// What a verb asks of the kernels by its entries in their table: of molecules of any shape, of chains in lanes and of
// longer ones, and of each once more in ordinary units. The core has one class per verb, which says what is its own.
#pragma once

#include "core/run/execute.hpp"
#include "core/run/rescale.hpp"
#include "core/run/staging.hpp"

namespace holonomic {

template <class Call, auto of_molecules>
class MoleculeWork : public Work {
public:
    using Work::again;
    using Work::unit;
    // `values` and `atoms` replace the arrays of variants (staging.hpp).
    template <class Values, class Atoms>
    MoleculeWork(const Call &call, const Staging &staging, Values values, Atoms atoms)
        : calls(call, staging, values, atoms) {}

    void unit(const MoleculeUnit &unit, int where, double *scratch, Tally &tally) const override {
        (k.molecules.*of_molecules)(calls[where], unit, scratch, tally);
    }
    bool walks_batches() const override { return true; }
    bool rescales() const override { return true; }
    bool again(const MoleculeUnit &one, int where, double *scratch, Tally &tally) const override {
        return work_in_ordinary_units(calls[where], one, tally,
                                      [&](const Call &c, const MoleculeUnit &unit, Tally &own) {
                                          (k.molecules.*of_molecules)(c, unit, scratch, own);
                                      });
    }

protected:
    ~MoleculeWork() = default;
    const Variants<Call> calls;
    const Kernels &k = kernels();
};

template <class Call, auto of_molecules, auto of_chains, auto of_long_chains>
class VerbWork : public MoleculeWork<Call, of_molecules> {
public:
    using Base = MoleculeWork<Call, of_molecules>;
    using Base::again;
    using Base::Base;
    using Base::calls;
    using Base::k;
    using Base::unit;

    void unit(const Unit &unit, int where, double *scratch, Tally &tally) const override {
        (kernels(unit).*of_chains)(calls[where], unit, scratch, tally);
    }
    std::int64_t long_blocks(std::int64_t n) const override { return (k.*of_long_chains).blocks(n); }
    std::int64_t long_bytes(std::int64_t n) const override { return store_bytes(k.*of_long_chains, n); }
    void long_chain(const Lane &lane, int where, const Team &team, double *store, Tally &tally) const override {
        solve_long(calls[where], lane, team, store, tally);
    }
    bool again(const Unit &one, int where, double *scratch, Tally &tally) const override {
        return work_in_ordinary_units(calls[where], one, tally, [&](const Call &c, const Unit &unit, Tally &own) {
            (kernels(unit).*of_chains)(c, unit, scratch, own);
        });
    }
    bool again(const Lane &lane, int where, const Team &team, double *store, Tally &tally) const override {
        return work_in_ordinary_units(
            calls[where], Unit{&lane, 1, false, false}, tally,
            [&](const Call &c, const Unit &unit, Tally &own) { solve_long(c, unit.lanes[0], team, store, own); });
    }

protected:
    ~VerbWork() = default;
    // Out of line: two functions call it, and a chain is long.
    [[gnu::noinline]] virtual void solve_long(const Call &call, const Lane &lane, const Team &team, double *store,
                                              Tally &tally) const {
        solve_long_chain(k.*of_long_chains, kernels_for_one_chain().*of_chains, call, lane, team, store, tally);
    }
};

}  // namespace holonomic
