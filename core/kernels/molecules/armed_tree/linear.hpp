// The linear equations of one large tree that is mostly arms (elimination_plan.hpp): these are worked on as chains, by
// any thread, what is between them atom by atom, with the digits of tree/joint.hpp. sweeps.hpp has the functions,
// compiled once.
#pragma once

#include "core/kernels/molecules/armed_tree/arm_store.hpp"
#include "core/kernels/molecules/load.hpp"
#include "core/kernels/molecules/store.hpp"
#include "core/kernels/molecules/tree/flagged_atom.hpp"
#include "core/kernels/molecules/tree/joint.hpp"

namespace holonomic::HOL_ISA::graph {

struct ArmedTree {
    Molecules<double> x;
    const int terms;  // of the right-hand sides (load.hpp)
    const LongTeam *team;
    Cancelling cancelling;
    Memory<double> working;  // of a joint of many bonds
    Arms arms;

    static constexpr int64_t row_values = sizeof(BondRow<double>) / sizeof(double);
    static int64_t values(const EliminationPlan &s) {
        if (s.n_arms == 0) return 0;
        return s.n_atoms + row_values * s.n_bonds + s.n_pairs + JointMemory<double, 0>::values(s.max_joint) +
               arm_values(s);
    }

    ArmedTree(const EliminationPlan &s, const MoleculeLane &lane, bool packed, const Box &box, const AtomArray &r,
              const Inputs &in, int sides, const LongTeam *threads, double *scratch)
        : x{s, &lane, 1, Atoms<double>(&lane, 1, packed), &box, &r, nullptr, nullptr, nullptr, 1, in}, terms(sides),
          team(threads), cancelling() {
        Memory<double> memory = {scratch};
        x.per_cancelled2 = 1 / most_cancelled2(s.n_bonds);
        x.row = reinterpret_cast<BondRow<double> *>(memory.values(row_values * s.n_bonds));
        x.w = memory.values(s.n_atoms);
        x.pair = memory.values(s.n_pairs);
        working = memory;
        memory.values(JointMemory<double, 0>::values(s.max_joint));
        arms = take_arms(s, scratch, memory);
    }

    // Reads the tree and solves. Returns whether plain arithmetic answers for it; unless `look`, whether results are
    // finite.
    bool solve(bool look);
    // Whether an atom is overcorrected by the solution (tree/flagged_atom.hpp).
    bool any_overcorrected() const;
    // weighted: v += w G, with v in place of G.
    void write(const Outputs &, bool weighted, Tally &) const;
};

static inline bool solve_armed(const ForcesCall &call, const EliminationPlan &s, const MoleculeLane &lane, bool packed,
                               const LongTeam *team, double *scratch, Tally &tally) {
    ArmedTree z(s, lane, packed, call.box, call.r, {&call.v, &call.f, nullptr, false},
                (call.v.x ? squares : 0) | (call.f.x ? pulls : 0), team, scratch);
    if (!z.solve(true)) return false;
    z.write({&call.g, call.lambda, call.tension, call.add, call.virial}, false, tally);
    return true;
}

// Solved, and moved, twice from the beginning, as a long chain is. The matrix is the same both times. The second time
// the rates are those that the rounded velocities leave.
static inline bool solve_armed(const VelocitiesCall &call, const EliminationPlan &s, const MoleculeLane &lane,
                               bool packed, const LongTeam *team, double *scratch, Tally &tally) {
    ArmedTree z(s, lane, packed, call.box, call.r, {&call.v, nullptr, nullptr, true, call.strain}, rates, team,
                scratch);
    const bool twice = !call.v.is_float;
    if (!z.solve(true) || (twice && z.any_overcorrected())) return false;
    z.write({&call.v, call.lambda, nullptr, true, call.virial}, true, tally);
    if (twice && z.solve(false)) z.write({&call.v, nullptr, nullptr, true, false}, true, tally);
    return true;
}

// Given right-hand sides have no use for arms.
static inline bool solve_armed(const SolveCall &, const EliminationPlan &, const MoleculeLane &, bool, const LongTeam *,
                               double *, Tally &) {
    return false;
}

}  // namespace holonomic::HOL_ISA::graph
