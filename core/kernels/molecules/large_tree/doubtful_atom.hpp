// An atom of a large tree, with at most three children, at which plain products have lost too much: copies of its
// bonds.
#pragma once

#include "core/kernels/molecules/molecules.hpp"

namespace holonomic::HOL_ISA::graph {

struct DoubtfulAtom {
    static constexpr int most = 4;
    int k;  // children: bonds 0 .. k - 1; the one above is bond k
    double w;
    BondRow<double> bond[most];
    Vector3<double> d[most], low[most];  // the bonds with the low words that the differences of coordinates leave
    double pair[most];                   // multipliers among the children
};

// Eliminates it in twice the precision (doubtful_joint.hpp): does what up_joint() does. Returns false, with nothing
// changed, if its bonds depend on each other.
bool up_doubtful(DoubtfulAtom &);

}  // namespace holonomic::HOL_ISA::graph
