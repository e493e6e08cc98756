// Networks (molecules/network/): their equations for all verbs, compiled once.
#include "core/kernels/molecules/network/linear.hpp"
#include "core/kernels/molecules/network/positions.hpp"
#include "core/kernels/molecules/network/verbs.hpp"
#include "core/kernels/verbs/verbs.hpp"

namespace holonomic::HOL_ISA {

using namespace graph;

int64_t network_bytes(const NetworkPlan &s) {
    const int64_t linear = NetLinear::values(s), newton = NetPositions::values(s);
    return static_cast<int64_t>(sizeof(double)) * (linear > newton ? linear : newton);
}

// Call: of forces or of given right-hand sides.
template <class Call>
static inline bool pull_network(const Call &call, const NetLinear &x, Tally &tally) {
    if (!x.solve()) return false;
    count_moved(tally, 0, x.rounds);
    if (call.virial) x.add_virial(tally);
    x.net.for_rest_and_parts([&](const NetPart &part) {
        if (call.lambda) x.write_bonds(part, 0.5, false, call.lambda);
        if (call.tension) x.write_bonds(part, 1, true, call.tension);
        if (call.g.x) x.write_pulls(part, call.g, call.add);
    });
    return true;
}

bool solve_network(const ForcesCall &call, const EliminationPlan &s, const MoleculeLane &lane, bool packed,
                   const LongTeam *team, double *scratch, Tally &tally) {
    const Inputs in = {&call.v, &call.f, nullptr, false};
    const int terms = (call.v.x ? squares : 0) | (call.f.x ? pulls : 0);
    return pull_network(call, NetLinear(*s.network, lane, packed, team, call.box, call.r, in, terms, {scratch}), tally);
}

bool solve_network(const SolveCall &call, const EliminationPlan &s, const MoleculeLane &lane, bool packed,
                   const LongTeam *team, double *scratch, Tally &tally) {
    const Inputs in = {nullptr, nullptr, call.rhs, false};
    return pull_network(call, NetLinear(*s.network, lane, packed, team, call.box, call.r, in, given, {scratch}), tally);
}

bool solve_network(const VelocitiesCall &call, const EliminationPlan &s, const MoleculeLane &lane, bool packed,
                   const LongTeam *team, double *scratch, Tally &tally) {
    const Inputs in = {&call.v, nullptr, nullptr, true, call.strain};
    const NetLinear x(*s.network, lane, packed, team, call.box, call.r, in, rates, {scratch});
    if (!x.solve()) return false;
    count_moved(tally, 0, x.rounds);
    if (call.lambda)
        x.net.for_rest_and_parts([&](const NetPart &part) { x.write_bonds(part, 0.5, false, call.lambda); });
    if (call.virial) x.add_virial(tally);
    x.write_velocities(call.v, !call.v.is_float);
    return true;
}

bool solve_network(const PositionsCall &call, const EliminationPlan &s, const MoleculeLane &lane, bool packed,
                   const LongTeam *team, double *scratch, Tally &tally) {
    NetPositions x(call, *s.network, s.fixed, lane, packed, team, {scratch}, tally);
    return solve_positions(x, Flag{true}, [] {}) == 0;
}

}  // namespace holonomic::HOL_ISA
