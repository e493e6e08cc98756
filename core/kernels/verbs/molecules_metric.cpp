// Metric determinant and Fixman force of molecules that are no chains: of trees in lanes, of others one by one by the
// careful solver.
#include "core/kernels/molecules/blocks.hpp"
#include "core/kernels/molecules/tree/metric.hpp"
#include "core/kernels/verbs/verbs.hpp"

namespace holonomic::HOL_ISA {

using namespace graph;

namespace {

void careful_metric(const MetricCall &call, const Schedule &schedule, const MoleculeLane &lane, double *scratch,
                    Tally &tally) {
    const CarefulPlan &plan = *(schedule.careful ? schedule.careful : schedule.late_careful);
    HOL_CAREFUL::careful::metric(call, plan, lane, scratch, tally);
}

struct TreeMetricWork {
    const MetricCall &call;
    const Schedule &schedule;
    Tally &tally;

    template <class V>
    void block(const MoleculeLane *lane, int used, bool, double *scratch) const {
        unsigned rest;
        {
            TreeMetric<V> x(call, schedule, lane, used, {scratch});
            const unsigned all = bits(Width<V>::first(used)), good = bits(x.solve()) & all;
            x.write(good, tally);
            rest = all & ~good;
        }
        for (; rest; rest &= rest - 1) careful_metric(call, schedule, lane[__builtin_ctz(rest)], scratch, tally);
    }
};

}  // namespace

int64_t tree_metric_bytes(const Schedule &s) {
    if (s.type != Schedule::tree) return 0;
    return s.n_bonds <= largest_in_lanes ? TreeMetric<vec>::values(s) * static_cast<int64_t>(sizeof(vec))
                                         : TreeMetric<double>::values(s) * static_cast<int64_t>(sizeof(double));
}

void molecules_metric(const MetricCall &call, const MoleculeUnit &unit, double *scratch, Tally &tally) {
    const Schedule &schedule = *unit.schedule;
    if (schedule.type == Schedule::tree && schedule.max_children <= most_decomposed) {
        const TreeMetricWork work = {call, schedule, tally};
        return for_each_block(unit, scratch, work);
    }
    for (int64_t i = 0; i < unit.count; ++i) careful_metric(call, schedule, molecule_of(unit, i), scratch, tally);
}

}  // namespace holonomic::HOL_ISA
