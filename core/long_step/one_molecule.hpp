// One molecule in arrays of its own, for steps in which it needs more than one look: the kernels solve it there as they
// do in the caller's, to the bit, and only what is accepted is written to the caller.
#pragma once

#include <vector>

#include "core/kernels/tally.hpp"
#include "core/molecules/chains.hpp"

namespace holonomic {

// A molecule as the plan has it.
struct Planned {
    const Lane *chain;             // or null:
    const MoleculeLane *molecule;  //
    const Schedule *schedule;      //
    const Forest *forest;          // a large tree's own, or null
};

class OneMolecule {
public:
    OneMolecule(const Chains &chains, const Planned &planned, const Molecule &molecule);

    // The kernels' projection of r: lambda as a guess if call.guess, and what they find. `length`: in place of its own.
    // Arrays of the call are replaced by these. Returns whether it was solved; else r, v and lambda are as they were.
    bool solve(PositionsCall call, const double *length, Tally &tally);

    // Takes the atoms as the caller has them, in the same type and dimensions.
    void read(const PositionsCall &call);
    // Atoms that can move.
    void write(const PositionsCall &call) const;
    // Packed doubles, without velocities.
    void set(const std::vector<double> &reference, const std::vector<double> &positions);

    std::vector<double> lambda;  // [n_bonds]

private:
    struct Array {
        std::vector<double> memory;
        AtomArray atoms{};
    };
    void copy(const AtomArray &from, Array &to);
    void point(const AtomArray &like, Array &to) const;

    const Chains &chains_;
    const Planned &planned_;
    const Molecule &m_;
    Array r_ref_, r_, v_;
    bool in_place_ = false;  // r is the reference, too
};

}  // namespace holonomic
