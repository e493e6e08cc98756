// Multipliers of given right-hand sides.
#pragma once

#include "core/molecules/chains.hpp"

namespace holonomic {

// Z lambda = rhs. lambda, which may be rhs, g and virial [9]: or nullptr. Throws Error once everything that is due has
// been written.
void solve(const Chains &chains, const AtomArray &r, const double *rhs, double *lambda, const AtomArray &g, bool add,
           double *virial);

// The same and tensions for right-hand sides of the library's own: what is due has been written, `virial` is in the
// tally, and what is bad is the caller's to say.
struct SolveOutputs {
    double *lambda, *tension;  // [n_bonds] or nullptr
    AtomArray g;
    bool add, virial;
};
Tally solve_equations(const Chains &chains, const AtomArray &r, const double *rhs, const SolveOutputs &out);

}  // namespace holonomic
