// The linear equations of one large tree that is mostly arms (core/plan/elimination.hpp): these are worked on as
// chains, by any thread, what is between them atom by atom, with the digits of tree/joint.hpp. sweeps.hpp has the
// functions, compiled once.
#pragma once

#include "core/kernels/molecules/armed_tree/arm_store.hpp"
#include "core/kernels/molecules/linear_level.hpp"
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
              const Inputs &in, int rhs_terms, const LongTeam *threads, double *scratch)
        : x{s, &lane, 1, Atoms<double>(&lane, 1, packed), &box, &r, nullptr, nullptr, nullptr, 1, in}, terms(rhs_terms),
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

    // The way of linear_level.hpp.
    unsigned in_use() const { return 1; }
    unsigned solve() { return read_and_solve(true) && !(solved_twice(x.in) && any_overcorrected()) ? 1 : 0; }
    void write(const LinearOutputs &out, unsigned, Tally &tally) const { write_all(out, false, tally); }
    // From the beginning, as a long chain is. The matrix is the same both times. The second time the rates are those
    // that the rounded velocities leave.
    void project(const LinearOutputs &out, bool twice, unsigned, Tally &tally) {
        write_all(out, true, tally);
        if (twice && read_and_solve(false)) write_all({out.g, nullptr, nullptr, true, false}, true, tally);
    }

private:
    // Reads the tree and solves. Returns whether plain arithmetic answers for it; unless `look`, whether results are
    // finite.
    bool read_and_solve(bool look);
    // Whether an atom is overcorrected by the solution (tree/flagged_atom.hpp).
    bool any_overcorrected() const;
    // weighted: v += w G, with v in place of G.
    void write_all(const LinearOutputs &, bool weighted, Tally &) const;
};

}  // namespace holonomic::HOL_ISA::graph
