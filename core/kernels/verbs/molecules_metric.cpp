// Metric determinant and Fixman force of molecules that are no chains: of trees and bare rings in
// lanes, of others one by one by the careful solver.
#include "core/kernels/careful/plan_of.hpp"
#include "core/kernels/molecules/metric/ring_metric.hpp"
#include "core/kernels/molecules/metric/tree_metric.hpp"
#include "core/kernels/verbs/verbs.hpp"

namespace holonomic::HOL_ISA {

using namespace graph;

namespace {

void careful_metric(const MetricCall &call, const Schedule &schedule, const MoleculeLane &lane, double *scratch,
                    Tally &tally) {
    careful::Memory memory = {reinterpret_cast<char *>(scratch)};
    const CarefulPlan plan = careful::plan_of(*careful_order(schedule), memory);
    HOL_CAREFUL::careful::metric(call, plan, lane, reinterpret_cast<double *>(memory.next), tally);
}

// Shape: TreeMetric or RingMetric.
template <template <class> class Shape>
struct MetricWork {
    const MetricCall &call;
    const Schedule &schedule;
    Tally &tally;

    template <class V>
    void block(const MoleculeLane *lane, int used, bool, double *scratch) const {
        Shape<V> x(call, schedule, lane, used, {scratch});
        const unsigned all = bits(Width<V>::first(used)), good = bits(x.solve()) & all;
        x.write(good, tally);
        // Its memory is free now.
        for (unsigned rest = all & ~good; rest; rest &= rest - 1)
            careful_metric(call, schedule, lane[__builtin_ctz(rest)], scratch, tally);
    }
};

}  // namespace

int64_t metric_bytes(const Schedule &s) {
    if (s.way.metric == Way::careful) return 0;
    return s.n_bonds <= largest_in_lanes ? Metric<vec>::values(s) * static_cast<int64_t>(sizeof(vec))
                                         : Metric<double>::values(s) * static_cast<int64_t>(sizeof(double));
}

void molecules_metric(const MetricCall &call, const MoleculeUnit &unit, double *scratch, Tally &tally) {
    const Schedule &schedule = *unit.schedule;
    NextMolecules ahead;  // its arithmetic takes longer than its memory
    if (schedule.way.metric == Way::tree) {
        const MetricWork<TreeMetric> work = {call, schedule, tally};
        return for_each_block(unit, scratch, ahead, work);
    }
    if (schedule.way.metric == Way::ring) {
        const MetricWork<RingMetric> work = {call, schedule, tally};
        return for_each_block(unit, scratch, ahead, work);
    }
    for (int64_t i = 0; i < unit.count; ++i) careful_metric(call, schedule, molecule_of(unit, i), scratch, tally);
}

}  // namespace holonomic::HOL_ISA
