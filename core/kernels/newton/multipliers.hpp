// Newton's method for the multipliers alone of small molecules. The lengths are right where
//     2 M tau = sigma + q(tau),   sigma = D.D - a^2,   q_k = |P_k|^2,   P what tau does to the bonds;
// q is a quadratic form of products of the reference bonds b, and small. So nothing cancels, and the error that a step
// leaves is known to many more digits than the bonds have.
#pragma once

#include "core/kernels/arithmetic/width.hpp"
#include "core/kernels/newton/first_side.hpp"

namespace holonomic::HOL_ISA {

// Largest error that the second solve may leave in the squared lengths. The third leaves about its power 3/2, which
// must be far below a rounding.
constexpr double small_enough = 1e-11;

// A model of N bonds has: sigma[N], per_a2[N];  change(tau), with q[N];  inverse() of 2 M for tau = 0, and
// inverse(change) for the bonds as changed;  solve(inverse, y, tau). tau has `unknowns` elements, the multipliers
// first; what comes after them is linear in y, too.

// Two solves from tau, in all lanes. The one with new factors squares the error, the other with the same factors takes
// it to the third power. Returns what the first has left of a^2.
template <int N, class V, class Model>
HOL_INLINE V solve_twice(const Model &x, V *tau) {
    constexpr int unknowns = Model::unknowns;
    V y[N], next[unknowns], step[unknowns], rest[unknowns];
    // 2 M tau = sigma + q, linear about the last tau: 2 M' tau = sigma - q. What that leaves is q of the change.
    auto p = x.change(tau);
    const auto f = x.inverse(p);
    HOL_UNROLL
    for (int k = 0; k < N; ++k) y[k] = x.sigma[k] - p.q[k];
    Model::solve(f, y, next);
    HOL_UNROLL
    for (int k = 0; k < unknowns; ++k) step[k] = next[k] - tau[k];
    p = x.change(step);
    Model::solve(f, p.q, rest);
    V left = p.q[0] * x.per_a2[0];
    HOL_UNROLL
    for (int k = 1; k < N; ++k) left = max(p.q[k] * x.per_a2[k], left);
    HOL_UNROLL
    for (int k = 0; k < unknowns; ++k) tau[k] = next[k] + rest[k];
    return left;
}

// So many solves are enough where the step is small: one with the factors of the bonds as they came, and two.
constexpr int fewest_solves = 3;
// Returns what the second has left of a^2: they were enough where that is less than small_enough.
template <int N, class V, class Model>
HOL_INLINE V fewest_for_multipliers(const Model &x, V *tau) {
    V y[N];
    HOL_UNROLL
    for (int k = 0; k < N; ++k) y[k] = first_side(x.sigma[k], x.per_a2[k]);
    Model::solve(x.inverse(), y, tau);
    return solve_twice<N>(x, tau);
}

// Finds tau in the lanes of `active` by no more than `most` solves; it keeps the lanes that need more. In others tau is
// anything. Returns the number of solves.
template <int N, class V, class Model>
HOL_INLINE int64_t solve_for_multipliers(const Model &x, V *tau, MaskOf<V> &active, int most) {
    int64_t solves = fewest_solves;
    active = active & ~less(fewest_for_multipliers<N>(x, tau), Width<V>::all(most < solves ? 0 : small_enough));
    for (; __builtin_expect(any(active), 0) && solves < 9 && solves + 2 <= most; solves += 2) {
        V before[Model::unknowns];
        HOL_UNROLL
        for (int k = 0; k < Model::unknowns; ++k) before[k] = tau[k];
        const V left = solve_twice<N>(x, tau);
        HOL_UNROLL
        for (int k = 0; k < Model::unknowns; ++k) tau[k] = select(active, tau[k], before[k]);
        active = active & ~less(left, Width<V>::all(small_enough));
    }
    return solves;
}

}  // namespace holonomic::HOL_ISA
