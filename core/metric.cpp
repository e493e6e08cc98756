#include "core/metric.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/caller/box.hpp"
#include "core/molecules/given/memory_limit.hpp"
#include "core/rigid/parts.hpp"
#include "core/rigid/verbs.hpp"
#include "core/run/diagnose.hpp"
#include "core/run/execute.hpp"
#include "core/run/outcomes.hpp"
#include "core/run/rescale.hpp"
#include "core/run/staging.hpp"

namespace holonomic {

namespace {

struct MetricWork final : Work {
    const Variants<MetricCall> calls;
    const Kernels &k = kernels();
    const std::int64_t extended_bytes;  // that others do without
    MetricWork(const MetricCall &call, Staging &staging, std::int64_t bytes)
        : calls(
              call, staging, [](MetricCall &) {},
              [&](MetricCall &c) {
                  c.r = staging.atoms(call.r);
                  c.force = staging.summed_atoms(call.force, call.add);
              }),
          extended_bytes(bytes) {}
    std::int64_t scratch_bytes() const override { return extended_bytes; }
    void unit(const Unit &unit, int where, double *scratch, Tally &tally) const override {
        kernels(unit).metric(calls[where], unit, scratch, tally);
    }
    void unit(const MoleculeUnit &unit, int where, double *scratch, Tally &tally) const override {
        k.molecules.metric(calls[where], unit, scratch, tally);
    }
    bool rescales() const override { return true; }
    bool again(const Unit &one, int where, double *scratch, Tally &tally) const override {
        return in_ordinary_units(calls[where], one, tally, [&](const MetricCall &c, const Unit &unit, Tally &own) {
            kernels(unit).metric(c, unit, scratch, own);
        });
    }
    bool again(const MoleculeUnit &one, int where, double *scratch, Tally &tally) const override {
        return in_ordinary_units(calls[where], one, tally,
                                 [&](const MetricCall &c, const MoleculeUnit &unit, Tally &own) {
                                     k.molecules.metric(c, unit, scratch, own);
                                 });
    }
    bool again(const Lane &lane, int where, const Team &team, double *store, Tally &tally) const override {
        const auto run = [&](const MetricCall &c, const Unit &unit, Tally &own) {
            solve_long_chain(k.long_metric, kernels_for_one_chain().metric, c, unit.lanes[0], team, store, own);
        };
        return in_ordinary_units(calls[where], Unit{&lane, 1, false, false}, tally, run);
    }
    // ln det Z is of the caller's units: Z is of lengths squared over masses.
    template <class AnyUnit, class Run>
    static bool in_ordinary_units(const MetricCall &call, const AnyUnit &one, Tally &tally, const Run &run) {
        const KernelMolecule molecule = one_of(one);
        double log_det = 0, log_det_z = 0;
        const bool good = work_in_ordinary_units(call, one, tally, [&](MetricCall c, const AnyUnit &unit, Tally &own) {
            c.log_det = &log_det;
            c.log_det_z = &log_det_z;
            run(c, unit, own);
        });
        Powers units;
        if (!good || !find_units(molecule, call, units)) return false;
        const double per_bond = 0.693147180559945309417 * (2 * units.length - units.mass);
        if (call.log_det) call.log_det[molecule.number] = log_det;
        if (call.log_det_z)
            call.log_det_z[molecule.number] = log_det_z + static_cast<double>(molecule.n_bonds) * per_bond;
        return true;
    }
    std::int64_t long_blocks(std::int64_t n) const override { return k.long_metric.blocks(n); }
    std::int64_t long_bytes(std::int64_t n) const override { return store_bytes(k.long_metric, n); }
    void long_chain(const Lane &lane, int where, const Team &team, double *store, Tally &tally) const override {
        solve_long_chain(k.long_metric, kernels_for_one_chain().metric, calls[where], lane, team, store, tally);
    }
};

// What the metric of a molecule takes of scratch memory beside other calls: a network needs the factor that these do
// without, an atom of many bonds the elements of the inverse between all of them.
std::int64_t more_scratch(const Chains &chains, const EliminationPlan &s) {
    const char *const kind = s.network ? "network" : "molecule";
    try {
        const EliminationPlan &order =
            s.network && !s.extended ? make_extended(s, memory_left(chains)) : *extended_order(s);
        if (!s.network && order.more_of_metric == 0) return 0;
        const std::int64_t bytes =
            (s.network ? order.extended_bytes : chains.plan().scratch_bytes) + order.more_of_metric;
        if (bytes > memory_left(chains)) throw TooMuchMemory(bytes);
        return bytes;
    } catch (const TooMuchMemory &needed) {
        char what[64];
        std::snprintf(what, sizeof what, "the metric of a %s of %d bonds", kind, static_cast<int>(s.n_bonds));
        throw too_much_memory(chains, what, needed.bytes);
    }
}

// Returns the sum of ln det.
double metric_of_bonds(const Chains &chains, MetricCall &call) {
    put_box(chains.box, call.box);
    std::int64_t extended_bytes = 0;
    for (const std::int32_t shape : chains.plan().shapes) {
        const EliminationPlan &s = *chains.plan().elimination_plans[static_cast<std::size_t>(shape)];
        extended_bytes = std::max(extended_bytes, more_scratch(chains, s));
    }
    Staging staging(chains);
    const Tally tally = execute(chains, MetricWork(call, staging, extended_bytes));
    staging.put_back();
    if (tally.n_bad > 0) {
        const NamedArray arrays[] = {{"position", &call.r}};
        throw_error(chains, tally,
                    [&](const Tally &bad) { return diagnose(chains, bad, chains.box, arrays, 1, Status::not_finite); });
    }
    return tally.log_det;
}

void metric_of_all(const Chains &chains, MetricCall &call, double *energy) {
    if (!(call.kT >= 0) || !std::isfinite(call.kT))
        throw make_error(Status::value, "kT is %g; it must be finite and not negative", call.kT);
    rigid::need_metric(chains);
    call.sum = energy != nullptr;
    double sum = 0;
    rigid::over_all(
        chains, call.add ? nullptr : &call.force, [&] { sum += metric_of_bonds(chains, call); },
        [&] { sum += rigid::metric(chains, call); });
    if (energy) *energy = 0.5 * call.kT * sum;
}

}  // namespace

void metric(const Chains &chains, MetricCall &call, double *energy) {
    with_outcomes(chains, [&] { metric_of_all(chains, call, energy); });
}

}  // namespace holonomic
