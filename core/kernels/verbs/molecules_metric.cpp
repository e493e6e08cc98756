// Metric determinant and Fixman force of molecules that are no chains, one by one.
#include "core/kernels/careful/careful.hpp"
#include "core/kernels/molecules/schedule.hpp"
#include "core/kernels/verbs/verbs.hpp"

namespace holonomic::HOL_ISA {

void molecules_metric(const MetricCall &call, const MoleculeUnit &unit, double *scratch, Tally &tally) {
    const Schedule &schedule = *unit.schedule;
    for (int64_t i = 0; i < unit.count; ++i) {
        MoleculeLane lane = unit.lanes[unit.regular ? 0 : i];
        if (unit.regular) {
            lane.first_atom += i * schedule.n_atoms;
            if (lane.atoms) lane.atoms += i * schedule.n_atoms;
            lane.molecule += i;
        }
        const CarefulPlan &plan = *(schedule.careful ? schedule.careful : schedule.late_careful);
        HOL_CAREFUL::careful::metric(call, plan, lane, scratch, tally);
    }
}

}  // namespace holonomic::HOL_ISA
