// The linear equations of molecules that are no chains (molecules/solve.hpp), for the verbs that have some.
#include "core/kernels/molecules/armed_tree/sweeps.hpp"
#include "core/kernels/molecules/solve.hpp"
#include "core/kernels/molecules/sparse_ldl/refinement.hpp"
#include "core/kernels/molecules/tree/flagged_joint.hpp"

namespace holonomic::HOL_ISA::graph {

// Lanes that plain arithmetic answers for, once the equations are solved.
template <class V>
static inline unsigned good_lanes(TreeLinear<V> &z) {
    const MaskOf<V> good = z.x.in_use() & ~less(z.x.margin, V{});
    return bits(good & finite_solution(z.x));
}

template <class V>
static inline unsigned load_and_solve_lanes(TreeLinear<V> &z, int terms, bool masses_known) {
    if (!masses_known) masses_by_index(z.x.s, z.x.lane, z.x.w);
    Loader<V>{z, terms}.load();
    z.factorize_and_solve();
    return good_lanes(z);
}
unsigned load_and_solve(TreeLinear<vec> &z, int terms, bool masses_known) {
    return load_and_solve_lanes(z, terms, masses_known);
}
unsigned load_and_solve(TreeLinear<double> &z, int terms, bool masses_known) {
    return load_and_solve_lanes(z, terms, masses_known);
}

void solve_for_rates(TreeLinear<vec> &z) { z.solve_for_rates(); }
void solve_for_rates(TreeLinear<double> &z) { z.solve_for_rates(); }

template <class V>
static inline unsigned factorize_and_prove(const LdlLinear<V> &x) {
    LdlErrorBound<V>::factorize(x);
    const unsigned proven = LdlErrorBound<V>::solve(x);
    return proven == bits(x.in_use()) ? proven : LdlRefinement<V>(x).refine(proven);
}
unsigned solve_and_refine(const LdlLinear<vec> &x) { return factorize_and_prove(x); }
unsigned solve_and_refine(const LdlLinear<double> &x) { return factorize_and_prove(x); }

}  // namespace holonomic::HOL_ISA::graph
