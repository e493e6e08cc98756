// Metric determinant and Fixman force of molecules that are no chains: of trees and bare rings in
// lanes, of others one by one by the extended-precision solver.
#include "core/kernels/extended/plan_of.hpp"
#include "core/kernels/extended/verbs.hpp"
#include "core/kernels/molecules/metric/ring.hpp"
#include "core/kernels/molecules/metric/tree.hpp"
#include "core/kernels/verbs/verbs.hpp"

namespace holonomic::HOL_ISA {

using namespace graph;

namespace {

void extended_metric(const MetricCall &call, const EliminationPlan &elimination, const MoleculeLane &lane,
                     double *scratch, Tally &tally) {
    extended::ByteArena memory = {reinterpret_cast<char *>(scratch)};
    const ExtendedPlan plan = extended::plan_of(*extended_order(elimination), memory);
    HOL_EXTENDED::extended::metric(call, plan, lane, reinterpret_cast<double *>(memory.next), tally);
}

// Shape: TreeMetric or RingMetric.
template <template <class> class Shape>
struct MetricOfBlocks {
    const MetricCall &call;
    const EliminationPlan &elimination;
    Tally &tally;

    template <class V>
    void block(const MoleculeLane *lane, int used, bool, double *scratch) const {
        Shape<V> x(call, elimination, lane, used, {scratch});
        const unsigned all = bits(Width<V>::first(used)), good = bits(x.solve()) & all;
        x.write(good, tally);
        // Its memory is free now.
        for (unsigned rest = all & ~good; rest; rest &= rest - 1)
            extended_metric(call, elimination, lane[__builtin_ctz(rest)], scratch, tally);
    }
};

}  // namespace

int64_t metric_bytes(const EliminationPlan &s) {
    if (s.way.metric == Way::extended) return 0;
    return s.n_bonds <= largest_in_lanes ? Metric<vec>::values(s) * static_cast<int64_t>(sizeof(vec))
                                         : Metric<double>::values(s) * static_cast<int64_t>(sizeof(double));
}

void molecules_metric(const MetricCall &call, const MoleculeUnit &unit, double *scratch, Tally &tally) {
    const EliminationPlan &elimination = *unit.elimination;
    NextMolecules ahead;  // its arithmetic takes longer than its memory
    if (elimination.way.metric == Way::tree) {
        const MetricOfBlocks<TreeMetric> work = {call, elimination, tally};
        return for_each_block(unit, scratch, ahead, work);
    }
    if (elimination.way.metric == Way::ring) {
        const MetricOfBlocks<RingMetric> work = {call, elimination, tally};
        return for_each_block(unit, scratch, ahead, work);
    }
    for (int64_t i = 0; i < unit.count; ++i) extended_metric(call, elimination, molecule_of(unit, i), scratch, tally);
}

}  // namespace holonomic::HOL_ISA
