// The equations of four bonds at one atom, M t = y with
//     M = A + c D B^T,   A = diag(w_k D_k . b_k),   c the inverse mass of the centre, rows D_k and b_k,
// where D = b but in Newton's method. Four bonds in space depend on each other. So a light centre leaves of M's
// smallest eigenvalue a part of A / c, which elimination would have to find by subtraction. Here nothing is subtracted
// from what c stands in (theory (53d), (53e)):
//     p = sum of b_k t_k = N sum of b_k y_k / a_k,   N = (1 + c G)^-1,   G = sum of b_k D_k^T / a_k,
//     t_k = (y_k - c D_k . p) / a_k                                       where the centre is not light,
//     t_k = alpha n_k + D_k . G^-1 p / a_k,   sum of n_k b_k = 0          where it is;
//     alpha = (m . y) / sum of m_k a_k n_k,   sum of m_k D_k = 0.
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

// n with sum of n_k d_k = 0: volumes of the other three.
template <class V>
HOL_INLINE void dependence(const Vector3<V> *d, V *n) {
    const Vector3<V> first = cross(d[0], d[1]), second = cross(d[2], d[3]);
    n[0] = dot(d[1], second);
    n[1] = -dot(d[0], second);
    n[2] = dot(d[3], first);
    n[3] = -dot(d[2], first);
}

template <class V>
struct FourBonds {
    const V *w;           // [5] inverse masses, the centre first
    const Vector3<V> *b;  // [4]
    Vector3<V> D[4];
    V a[4], per_a[4], G[3][3];
    Inverse3<V> N;
    MaskOf<V> light;
    // Where the centre is light.
    Inverse3<V> of_G;
    V n[4], m[4], per_sum;

    // Of symmetric equations G is the same on both sides of its diagonal to the last digit.
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
        HOL_UNROLL
        for (int k = 0; k < 4; ++k) {
            const Vector3<V> u = per_a[k] * b[k];
            const V rows[3] = {u.x, u.y, u.z}, columns[3] = {D[k].x, D[k].y, D[k].z};
            HOL_UNROLL
            for (int i = 0; i < 3; ++i) {
                HOL_UNROLL
                for (int j = 0; j < 3; ++j)
                    G[i][j] = k == 0 ? rows[i] * columns[j] : mul_add(rows[i], columns[j], G[i][j]);
            }
        }
        V heavier[3][3];
        HOL_UNROLL
        for (int i = 0; i < 3; ++i) {
            HOL_UNROLL
            for (int j = 0; j < 3; ++j)
                heavier[i][j] = i == j ? mul_add(w[0], G[i][j], Width<V>::all(1)) : w[0] * G[i][j];
        }
        N.set(heavier);
        light = less(least_light * min(min(w[1], w[2]), min(w[3], w[4])), w[0]);
        if (__builtin_expect(any(light), 0)) set_light();
    }
    inline HOL_FORCED void set_light() {
        of_G.set(G);
        dependence(b, n);
        dependence(D, m);
        V sum = m[0] * (a[0] * n[0]);
        HOL_UNROLL
        for (int k = 1; k < 4; ++k) sum = mul_add(m[k], a[k] * n[k], sum);
        per_sum = Width<V>::all(1) / sum;
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
        if (__builtin_expect(any(light), 0)) solve_light(y, t, p);
    }
    inline HOL_FORCED void solve_light(const V *y, V *t, const Vector3<V> &p) const {
        const Vector3<V> s = of_G.times(p);
        V alpha = m[0] * y[0];
        HOL_UNROLL
        for (int k = 1; k < 4; ++k) alpha = mul_add(m[k], y[k], alpha);
        alpha = per_sum * alpha;
        HOL_UNROLL
        for (int k = 0; k < 4; ++k) t[k] = select(light, mul_add(alpha, n[k], per_a[k] * dot(D[k], s)), t[k]);
    }

    // Of symmetric equations, M^-1 = H: the lanes in which the two parts of each multiplier, with what they are made of
    // taken by its size, are no more than most_parts times its scale, the sum of |H_kl y_l|; and G has kept enough.
    inline HOL_FORCED MaskOf<V> is_good_if_light(const V *q, const V *y) const {
        const V trace = G[0][0] + G[1][1] + G[2][2], of_inverse = of_G.adj[0][0] + of_G.adj[1][1] + of_G.adj[2][2];
        V margin = Width<V>::all(most_uneven_light) - (trace * of_inverse) * of_G.r;
        const Vector3<V> first = cross(b[0], b[1]), second = cross(b[2], b[3]);
        const V of_first = dot(first, first), of_second = dot(second, second);
        V size[4], length[4], size_of_u[4];
        Vector3<V> u[4];
        HOL_UNROLL
        for (int l = 0; l < 4; ++l) {
            size[l] = sqrt(q[l ^ 1] * (l < 2 ? of_second : of_first));
            length[l] = per_a[l] * sqrt(q[l]);
            u[l] = of_G.times(N.times(per_a[l] * b[l]));
            size_of_u[l] = sqrt(dot(u[l], u[l]));
        }
        HOL_UNROLL
        for (int k = 0; k < 4; ++k) {
            V parts = {}, scale = {};
            HOL_UNROLL
            for (int l = 0; l < 4; ++l) {
                const V H = mul_add(per_sum, n[k] * n[l], per_a[k] * dot(b[k], u[l]));
                parts = mul_add(mul_add(per_sum, size[k] * size[l], length[k] * size_of_u[l]), abs(y[l]), parts);
                scale = mul_add(abs(H), abs(y[l]), scale);
            }
            margin = min(mul_add(Width<V>::all(most_parts), scale, -parts), margin);
        }
        return ~less(margin, V{}) & finite(per_sum);
    }
};

}  // namespace holonomic::HOL_ISA::graph
