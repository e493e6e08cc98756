#include "core/metric.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/caller/box.hpp"
#include "core/molecules/memory_limit.hpp"
#include "core/rigid/parts.hpp"
#include "core/rigid/verbs.hpp"
#include "core/run/diagnose.hpp"
#include "core/run/outcomes.hpp"
#include "core/run/verb_work.hpp"

namespace holonomic {

namespace {

struct MetricWork final : VerbWork<MetricCall, &MoleculeKernels::metric, &Kernels::metric, &Kernels::long_metric> {
    const std::int64_t extended_bytes;  // that others do without
    MetricWork(const MetricCall &call, Staging &staging, std::int64_t bytes)
        : VerbWork(
              call, staging, [](MetricCall &) {},
              [&](MetricCall &c) {
                  c.r = staging.atoms(call.r);
                  c.force = staging.summed_atoms(call.force, call.add);
              }),
          extended_bytes(bytes) {}
    std::int64_t scratch_bytes() const override { return extended_bytes; }
    bool walks_batches() const override { return false; }
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
    if (tally.n_bad > 0) throw_diagnosis(chains, tally, {{"position", &call.r}});
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
