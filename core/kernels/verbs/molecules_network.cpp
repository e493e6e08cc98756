// Networks (molecules/network/): their equations for all verbs, compiled once.
#include "core/kernels/molecules/network/kept.hpp"
#include "core/kernels/molecules/network/positions.hpp"
#include "core/kernels/molecules/network/verbs.hpp"
#include "core/kernels/verbs/verbs.hpp"

namespace holonomic::HOL_ISA {

using namespace graph;

int64_t network_bytes(const NetworkPlan &s) {
    const int64_t linear = NetLinear::values(s), newton = NetPositions::values(s);
    return static_cast<int64_t>(sizeof(double)) * (linear > newton ? linear : newton);
}

// Call: of forces, of given right-hand sides, or of velocities.
template <class Call>
static inline bool linear_network(const Call &call, const EliminationPlan &s, const MoleculeLane &lane, bool packed,
                                  const LongTeam *team, double *scratch, Tally &tally) {
    const RightHandSides rhs = right_hand_sides_of(call);
    const NetLinear x(*s.network, lane, packed, team, call.box, call.r, rhs.in, rhs.terms, {scratch});
    if (solve_linear(call, x, tally, [] {})) return false;
    count_moved(tally, 0, x.rounds);
    return true;
}
bool solve_network(const ForcesCall &call, const EliminationPlan &s, const MoleculeLane &lane, bool packed,
                   const LongTeam *team, double *scratch, Tally &tally) {
    return linear_network(call, s, lane, packed, team, scratch, tally);
}
bool solve_network(const SolveCall &call, const EliminationPlan &s, const MoleculeLane &lane, bool packed,
                   const LongTeam *team, double *scratch, Tally &tally) {
    return linear_network(call, s, lane, packed, team, scratch, tally);
}
bool solve_network(const VelocitiesCall &call, const EliminationPlan &s, const MoleculeLane &lane, bool packed,
                   const LongTeam *team, double *scratch, Tally &tally) {
    return linear_network(call, s, lane, packed, team, scratch, tally);
}

bool keep_network(const KeepCall &call, const EliminationPlan &s, const MoleculeLane &lane, const LongTeam *team,
                  double *scratch) {
    double *const room = call.kept->room(call.kept->owner, lane.molecule, KeptNetwork::doubles(*s.network));
    if (!room) return false;
    const KeptNetwork kept = {room};
    const Inputs none = {};
    kept.keep(NetLinear(*s.network, lane, true, team, call.box, call.r, none, 0, kept.memory(), {scratch}));
    return kept.is_good();
}
bool solve_kept_network(const KeptCall &call, const EliminationPlan &s, const MoleculeLane &lane, const LongTeam *team,
                        double *scratch, Tally &tally) {
    const KeptNetwork kept = {const_cast<double *>(call.kept->block[lane.molecule])};
    if (!kept.is_good()) return true;  // that is left already
    const RightHandSides rhs = right_hand_sides_of(call);
    NetLinear x(*s.network, lane, true, team, *call.kept->box, call.kept->r, rhs.in, rhs.terms, kept.memory(),
                {scratch});
    kept.lend_to(x);
    return solve_linear(call, x, tally, [] {}) == 0;
}

bool solve_network(const PositionsCall &call, const EliminationPlan &s, const MoleculeLane &lane, bool packed,
                   const LongTeam *team, double *scratch, Tally &tally) {
    NetPositions x(call, *s.network, s.fixed, lane, packed, team, {scratch}, tally);
    return solve_positions(x, ScalarMask{true}, [] {}) == 0;
}

}  // namespace holonomic::HOL_ISA
