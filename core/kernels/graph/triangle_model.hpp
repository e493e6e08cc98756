// Positions of triangles in the multipliers alone. Bond k becomes D_k + P_k, where
//     P_k = - (w_k + w_{k+1}) tau_k b_k + w_{k+1} tau_{k+1} b_{k+1} + w_k tau_{k-1} b_{k-1},
// so that with the matrix M of tau = 0 and q_k = |P_k|^2 the lengths are right where
//     2 M tau = sigma + q(tau),   sigma = D.D - a^2.
// q is a quadratic form in tau of three products of b alone, and small: nothing cancels, and what a step leaves is
// known to many more digits than the bonds have.
#ifndef HOLONOMIC_KERNELS_GRAPH_TRIANGLE_MODEL_HPP
#define HOLONOMIC_KERNELS_GRAPH_TRIANGLE_MODEL_HPP

#include "core/kernels/graph/triangle_newton.hpp"

namespace holonomic {
namespace HOL_ISA {
namespace graph {

template <class V>
struct TriangleModel {
    const TriangleMasses<V> &m;
    const TriangleLengths<V> &a;
    V u[3], c[3];  // b_k . b_k, b_k . b_{k+1}
    V g[3][3];     // D_k . b_l
    V sigma[3];

    // The bonds of either sort add up to zero.
    inline HOL_FORCED TriangleModel(const TriangleNewton<V> &x) : m(x.m), a(x.a) {
        u[0] = dot(x.b[0], x.b[0]);
        u[1] = dot(x.b[1], x.b[1]);
        c[0] = dot(x.b[0], x.b[1]);
        c[1] = -(u[1] + c[0]);
        c[2] = -(u[0] + c[0]);
        u[2] = -(c[1] + c[2]);
        HOL_UNROLL
        for (int k = 0; k < 2; ++k) {
            g[k][0] = dot(x.D[k], x.b[0]);
            g[k][1] = dot(x.D[k], x.b[1]);
            g[k][2] = -(g[k][0] + g[k][1]);
        }
        HOL_UNROLL
        for (int l = 0; l < 3; ++l) g[2][l] = -(g[0][l] + g[1][l]);
        HOL_UNROLL
        for (int k = 0; k < 3; ++k) sigma[k] = 2.0 * x.left[k];
    }

    // Lanes in which X is no small difference.
    inline HOL_FORCED MaskOf<V> open_angle() const {
        const V whole = g[0][0] * g[1][1];
        return less(least_sine2 * abs(whole), whole - g[0][1] * g[1][0]);
    }

    // P_k . b_k, P_k . b_{k+1} and q_k.
    struct Change {
        V own[3], next[3], q[3];
    };
    inline HOL_FORCED Change change(const V *tau) const {
        Change p;
        V before[3];
        HOL_UNROLL
        for (int k = 0; k < 3; ++k) before[k] = m.w[k] * tau[(k + 2) % 3];
        HOL_UNROLL
        for (int k = 0; k < 3; ++k) {  // P_k = - x b_k + y b_{k+1}
            const int next = (k + 1) % 3;
            const V x = mul_add(m.both[k], tau[k], before[k]), y = mul_add(m.w[next], tau[next], -before[k]);
            p.own[k] = mul_add(y, c[k], -(x * u[k]));
            p.next[k] = mul_add(y, u[next], -(x * c[k]));
            p.q[k] = mul_add(y, p.next[k], -(x * p.own[k]));
        }
        return p;
    }

    // The inverse of 2 M, of bonds that have changed by p.
    inline HOL_FORCED TriangleInverse<V> inverse(const Change &p) const {
        V h[3][3];
        HOL_UNROLL
        for (int k = 0; k < 3; ++k) {
            h[k][k] = g[k][k] + p.own[k];
            h[k][(k + 1) % 3] = g[k][(k + 1) % 3] + p.next[k];
            h[k][(k + 2) % 3] = g[k][(k + 2) % 3] - (p.own[k] + p.next[k]);
        }
        return invert(h);
    }
    HOL_INLINE TriangleInverse<V> invert(const TriangleModel &x, const V h[3][3]) {
        return invert_triangle<false>(x.m, h, mul_add(h[0][0], h[1][1], -(h[0][1] * h[1][0])), 2);
    }
    inline HOL_FORCED TriangleInverse<V> invert(const V h[3][3]) const { return invert(*this, h); }

    // tau in the lanes of `active`, which keeps those that would need more; returns the number of solves. Two with the
    // factors of D leave the third power of the first error e, one with new factors its square, one more with the same
    // factors e^9.
    inline HOL_FORCED int64_t solve(V *tau, MaskOf<V> &active) const {
        TriangleInverse<V> f = invert(g);
        V y[3], next[3], rest[3];
        TriangleInverse<V>::solve(f, sigma, tau);
        Change p = change(tau);
        HOL_UNROLL
        for (int k = 0; k < 3; ++k) y[k] = sigma[k] + p.q[k];
        TriangleInverse<V>::solve(f, y, tau);
        int64_t solves = 2;
        do {
            // 2 M tau = sigma + q, linear about the last tau: 2 M' tau = sigma - q. What that leaves is q of the
            // change.
            p = change(tau);
            f = inverse(p);
            HOL_UNROLL
            for (int k = 0; k < 3; ++k) y[k] = sigma[k] - p.q[k];
            TriangleInverse<V>::solve(f, y, next);
            HOL_UNROLL
            for (int k = 0; k < 3; ++k) y[k] = next[k] - tau[k];
            p = change(y);
            TriangleInverse<V>::solve(f, p.q, rest);
            HOL_UNROLL
            for (int k = 0; k < 3; ++k) tau[k] = select(active, next[k] + rest[k], tau[k]);
            const V left = max(p.q[0] * a.per_a2[0], max(p.q[1] * a.per_a2[1], p.q[2] * a.per_a2[2]));
            active = active & ~less(left, Width<V>::all(small_error));
            solves += 2;
        } while (__builtin_expect(any(active), 0) && solves < 8);
        return solves;
    }

    // What the third solve may leave: the fourth leaves about its power 3/2, which must be far below a rounding.
    static constexpr double small_error = 1e-12;
};

}  // namespace graph
}  // namespace HOL_ISA
}  // namespace holonomic
#endif
