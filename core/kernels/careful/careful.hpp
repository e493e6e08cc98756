// The careful solver does one molecule of any shape by itself, in twice the precision. It is right whatever the
// conditioning is: it notes what cancels (digits_lost.hpp), and where that is too much, `fourfold`, the same code
// compiled once for numbers of four times the precision, does the molecule again.
//
// Each function reads the molecule's atoms in any layout and box, solves, writes the outputs of the call and adds to
// the tally. It notes a bad molecule in the tally and writes nothing of it. `scratch` has careful_scratch_bytes() less
// the plan's, aligned to 64. G of atoms that the lane marks as shared is not written, nor are r and v of fixed atoms.
#pragma once

#include "core/kernels/call.hpp"
#include "core/kernels/careful/plan.hpp"
#include "core/kernels/isa/target.hpp"

// The five verbs of a set.
#define HOL_DECLARE_CAREFUL(isa)                                                                                  \
    namespace holonomic {                                                                                         \
    namespace isa {                                                                                               \
    namespace careful {                                                                                           \
    void forces(const ForcesCall &, const CarefulPlan &, const MoleculeLane &, double *scratch, Tally &);         \
    void velocities(const VelocitiesCall &, const CarefulPlan &, const MoleculeLane &, double *scratch, Tally &); \
    void positions(const PositionsCall &, const CarefulPlan &, const MoleculeLane &, double *scratch, Tally &);   \
    void metric(const MetricCall &, const CarefulPlan &, const MoleculeLane &, double *scratch, Tally &);         \
    void solve(const SolveCall &, const CarefulPlan &, const MoleculeLane &, double *scratch, Tally &);           \
    }                                                                                                             \
    }                                                                                                             \
    }

HOL_DECLARE_CAREFUL(HOL_CAREFUL)
#ifndef HOL_FOURFOLD
HOL_DECLARE_CAREFUL(fourfold)
#endif
