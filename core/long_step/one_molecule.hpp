// One molecule in arrays of its own, for steps in which it needs more than one look: the kernels solve it there as they
// do in the caller's, to the bit, and only what is accepted is written to the caller.
#pragma once

#include <vector>

#include "core/kernels/tally.hpp"
#include "core/molecules/chains.hpp"

namespace holonomic {

// A molecule as the plan has it.
struct Planned {
    const Lane *chain;                   // or null:
    const MoleculeLane *molecule;        //
    const EliminationPlan *elimination;  //
    const TreeBatch *batch;              // a large tree's own, or null
};

class OneMolecule {
public:
    OneMolecule(const Chains &chains, const Planned &planned, const Molecule &molecule);

    // The kernels' projection of r: lambda as a guess if call.guess, and what they find. Arrays of the call are
    // replaced by these. Returns whether it was solved; else r, v and lambda are as they were.
    bool solve(PositionsCall call, Tally &tally);

    // Takes the atoms as the caller has them, in the same type and dimensions.
    void read(const PositionsCall &call);
    // Atoms that can move.
    void write(const PositionsCall &call) const;

    std::vector<double> lambda;  // [n_bonds]

private:
    struct Array {
        std::vector<double> memory;
        AtomArray atoms{};
    };
    void copy(const AtomArray &from, Array &to);

    const Chains &chains_;
    const Planned &planned_;
    const Molecule &m_;
    Array r_ref_, r_, v_;
    bool in_place_ = false;  // r is the reference, too
};

}  // namespace holonomic
