// The model of triangles that newton/multipliers.hpp solves. Bond k becomes D_k + P_k, where
//     P_k = - (w_k + w_{k+1}) tau_k b_k + w_{k+1} tau_{k+1} b_{k+1} + w_k tau_{k-1} b_{k-1}.
#pragma once

#include "core/kernels/molecules/small/worst_bond.hpp"
#include "core/kernels/molecules/triangle/equations.hpp"
#include "core/kernels/newton/multipliers.hpp"

namespace holonomic::HOL_ISA::graph {

template <class V>
struct TriangleModel {
    static constexpr int unknowns = 3;
    const TriangleMasses<V> &m;
    const V *per_a2;
    const V *sigma;
    V u[3], c[3];  // b_k . b_k, - b_k . b_{k+1}
    V g[3][3];     // D_k . b_l

    // The bonds of either sort add up to zero.
    inline HOL_FORCED TriangleModel(const TriangleNewton<V> &x) : m(x.m), per_a2(x.a.per_a2), sigma(x.left) {
        u[0] = dot(x.b[0], x.b[0]);
        u[1] = dot(x.b[1], x.b[1]);
        c[0] = -dot(x.b[0], x.b[1]);
        c[1] = u[1] - c[0];
        c[2] = u[0] - c[0];
        u[2] = c[1] + c[2];
        HOL_UNROLL
        for (int k = 0; k < 2; ++k) {
            g[k][0] = dot(x.D[k], x.b[0]);
            g[k][1] = dot(x.D[k], x.b[1]);
            g[k][2] = -(g[k][0] + g[k][1]);
        }
        HOL_UNROLL
        for (int l = 0; l < 3; ++l) g[2][l] = -(g[0][l] + g[1][l]);
    }

    // Lanes in which X is no small difference.
    inline HOL_FORCED MaskOf<V> open_angle() const {
        const V whole = g[0][0] * g[1][1];
        return less(least_sine2 * abs(whole), whole - g[0][1] * g[1][0]);
    }

    // - P_k . b_k, P_k . b_{k+1} and q_k.
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
            p.own[k] = mul_add(y, c[k], x * u[k]);
            p.next[k] = mul_add(x, c[k], y * u[next]);
            p.q[k] = mul_add(y, p.next[k], x * p.own[k]);
        }
        return p;
    }

    // The inverse of 2 M, of bonds that have changed by p.
    inline HOL_FORCED TriangleInverse<V> inverse(const Change &p) const {
        V h[3][3];
        HOL_UNROLL
        for (int k = 0; k < 3; ++k) {
            h[k][k] = g[k][k] - p.own[k];
            h[k][(k + 1) % 3] = g[k][(k + 1) % 3] + p.next[k];
            h[k][(k + 2) % 3] = g[k][(k + 2) % 3] + (p.own[k] - p.next[k]);
        }
        return invert(h);
    }
    inline HOL_FORCED TriangleInverse<V> inverse() const { return invert(g); }
    inline HOL_FORCED TriangleInverse<V> invert(const V h[3][3]) const {
        return invert_triangle<false>(m, h, mul_add(h[0][0], h[1][1], -(h[0][1] * h[1][0])), 2);
    }
    HOL_STATIC void solve(const TriangleInverse<V> &f, const V *y, V *tau) { TriangleInverse<V>::solve(f, y, tau); }
};

}  // namespace holonomic::HOL_ISA::graph
