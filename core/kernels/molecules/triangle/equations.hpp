// The lengths of triangles, and their equations at the position level as iterate() takes them, with the closed form of
// the matrix's inverse.
#pragma once

#include "core/kernels/molecules/iterate.hpp"
#include "core/kernels/molecules/triangle/solution.hpp"

namespace holonomic::HOL_ISA::graph {

template <class V>
struct TriangleLengths {
    V a2[3], per_a2[3], a_min, a_max, per_a_min;
    void set(const MoleculeLane *lane, int used) {
        a_min = Width<V>::all(1e300);
        a_max = V{};
        for (int k = 0; k < 3; ++k) {
            V a = {};
            for (int i = 0; i < Width<V>::lanes; ++i)
                Width<V>::set(a, i, lane[i < used ? i : 0].length[bond_number(k)]);
            a_min = min(a, a_min);
            a_max = max(a, a_max);
            a2[k] = a * a;
            per_a2[k] = Width<V>::all(1) / a2[k];
        }
        per_a_min = Width<V>::all(1) / a_min;
    }
};

// The system that iterate() solves.
template <class V>
struct TriangleNewton {
    const TriangleMasses<V> &m;
    const TriangleLengths<V> &a;
    Vector3<V> b[3], D[3], now[3];
    Vector3<V> shift[3];  // of the atoms, by tau
    V tau[3], left[3];    // D.D - a^2
    TriangleInverse<V> inverse;

    // Nothing else is set: filling it with zeros took a fifth of the instructions.
    TriangleNewton(const TriangleMasses<V> &masses, const TriangleLengths<V> &lengths) : m(masses), a(lengths) {}

    inline HOL_FORCED V measure() {
        V size[3];
        HOL_UNROLL
        for (int k = 0; k < 3; ++k) {
            const Vector3<V> d = now[k];
            left[k] = excess(d, a.a2[k]);
            size[k] = abs(left[k] * a.per_a2[k]);
        }
        // max() may lose a NaN, the sum keeps it
        return mul_add(left[0] + (left[1] + left[2]), V{}, max(size[0], max(size[1], size[2])));
    }
    inline HOL_FORCED V open() {
        HOL_UNROLL
        for (int k = 0; k < 3; ++k) now[k] = D[k];
        return measure();
    }
    inline HOL_FORCED void forget(MaskOf<V> which) {
        for (int k = 0; k < 3; ++k) tau[k] = select(which, V{}, tau[k]);
    }
    inline HOL_FORCED void first_factors() { factorize(~Width<V>::none()); }
    inline HOL_FORCED void factorize(MaskOf<V> which) {
        V g[3][3];
        HOL_UNROLL
        for (int k = 0; k < 3; ++k) {
            HOL_UNROLL
            for (int l = 0; l < 3; ++l) g[k][l] = dot(now[k], b[l]);
        }
        const V X = dot(cross(now[1], now[2]), cross(b[1], b[2]));
        const TriangleInverse<V> fresh = invert_triangle<false>(m, g, X, 2);
        inverse.r = select(which, fresh.r, inverse.r);
        HOL_UNROLL
        for (int k = 0; k < 3; ++k) {
            HOL_UNROLL
            for (int l = 0; l < 3; ++l) inverse.adj[k][l] = select(which, fresh.adj[k][l], inverse.adj[k][l]);
        }
    }
    inline HOL_FORCED void solve(MaskOf<V> active) {
        V change[3];
        TriangleInverse<V>::solve(inverse, left, change);
        HOL_UNROLL
        for (int k = 0; k < 3; ++k) tau[k] = tau[k] + keep(active, change[k]);
    }
    inline HOL_FORCED V move() {
        HOL_UNROLL
        for (int i = 0; i < 3; ++i) shift[i] = m.w[i] * triangle_pull(b, tau, i);
        HOL_UNROLL
        for (int k = 0; k < 3; ++k) now[k] = D[k] + (shift[(k + 1) % 3] - shift[k]);
        return measure();
    }

    // Lanes in which the pulls on an atom are so large that their rounding exceeds that of the coordinates.
    MaskOf<V> coarse_moves(V largest_coordinate) const {
        const V p0 = m.most[0] * abs(tau[0]), p1 = m.most[1] * abs(tau[1]), p2 = m.most[2] * abs(tau[2]);
        return less(0.25 * (largest_coordinate + a.a_min), max(p0, max(p1, p2)) * a.a_max);
    }
};

}  // namespace holonomic::HOL_ISA::graph
