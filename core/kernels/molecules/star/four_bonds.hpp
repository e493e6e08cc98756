// The equations of four bonds at one atom, M t = y with
//     M = A + c D B^T,   A = diag(w_k D_k . b_k),   c the inverse mass of the centre, rows D_k and b_k,
// where D = b but in Newton's method. Four bonds in space depend on each other. So a light centre leaves of M's
// smallest eigenvalue a part of A / c, which elimination would have to find by subtraction. Here it is the three
// equations of the centre that are solved (theory (53d)), and they are even if the bonds point everywhere:
//     p = sum of b_k t_k = N sum of b_k y_k / a_k,   N = (1 + c G)^-1,   G = sum of b_k D_k^T / a_k,
//     t_k = (y_k - c D_k . p) / a_k.
#pragma once

#include "core/kernels/molecules/molecules.hpp"

namespace holonomic::HOL_ISA::graph {

// A matrix of three rows, inverted in closed form.
template <class V>
struct Inverse3 {
    V adj[3][3], r;  // r = 1 / det
    inline HOL_FORCED void set(const V m[3][3]) {
        HOL_UNROLL
        for (int k = 0; k < 3; ++k) {
            HOL_UNROLL
            for (int l = 0; l < 3; ++l) {
                const int a = (l + 1) % 3, b = (l + 2) % 3, c = (k + 1) % 3, d = (k + 2) % 3;
                adj[k][l] = mul_add(m[a][c], m[b][d], -(m[a][d] * m[b][c]));
            }
        }
        r = Width<V>::all(1) / mul_add(m[0][2], adj[2][0], mul_add(m[0][1], adj[1][0], m[0][0] * adj[0][0]));
    }
    inline HOL_FORCED Vector3<V> times(const Vector3<V> &y) const {
        return {r * mul_add(adj[0][2], y.z, mul_add(adj[0][1], y.y, adj[0][0] * y.x)),
                r * mul_add(adj[1][2], y.z, mul_add(adj[1][1], y.y, adj[1][0] * y.x)),
                r * mul_add(adj[2][2], y.z, mul_add(adj[2][1], y.y, adj[2][0] * y.x))};
    }
};

template <class V>
struct FourBonds {
    const V *w;           // [5] inverse masses, the centre first
    const Vector3<V> *b;  // [4]
    Vector3<V> D[4];
    V a[4], per_a[4], trace;  // of 1 + c G
    Inverse3<V> N;

    inline HOL_FORCED void set(const V *masses, const Vector3<V> *moved, const Vector3<V> *reference) {
        w = masses;
        b = reference;
        HOL_UNROLL
        for (int k = 0; k < 4; ++k) D[k] = moved[k];
        HOL_UNROLL
        for (int k = 0; k < 4; ++k) a[k] = w[k + 1] * dot(D[k], b[k]);
        HOL_UNROLL
        for (int k = 0; k < 4; k += 2) {  // two quotients by one division
            const V r = Width<V>::all(1) / (a[k] * a[k + 1]);
            per_a[k] = r * a[k + 1];
            per_a[k + 1] = r * a[k];
        }
        V G[3][3];
        HOL_UNROLL
        for (int k = 0; k < 4; ++k) {
            const Vector3<V> u = (w[0] * per_a[k]) * b[k];
            const V rows[3] = {u.x, u.y, u.z}, columns[3] = {D[k].x, D[k].y, D[k].z};
            HOL_UNROLL
            for (int i = 0; i < 3; ++i) {
                HOL_UNROLL
                for (int j = 0; j < 3; ++j) {
                    const V before = k == 0 ? Width<V>::all(i == j) : G[i][j];
                    G[i][j] = mul_add(rows[i], columns[j], before);
                }
            }
        }
        N.set(G);
        trace = G[0][0] + G[1][1] + G[2][2];
    }

    // The lanes in which N is so even that it loses few digits: the bonds point everywhere.
    inline HOL_FORCED MaskOf<V> is_even() const {
        const V of_inverse = N.r * (N.adj[0][0] + N.adj[1][1] + N.adj[2][2]);
        return less(trace * of_inverse, Width<V>::all(most_uneven_light));
    }

    // Finds t, and p = sum of b_k t_k.
    inline HOL_FORCED void solve(const V *y, V *t, Vector3<V> &p) const {
        Vector3<V> z = (per_a[0] * y[0]) * b[0];
        HOL_UNROLL
        for (int k = 1; k < 4; ++k) z = add_times(z, per_a[k] * y[k], b[k]);
        p = N.times(z);
        const Vector3<V> cp = w[0] * p;
        HOL_UNROLL
        for (int k = 0; k < 4; ++k) t[k] = per_a[k] * (y[k] - dot(D[k], cp));
    }

    // Of symmetric equations, H = M^-1: the lanes in which what a multiplier is made of, taken by its size, is no more
    // than most_parts times its scale, the sum of |H_kl y_l|; and N is even.
    inline HOL_FORCED MaskOf<V> keeps_digits(const V *q, const V *y) const {
        Vector3<V> u[4];
        V length[4], size[4];
        HOL_UNROLL
        for (int l = 0; l < 4; ++l) {
            u[l] = (w[0] * per_a[l]) * N.times(b[l]);
            length[l] = sqrt(q[l]);
            size[l] = sqrt(dot(u[l], u[l]));
        }
        V margin = Width<V>::all(1);
        HOL_UNROLL
        for (int k = 0; k < 4; ++k) {
            V parts = {}, scale = {};
            HOL_UNROLL
            for (int l = 0; l < 4; ++l) {
                const V of_centre = dot(b[k], u[l]), own = Width<V>::all(k == l);
                parts = mul_add(mul_add(length[k], size[l], own), abs(y[l]), parts);
                scale = mul_add(abs(own - of_centre), abs(y[l]), scale);
            }
            margin = min(mul_add(Width<V>::all(most_parts), scale, -parts), margin);
        }
        return ~less(margin, V{}) & is_even();
    }
};

}  // namespace holonomic::HOL_ISA::graph
