// One large molecule as a network of strands and nodes: the three levels, and kept factors. False where that has not
// converged: then nothing has been written.
#pragma once

#include "core/kernels/call.hpp"
#include "core/kernels/molecules/blocks.hpp"
#include "core/kernels/molecules/flagged.hpp"
#include "core/kernels/tally.hpp"

namespace holonomic::HOL_NETWORKS {

int64_t network_bytes(const NetworkPlan &);
bool solve_network(const ForcesCall &, const EliminationPlan &, const MoleculeLane &, bool packed, const LongTeam *,
                   double *scratch, Tally &);
bool solve_network(const SolveCall &, const EliminationPlan &, const MoleculeLane &, bool packed, const LongTeam *,
                   double *scratch, Tally &);
bool solve_network(const VelocitiesCall &, const EliminationPlan &, const MoleculeLane &, bool packed, const LongTeam *,
                   double *scratch, Tally &);
bool solve_network(const PositionsCall &, const EliminationPlan &, const MoleculeLane &, bool packed, const LongTeam *,
                   double *scratch, Tally &);
// Factors that are kept, and solves with them. The first is false where nothing is kept.
bool keep_network(const KeepCall &, const EliminationPlan &, const MoleculeLane &, const LongTeam *, double *scratch);
bool solve_kept_network(const KeptCall &, const EliminationPlan &, const MoleculeLane &, const LongTeam *,
                        double *scratch, Tally &);

}  // namespace holonomic::HOL_NETWORKS

namespace holonomic::HOL_ISA {

// All networks of a unit.
template <class Call>
static inline void solve_networks(const Call &call, const MoleculeUnit &unit, bool packed, double *scratch,
                                  Tally &tally) {
    for (int64_t i = 0; i < unit.count; ++i) {
        const MoleculeLane lane = graph::molecule_of(unit, i);
        if (HOL_NETWORKS::solve_network(call, *unit.elimination, lane, packed, unit.team, scratch, tally)) continue;
        if (unit.elimination->extended)
            graph::solve_flagged(call, *unit.elimination, &lane, 1, scratch, tally);
        else
            note_bad(lane.molecule, tally);
    }
}

}  // namespace holonomic::HOL_ISA
