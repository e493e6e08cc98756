// The linear equations of molecules, read and solved: one function each for W molecules in lanes and for a single one,
// compiled once for all verbs (verbs/molecules_linear.cpp).
#pragma once

#include "core/kernels/molecules/linear.hpp"
#include "core/kernels/molecules/sparse_ldl/linear.hpp"
#include "core/kernels/molecules/store.hpp"

namespace holonomic::HOL_ISA::graph {

// Reads the molecules and solves, with right-hand sides of these terms (load.hpp). Returns the lanes that plain
// arithmetic answers for. `masses_known`: they are those of the block before. G of all atoms is in z.pulls().
unsigned load_and_solve(TreeLinear<vec> &, int terms, bool masses_known);
unsigned load_and_solve(TreeLinear<double> &, int terms, bool masses_known);

// For the rates of the velocities z.v, with the same matrix; G of all atoms is then in z.pulls().
void solve_for_rates(TreeLinear<vec> &);
void solve_for_rates(TreeLinear<double> &);

// Reads the molecules and solves by sparse LDL^T. Returns the lanes that this answers for.
unsigned solve_and_refine(const LdlLinear<vec> &);
unsigned solve_and_refine(const LdlLinear<double> &);

}  // namespace holonomic::HOL_ISA::graph
