// What given multipliers do: forces on the atoms, tensions and virials of the bonds.
#pragma once

#include "core/molecules/chains.hpp"

namespace holonomic {

// Where they go; each may be absent.
struct Reactions {
    double *lambda;       // a copy of the multipliers, of the molecules that are not bad
    double *tension;      // [n_bonds]
    AtomArray g;          //
    bool add;             // to g
    double *bond_virial;  // [n_bonds][6]: xx xy xz yy yz zz
    bool virial;          // in the tally
};

// The box is that of r. A molecule with anything that is not finite is counted as bad, and nothing of it is written.
Tally react(const Chains &chains, const AtomArray &r, const Cell &box, const double *lambda, const Reactions &out);

// virial [9] or nullptr; out.virial is set by it. Throws Error once everything that is due has been written.
void reactions(const Chains &chains, const AtomArray &r, const Cell &box, const double *lambda, Reactions out,
               double *virial);

}  // namespace holonomic
