// Three atoms with all three distances, rigid water: closed forms (theory (56), (58)), in registers. Bond p points from
// atom p to atom p + 1 (mod 3), so that d_0 + d_1 + d_2 = 0. In the theory's letters a = d_1, b = d_2, c = d_0, each
// opposite to the atom of its name.
#ifndef HOLONOMIC_KERNELS_GRAPH_TRIANGLE_HPP
#define HOLONOMIC_KERNELS_GRAPH_TRIANGLE_HPP

#include "core/kernels/graph/atoms.hpp"
#include "core/kernels/graph/image.hpp"
#include "core/kernels/graph/schedule.hpp"

namespace holonomic {
namespace HOL_ISA {
namespace graph {

template <class V>
struct TriangleMasses {
    V w[3];
    V p;     // w_0 w_1 + w_1 w_2 + w_2 w_0
    V s[3];  // w_i (w_j + w_k)
    V all;   // w_0 w_1 w_2
    void set(const MoleculeLane *lane, int used, const Schedule &schedule) {
        for (int a = 0; a < 3; ++a)
            for (int i = 0; i < Width<V>::lanes; ++i)
                Width<V>::set(w[a], i, lane[i < used ? i : 0].w[schedule.atom_of[a]]);
        p = mul_add(w[2], w[0] + w[1], w[0] * w[1]);
        for (int a = 0; a < 3; ++a) s[a] = w[a] * (w[(a + 1) % 3] + w[(a + 2) % 3]);
        all = (w[0] * w[1]) * w[2];
    }
};

// Bond that is opposite to atom i, and the atom that is opposite to bond p.
constexpr int opposite_bond(int i) { return (i + 1) % 3; }
constexpr int opposite_atom(int p) { return (p + 2) % 3; }

// The inverse of a triangle's matrix; symmetric where D and b are the same: then upper elements are those below.
template <class V>
struct TriangleInverse {
    V e[3][3];
    HOL_INLINE void solve(const TriangleInverse &m, const V *y, V *t) {
        const V y0 = y[0], y1 = y[1], y2 = y[2];
        HOL_UNROLL
        for (int k = 0; k < 3; ++k) t[k] = mul_add(m.e[k][2], y2, mul_add(m.e[k][1], y1, m.e[k][0] * y0));
    }
};

// From the products g[k][l] = D_k . b_l and X = (D_k x D_l).(b_k x b_l), the same for any two bonds:
//     det = X [w_0 w_1 w_2 (q_0 + q_1 + q_2) + sum over bonds of w^2 (w' + w'') q, w of the atom opposite to it],
//     adj_kk = p q_l q_m + w^2 X,   adj_kl = p g_km g_ml - w (w' + w'') X, w of the atom between bonds k and l.
template <bool symmetric, class V>
HOL_INLINE TriangleInverse<V> invert_triangle(const TriangleMasses<V> &m, const V g[3][3], V X) {
    V sum = m.all * (g[0][0] + g[1][1] + g[2][2]);
    HOL_UNROLL
    for (int k = 0; k < 3; ++k) {
        const int i = opposite_atom(k);
        sum = mul_add(m.w[i] * m.s[i], g[k][k], sum);
    }
    const V r = Width<V>::all(1) / (X * sum), pr = m.p * r, Xr = X * r;
    TriangleInverse<V> inverse;
    HOL_UNROLL
    for (int k = 0; k < 3; ++k) {
        const int l = (k + 1) % 3, o = (k + 2) % 3, own = opposite_atom(k), between = l;  // bond k ends at atom k + 1
        inverse.e[k][k] = mul_add(pr * g[l][l], g[o][o], (m.w[own] * m.w[own]) * Xr);
        const V apart = m.s[between] * Xr;
        inverse.e[k][l] = mul_add(pr * g[k][o], g[o][l], -apart);
        inverse.e[l][k] = symmetric ? inverse.e[k][l] : mul_add(pr * g[l][o], g[o][k], -apart);
    }
    return inverse;
}

// Below this sine squared the cross product of rounded bond vectors loses more than a digit.
constexpr double least_sine2 = 1.0 / 64;
// Three distances on a line can't be told from this (eps^2 for the coordinates' roundings would be 5e-32).
constexpr double straight_sine2 = 1e-22;

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
    exact_bond(box, r[1], r[2], d[0], low[0]);
    exact_bond(box, r[2], r[0], d[1], low[1]);
    const Vector3<V> n = cross_compensated(d[0], low[0], d[1], low[1]);
    const V X = dot(n, n);
    return keep(less(straight_sine2 * (x.q[1] * x.q[2]), X), X);
}

template <class V>
HOL_INLINE Triangle<V> triangle_of(const Box &box, const Vector3<V> *r) {
    Triangle<V> x;
    HOL_UNROLL
    for (int k = 0; k < 3; ++k) {
        Vector3<V> unused = {};
        x.d[k] = r[(k + 1) % 3] - r[k];
        take_image<false>(box, x.d[k], unused);
        x.q[k] = dot(x.d[k], x.d[k]);
    }
    x.closed = ~Width<V>::none();
    if (box.shape != Box::none) {
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
    return invert_triangle<true>(m, g, x.X);
}

// G of atom i: t d of the bond that starts there, less that of the bond that ends there.
template <class V>
HOL_INLINE Vector3<V> triangle_pull(const Vector3<V> *d, const V *t, int i) {
    return add_times(t[i] * d[i], -t[(i + 2) % 3], d[(i + 2) % 3]);
}

// Writes factor t, zeros as +0.
template <class V>
HOL_INLINE void write_triangle_bonds(const MoleculeLane *lane, const Schedule &s, const V *value, V factor, double *out,
                                     unsigned which) {
    V v[3];
    HOL_UNROLL
    for (int k = 0; k < 3; ++k) v[k] = mul_add(value[k], factor, V{});
    for (int i = 0; i < Width<V>::lanes; ++i) {
        if (!(which >> i & 1)) continue;
        double *const p = out + lane[i].first_bond;
        HOL_UNROLL
        for (int k = 0; k < 3; ++k) p[s.bond_of[k]] = Width<V>::get(v[k], i);
    }
}

// - factor sum t d (x) d over the lanes of `which`.
template <class V>
HOL_INLINE void add_triangle_virial(const Vector3<V> *d, const V *t, double factor, unsigned which, Tally &tally) {
    V s[6] = {};
    HOL_UNROLL
    for (int k = 0; k < 3; ++k) {
        const Vector3<V> p = t[k] * d[k];
        const V term[6] = {p.x * d[k].x, p.x * d[k].y, p.x * d[k].z, p.y * d[k].y, p.y * d[k].z, p.z * d[k].z};
        HOL_UNROLL
        for (int c = 0; c < 6; ++c) s[c] = s[c] + term[c];
    }
    for (int c = 0; c < 6; ++c)
        for (int i = 0; i < Width<V>::lanes; ++i)
            if (which >> i & 1) tally.virial[c] -= factor * Width<V>::get(s[c], i);
}

}  // namespace graph
}  // namespace HOL_ISA
}  // namespace holonomic
#endif
