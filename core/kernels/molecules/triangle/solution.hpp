// Three atoms with all three distances, rigid water: closed forms (theory (56), (58)), in registers. Bond p points from
// atom p to atom p + 1 (mod 3), so that d_0 + d_1 + d_2 = 0. In the theory's letters a = d_1, b = d_2, c = d_0, each
// opposite to the atom of its name.
#pragma once

#include "core/kernels/arithmetic/thresholds.hpp"
#include "core/kernels/molecules/atoms/consecutive.hpp"
#include "core/kernels/molecules/image.hpp"
#include "core/kernels/molecules/molecules.hpp"
#include "core/kernels/molecules/virial.hpp"
#include "core/plan/elimination.hpp"

namespace holonomic::HOL_ISA::graph {

// Its one numbering: atoms 0, 1, 2, and the bonds (0,1), (1,2), (2,0), which within the molecule have the numbers 0,
// 2, 1.
constexpr int bond_number(int k) { return k == 0 ? 0 : 3 - k; }

template <class V>
struct TriangleMasses {
    V w[3];
    V both[3];  // w_k + w_{k+1}: of bond k
    V most[3];  // the larger one of the two
    // Divided by p = w_0 w_1 + w_1 w_2 + w_2 w_0:
    V s[3];    // w_i (w_j + w_k)
    V w2[3];   // w_i^2
    V sum[3];  // what det has of q_k: w_0 w_1 w_2 + w^2 (w' + w''), w of the atom opposite to bond k
    void set(const MoleculeLane *lane, int used) {
        for (int a = 0; a < 3; ++a) {
            w[a] = V{};
            for (int i = 0; i < Width<V>::lanes; ++i) Width<V>::set(w[a], i, lane[i < used ? i : 0].w[a]);
        }
        const V p = mul_add(w[2], w[0] + w[1], w[0] * w[1]), all = (w[0] * w[1]) * w[2];
        for (int a = 0; a < 3; ++a) {
            const int b = (a + 1) % 3, c = (a + 2) % 3;
            both[a] = w[a] + w[b];
            most[a] = max(w[a], w[b]);
            const V apart = w[a] * (w[b] + w[c]);
            s[a] = apart / p;
            w2[a] = (w[a] * w[a]) / p;
            sum[b] = mul_add(w[a], apart, all) / p;
        }
    }
};

// The inverse of a triangle's matrix, adj / det.
template <class V>
struct TriangleInverse {
    V adj[3][3];
    V r;  // 1 / det
    HOL_FORCED MaskOf<V> is_ordinary() const { return ordinary_squares<V>(abs(r), abs(r), most_of_three); }
    HOL_STATIC void solve(const TriangleInverse &m, const V *y, V *t) {
        const V y0 = y[0], y1 = y[1], y2 = y[2];
        HOL_UNROLL
        for (int k = 0; k < 3; ++k) t[k] = m.r * mul_add(m.adj[k][2], y2, mul_add(m.adj[k][1], y1, m.adj[k][0] * y0));
    }
};

// From the products g[k][l] = D_k . b_l and X = (D_k x D_l).(b_k x b_l), the same for any two bonds:
//     det = X [w_0 w_1 w_2 (q_0 + q_1 + q_2) + sum over bonds of w^2 (w' + w'') q, w of the atom opposite to it],
//     adj_kk = p q_l q_m + w^2 X,   adj_kl = p g_km g_ml - w (w' + w'') X, w of the atom between bonds k and l.
// both divided by p. symmetric: D and b are the same. The inverse is of the matrix times `factor`.
template <bool symmetric, class V>
HOL_INLINE TriangleInverse<V> invert_triangle(const TriangleMasses<V> &m, const V g[3][3], V X, double factor) {
    TriangleInverse<V> inverse;
    const V sum = mul_add(m.sum[2], g[2][2], mul_add(m.sum[1], g[1][1], m.sum[0] * g[0][0]));
    inverse.r = Width<V>::all(1 / factor) / (X * sum);
    HOL_UNROLL
    for (int k = 0; k < 3; ++k) {
        const int l = (k + 1) % 3, o = (k + 2) % 3;  // bond k ends at atom l, and is opposite to atom o
        inverse.adj[k][k] = mul_add(g[l][l], g[o][o], m.w2[o] * X);
        const V apart = m.s[l] * X;
        inverse.adj[k][l] = mul_add(g[k][o], g[o][l], -apart);
        inverse.adj[l][k] = symmetric ? inverse.adj[k][l] : mul_add(g[l][o], g[o][k], -apart);
    }
    return inverse;
}

// Bond vectors and what they know of each other.
template <class V>
struct Triangle {
    Vector3<V> d[3];
    V q[3], X;
    MaskOf<V> closed;  // the images of the three bonds meet
};

template <class V>
HOL_NOINLINE V exact_cross(const Box &box, const Vector3<V> *r, const Triangle<V> &x) {
    Vector3<V> d[2], low[2];
    unrounded_bond(box, r[1], r[2], d[0], low[0]);
    unrounded_bond(box, r[2], r[0], d[1], low[1]);
    const Vector3<V> n = cross_compensated(d[0], low[0], d[1], low[1]);
    const V X = dot(n, n);
    return keep(less(straight_sine2 * (x.q[1] * x.q[2]), X), X);
}

template <class V>
HOL_INLINE Triangle<V> triangle_of(const Box &box, const Vector3<V> *r) {
    Triangle<V> x;
    HOL_UNROLL
    for (int k = 0; k < 3; ++k) x.d[k] = r[(k + 1) % 3] - r[k];
    take_images<3>(box, x.d);
    HOL_UNROLL
    for (int k = 0; k < 3; ++k) x.q[k] = dot(x.d[k], x.d[k]);
    x.closed = ~Width<V>::none();
    if (box.lattice != Box::none) {
        const Vector3<V> sum = x.d[0] + (x.d[1] + x.d[2]);
        x.closed = less(dot(sum, sum), 1e-12 * (x.q[0] + (x.q[1] + x.q[2])));
    }
    const Vector3<V> n = cross(x.d[1], x.d[2]);
    x.X = dot(n, n);
    const MaskOf<V> flat = less(x.X, least_sine2 * (x.q[1] * x.q[2]));
    if (__builtin_expect(any(flat), 0)) x.X = select(flat, exact_cross(box, r, x), x.X);
    return x;
}

template <class V>
HOL_INLINE TriangleInverse<V> invert_triangle(const TriangleMasses<V> &m, const Triangle<V> &x) {
    V g[3][3];
    HOL_UNROLL
    for (int k = 0; k < 3; ++k) {
        const int l = (k + 1) % 3;
        g[k][k] = x.q[k];
        g[k][l] = g[l][k] = dot(x.d[k], x.d[l]);
    }
    return invert_triangle<true>(m, g, x.X, 1);
}

// G of atom i: t d of the bond that starts there, less that of the bond that ends there.
template <class V>
HOL_INLINE Vector3<V> triangle_pull(const Vector3<V> *d, const V *t, int i) {
    return add_times(t[i] * d[i], -t[(i + 2) % 3], d[(i + 2) % 3]);
}

// Writes factor t, zeros as +0.
template <Inlined where, class V>
HOL_INLINE void write_triangle_bonds(const Atoms<V> &at, const V *value, V factor, double *out, unsigned which) {
    V v[3];
    HOL_UNROLL
    for (int k = 0; k < 3; ++k) v[bond_number(k)] = mul_add(value[k], factor, V{});
    write_three<where>(out, at, {v[0], v[1], v[2]}, which);
}

// factor times what is given for each bond.
template <class V>
HOL_INLINE void read_triangle_bonds(const Atoms<V> &at, const double *in, double factor, V *value) {
    for (int k = 0; k < 3; ++k)
        for (int i = 0; i < at.lanes; ++i) Width<V>::set(value[k], i, factor * in[at.bond[i] + bond_number(k)]);
}

}  // namespace holonomic::HOL_ISA::graph
