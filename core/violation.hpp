// How far positions and velocities are from the constraints.
#pragma once

#include "core/molecules/chains.hpp"

namespace holonomic {

// The largest violations and where they are, as the caller counts; -1 if there is none.
struct Worst {
    double length;
    std::int64_t length_molecule, length_bond;
    double rate;
    std::int64_t rate_molecule, rate_bond;
};

void violation(const Chains &chains, const AtomArray &r, const AtomArray &v, Worst *worst);

}  // namespace holonomic
