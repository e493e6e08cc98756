// the extended-precision solver does one molecule of any shape by itself, in twice the precision. It is right whatever
// the conditioning is: it notes what cancels (digits_lost.hpp), and where that is too much, `quad_double`, the same
// code compiled once for numbers of four times the precision, does the molecule again.
//
// Each function reads the molecule's atoms in any layout and box, solves, writes the outputs of the call and adds to
// the tally. It notes a bad molecule in the tally and writes nothing of it. `scratch` has extended_scratch_bytes() less
// the plan's, aligned to 64. G of atoms that the lane marks as shared is not written, nor are r and v of fixed atoms.
#pragma once

#include "core/kernels/call.hpp"
#include "core/kernels/extended/plan.hpp"
#include "core/kernels/isa/target.hpp"

// The five verbs of a set.
#define HOL_DECLARE_EXTENDED(isa)                                                                                  \
    namespace holonomic {                                                                                          \
    namespace isa {                                                                                                \
    namespace extended {                                                                                           \
    void forces(const ForcesCall &, const ExtendedPlan &, const MoleculeLane &, double *scratch, Tally &);         \
    void velocities(const VelocitiesCall &, const ExtendedPlan &, const MoleculeLane &, double *scratch, Tally &); \
    void positions(const PositionsCall &, const ExtendedPlan &, const MoleculeLane &, double *scratch, Tally &);   \
    void metric(const MetricCall &, const ExtendedPlan &, const MoleculeLane &, double *scratch, Tally &);         \
    void solve(const SolveCall &, const ExtendedPlan &, const MoleculeLane &, double *scratch, Tally &);           \
    }                                                                                                              \
    }                                                                                                              \
    }

HOL_DECLARE_EXTENDED(HOL_EXTENDED)
#ifndef HOL_QUAD_DOUBLE
HOL_DECLARE_EXTENDED(quad_double)
#endif
