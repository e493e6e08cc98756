// The linear equations of molecules, read and solved: one function each for W molecules in lanes and for a single one,
// compiled once for all verbs (verbs/molecules_linear.cpp).
#pragma once

#include "core/kernels/molecules/linear.hpp"
#include "core/kernels/molecules/list/flat_linear.hpp"
#include "core/kernels/molecules/store.hpp"

namespace holonomic::HOL_ISA::graph {

// Molecules in lanes are small.
template <class V>
HOL_INLINE void open_pieces(Linear<V> &, const LongTeam *, Memory<V> &) {}
HOL_INLINE void open_pieces(Linear<double> &z, const LongTeam *team, Memory<double> &memory) {
    if (has_pieces(z.x.s)) z.take_pieces(team, memory);
}
// Given right-hand sides have no use for arms.
template <class Call, class V>
HOL_INLINE void open_arms(const Call &, Linear<V> &, const double *, Memory<V> &) {}
template <class Call>
HOL_INLINE void open_arms(const Call &, Linear<double> &z, const double *scratch, Memory<double> &memory) {
    if (z.x.pieces) z.pieces.arms = take_arms(z.x.s, scratch, memory);
}
HOL_INLINE void open_arms(const SolveCall &, Linear<double> &, const double *, Memory<double> &) {}
HOL_INLINE bool has_arms(const Linear<vec> &) { return false; }
HOL_INLINE bool has_arms(const Linear<double> &z) { return z.pieces.arms.store != nullptr; }

// Reads the molecules and solves, with right-hand sides of these terms (load.hpp). Returns the lanes that plain
// arithmetic answers for. `masses_known`: they are those of the block before.
unsigned load_and_solve(Linear<vec> &, int terms, bool masses_known);
unsigned load_and_solve(Linear<double> &, int terms, bool masses_known);

// For the right-hand sides in t of the rows, with the same matrix; of small molecules with v += w G behind it.
void solve_again(Linear<double> &);
void solve_again_and_move(Linear<vec> &, vec3 *v);
void solve_again_and_move(Linear<double> &, Vector3<double> *v);

// A large molecule in its pieces. `look`: tests what is found.
void solve_in_pieces(Linear<double> &, int terms, bool look = true);
unsigned solved_lanes(Linear<double> &);

// Reads a large molecule with cycles and solves along its list; false where that is in doubt.
bool solve_and_refine(const FlatLinear &);

// Whether an atom of a large molecule is torn by the solution (tree_runs.hpp).
bool has_torn_atoms(const Molecules<double> &);
HOL_INLINE bool has_torn_atoms(const Molecules<vec> &) { return false; }

// Writes the outputs of arms. weighted: v += w G, with v in place of G.
void write_arms(const Molecules<double> &, bool weighted, const Outputs &, Tally &);

}  // namespace holonomic::HOL_ISA::graph
