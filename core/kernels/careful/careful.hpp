// The careful solver: one molecule of any shape by itself, right whatever its conditioning, in twice the precision.
//
// Each function reads the molecule's atoms from the arrays of the call, in any layout and box, solves, writes what the
// call wants of it and adds to the tally. A bad molecule is noted in the tally, and nothing of it is written.
// `scratch`: plan.scratch_bytes, aligned to 64. G is not written for atoms that the lane marks as shared, nor r and v
// for those that are fixed.
#ifndef HOLONOMIC_KERNELS_CAREFUL_CAREFUL_HPP
#define HOLONOMIC_KERNELS_CAREFUL_CAREFUL_HPP

#include "core/kernels/call.hpp"
#include "core/kernels/careful/plan.hpp"
#include "core/kernels/isa/target.hpp"

namespace holonomic {
namespace HOL_ISA {
namespace careful {

void forces(const ForcesCall &, const CarefulPlan &, const MoleculeLane &, double *scratch, Tally &);
void velocities(const VelocitiesCall &, const CarefulPlan &, const MoleculeLane &, double *scratch, Tally &);
void positions(const PositionsCall &, const CarefulPlan &, const MoleculeLane &, double *scratch, Tally &);
void metric(const MetricCall &, const CarefulPlan &, const MoleculeLane &, double *scratch, Tally &);
void solve(const SolveCall &, const CarefulPlan &, const MoleculeLane &, double *scratch, Tally &);

}  // namespace careful
}  // namespace HOL_ISA
}  // namespace holonomic
#endif
