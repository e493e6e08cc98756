// The linear equations of molecules that are no chains (molecules/solve.hpp), for the verbs that have some.
#include "core/kernels/molecules/large_tree/doubtful_joint.hpp"
#include "core/kernels/molecules/large_tree/large_linear.hpp"
#include "core/kernels/molecules/list/flat_refine.hpp"
#include "core/kernels/molecules/solve.hpp"

namespace holonomic::HOL_ISA::graph {

// Lanes that plain arithmetic answers for, once the equations are solved.
template <class V>
static inline unsigned good_lanes(Linear<V> &z) {
    if (z.x.in.rates) {
        z.equations.start = z.equations.velocity;
        z.equations.velocity = nullptr;
    }
    MaskOf<V> good = z.x.in_use() & ~less(z.x.slack, V{});
    if (z.x.s.type == Schedule::graph) good = good & z.refine();
    return bits(good & finite_solution(z.x));
}
unsigned solved_lanes(Linear<double> &z) { return good_lanes(z); }

template <class V>
static inline unsigned load_and_solve_lanes(Linear<V> &z, int terms, bool masses_known) {
    if (!masses_known) z.set_masses();
    Loader<V>{z, terms}.load();
    z.factorize_and_solve();
    return good_lanes(z);
}
unsigned load_and_solve(Linear<vec> &z, int terms, bool masses_known) {
    return load_and_solve_lanes(z, terms, masses_known);
}
unsigned load_and_solve(Linear<double> &z, int terms, bool masses_known) {
    if (!z.x.pieces) return load_and_solve_lanes(z, terms, masses_known);
    solve_all_pieces(z, terms, true);
    return good_lanes(z);
}

void solve_again(Linear<double> &z) { z.solve_again(); }
void solve_again_and_move(Linear<vec> &z, vec3 *v) { z.solve_again_and_move(v); }
void solve_again_and_move(Linear<double> &z, Vector3<double> *v) { z.solve_again_and_move(v); }

void solve_in_pieces(Linear<double> &z, int terms, bool look) { solve_all_pieces(z, terms, look); }

bool solve_and_refine(const FlatLinear &x) { return FlatProof(x).solve() || FlatRefine(x).refine(); }

bool has_torn_atoms(const Molecules<double> &x) { return any_torn_atom(x); }

void write_arms(const Molecules<double> &x, bool weighted, const Outputs &out, Tally &tally) {
    write_all_arms(x, weighted, out, tally);
}

}  // namespace holonomic::HOL_ISA::graph
